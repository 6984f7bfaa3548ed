//! Elementary functions that have the same bits on every platform.
//!
//! `f32::sin` and its like are those of the platform's C library, which differ in the last bit. With the feature `libm`
//! these here are the crate libm's, compiled from the same Rust code everywhere; a bake uses no others. Without the
//! feature, for the viewer, they are the platform's.

use glam::Vec3;

/// Elementary functions of real numbers; angles are in radians.
pub trait Elementary: Sized {
    /// Returns the sine.
    fn sine(self) -> Self;
    /// Returns the cosine.
    fn cosine(self) -> Self;
    /// Returns sine and cosine.
    fn sine_cosine(self) -> (Self, Self);
    /// Returns the tangent.
    fn tangent(self) -> Self;
    /// Returns the arc sine.
    fn arc_sine(self) -> Self;
    /// Returns the arc cosine.
    fn arc_cosine(self) -> Self;
    /// Returns the arc tangent.
    fn arc_tangent(self) -> Self;
    /// Returns the angle of the vector (`x`, `self`) to the x axis.
    fn arc_tangent2(self, x: Self) -> Self;
    /// Returns the hyperbolic sine.
    fn hyperbolic_sine(self) -> Self;
    /// Returns the hyperbolic cosine.
    fn hyperbolic_cosine(self) -> Self;
    /// Returns the inverse of the hyperbolic sine.
    fn area_hyperbolic_sine(self) -> Self;
    /// Returns the inverse of the hyperbolic cosine.
    fn area_hyperbolic_cosine(self) -> Self;
    /// Returns the inverse of the hyperbolic tangent.
    fn area_hyperbolic_tangent(self) -> Self;
    /// Returns e to the power of `self`.
    fn exponential(self) -> Self;
    /// Returns 2 to the power of `self`.
    fn exponential2(self) -> Self;
    /// Returns the natural logarithm.
    fn logarithm(self) -> Self;
    /// Returns the natural logarithm of 1 + `self`.
    fn logarithm1p(self) -> Self;
    /// Returns the logarithm to base 2.
    fn logarithm2(self) -> Self;
    /// Returns `self` to the power of `exponent`.
    fn power(self, exponent: Self) -> Self;
    /// Returns the cube root.
    fn cube_root(self) -> Self;
    /// Returns the length of the vector (`self`, `other`).
    fn hypotenuse(self, other: Self) -> Self;
}

macro_rules! elementary {
    ($type:ty, $sincos:ident: $($name:ident($($argument:ident),*) = $libm:ident, $std:ident;)+) => {
        impl Elementary for $type {
            $(
                #[inline]
                fn $name(self $(, $argument: Self)*) -> Self {
                    #[cfg(feature = "libm")]
                    return libm::$libm(self $(, $argument)*);
                    #[cfg(not(feature = "libm"))]
                    return self.$std($($argument),*);
                }
            )+

            #[inline]
            fn sine_cosine(self) -> (Self, Self) {
                #[cfg(feature = "libm")]
                return libm::$sincos(self);
                #[cfg(not(feature = "libm"))]
                return self.sin_cos();
            }
        }
    };
}

elementary! {
    f32, sincosf:
    sine() = sinf, sin;
    cosine() = cosf, cos;
    tangent() = tanf, tan;
    arc_sine() = asinf, asin;
    arc_cosine() = acosf, acos;
    arc_tangent() = atanf, atan;
    arc_tangent2(x) = atan2f, atan2;
    hyperbolic_sine() = sinhf, sinh;
    hyperbolic_cosine() = coshf, cosh;
    area_hyperbolic_sine() = asinhf, asinh;
    area_hyperbolic_cosine() = acoshf, acosh;
    area_hyperbolic_tangent() = atanhf, atanh;
    exponential() = expf, exp;
    exponential2() = exp2f, exp2;
    logarithm() = logf, ln;
    logarithm1p() = log1pf, ln_1p;
    logarithm2() = log2f, log2;
    power(exponent) = powf, powf;
    cube_root() = cbrtf, cbrt;
    hypotenuse(other) = hypotf, hypot;
}

elementary! {
    f64, sincos:
    sine() = sin, sin;
    cosine() = cos, cos;
    tangent() = tan, tan;
    arc_sine() = asin, asin;
    arc_cosine() = acos, acos;
    arc_tangent() = atan, atan;
    arc_tangent2(x) = atan2, atan2;
    hyperbolic_sine() = sinh, sinh;
    hyperbolic_cosine() = cosh, cosh;
    area_hyperbolic_sine() = asinh, asinh;
    area_hyperbolic_cosine() = acosh, acosh;
    area_hyperbolic_tangent() = atanh, atanh;
    exponential() = exp, exp;
    exponential2() = exp2, exp2;
    logarithm() = log, ln;
    logarithm1p() = log1p, ln_1p;
    logarithm2() = log2, log2;
    power(exponent) = pow, powf;
    cube_root() = cbrt, cbrt;
    hypotenuse(other) = hypot, hypot;
}

/// Elementary functions by component.
pub trait ElementaryVector: Sized {
    /// Returns the components to the power of `exponent`.
    fn power(self, exponent: f32) -> Self;
    /// Returns e to the power of the components.
    fn exponential(self) -> Self;
    /// Returns 2 to the power of the components.
    fn exponential2(self) -> Self;
}

impl ElementaryVector for Vec3 {
    #[inline]
    fn power(self, exponent: f32) -> Self {
        self.map(|x| x.power(exponent))
    }

    #[inline]
    fn exponential(self) -> Self {
        self.map(Elementary::exponential)
    }

    #[inline]
    fn exponential2(self) -> Self {
        self.map(Elementary::exponential2)
    }
}

#[cfg(all(test, feature = "libm"))]
mod tests {
    use super::*;
    use xxhash_rust::xxh32::xxh32;

    /// The bits of all functions at many places: a C library that differs in a single last bit gives another number.
    #[test]
    fn every_function_has_the_bits_of_every_platform() {
        let mut bits = Vec::new();
        // The functions of both types, with the same names.
        macro_rules! add {
            ($x:expr, $y:expr) => {
                let (x, y) = ($x, $y);
                let (sine, cosine) = y.sine_cosine();
                let found = [
                    sine,
                    cosine,
                    y.tangent(),
                    x.arc_sine(),
                    x.arc_cosine(),
                    y.arc_tangent(),
                    y.arc_tangent2(x),
                    y.exponential(),
                    y.exponential2(),
                    x.logarithm(),
                    x.logarithm1p(),
                    x.logarithm2(),
                    x.power(y),
                    x.cube_root(),
                    x.hypotenuse(y),
                ];
                found.iter().for_each(|value| bits.extend(value.to_le_bytes()));
            };
        }
        for i in 0..4096u32 {
            let x = (i as f32 + 0.5) / 4096.0;
            let y = 40.0 * x - 20.0;
            add!(x, y);
            add!(f64::from(x), f64::from(y));
        }
        assert_eq!(xxh32(&bits, 0), 0x3d25_ca94);
    }
}
