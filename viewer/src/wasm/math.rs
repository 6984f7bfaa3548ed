//! C library names for sine and other functions in compiled code, implemented with the page's `Math`: without these
//! functions, a math library of sixteen kilobytes would be linked, a duplicate of the browser's. No loop of a
//! frame calls these functions, but the projection of an environment that is turned.
#![allow(unsafe_code, reason = "these names are the linker's: each does what C says it does")]

use js_sys::Math;

macro_rules! answered {
    ($($name:ident($($argument:ident),+): $type:ty = $of:ident),+) => {
        $(
            // SAFETY: same arguments and result as the C library's function of this name, and no other definition
            // is linked.
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
    acos(x): f64 = acos,
    acosf(x): f32 = acos,
    atanf(x): f32 = atan,
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
