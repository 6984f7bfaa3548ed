//! The C names by which compiled code calls for sines and the like, answered by the page's `Math`: without these, a
//! library of its own would be linked, sixteen kilobytes that the browser has already. None of it is called in loops.
#![allow(unsafe_code, reason = "these names are the linker's: each does what C says it does")]

use js_sys::Math;

macro_rules! answered {
    ($($name:ident($($argument:ident),+): $type:ty = $of:ident),+) => {
        $(
            // SAFETY: the C library's function of this name takes and gives the same, and nothing else here has it.
            #[unsafe(no_mangle)]
            extern "C" fn $name($($argument: $type),+) -> $type {
                Math::$of($(f64::from($argument)),+) as $type
            }
        )+
    };
}

answered! {
    sin(x): f64 = sin,
    cos(x): f64 = cos,
    tan(x): f64 = tan,
    asin(x): f64 = asin,
    exp(x): f64 = exp,
    log(x): f64 = log,
    pow(x, y): f64 = pow,
    hypot(x, y): f64 = hypot,
    hypotf(x, y): f32 = hypot,
    sinf(x): f32 = sin,
    cosf(x): f32 = cos,
    atan2f(y, x): f32 = atan2
}

// SAFETY: as above.
#[unsafe(no_mangle)]
extern "C" fn exp2f(x: f32) -> f32 {
    Math::pow(2.0, f64::from(x)) as f32
}
