//! Eight lanes in an array: the backend of every processor, and the reference of the others.

use super::{F32x8, LANES, LaneKernel, Mask8};
use bytemuck::{Pod, Zeroable};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// An array, aligned as a register of eight lanes.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(32))]
pub struct ScalarF32x8([f32; LANES]);

/// All bits of a lane, or none.
#[derive(Clone, Copy)]
pub struct ScalarMask([u32; LANES]);

/// Applies a function to the lanes of two arrays. A loop: the compiler vectorises loops of arithmetic, but not closures
/// given to `std::array::from_fn`.
#[inline(always)]
fn zip<T: Copy, U: Copy + Default>(a: [T; LANES], b: [T; LANES], f: impl Fn(T, T) -> U) -> [U; LANES] {
    let mut out = [U::default(); LANES];
    for lane in 0..LANES {
        out[lane] = f(a[lane], b[lane]);
    }
    out
}

impl ScalarF32x8 {
    /// Applies a function to the bits of the lanes of two values.
    #[inline(always)]
    fn zip_bits(self, other: Self, f: impl Fn(u32, u32) -> u32) -> Self {
        let bits = |value: Self| -> [u32; LANES] { bytemuck::cast(value.0) };
        Self(bytemuck::cast(zip(bits(self), bits(other), f)))
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(f32, f32) -> bool) -> ScalarMask {
        ScalarMask(zip(self.0, other.0, |a, b| if f(a, b) { u32::MAX } else { 0 }))
    }

    /// Moves lane `lane ^ bit` to `lane`.
    #[inline(always)]
    fn swap(self, bit: usize) -> Self {
        let mut out = self.0;
        for (lane, out) in out.iter_mut().enumerate() {
            *out = self.0[lane ^ bit];
        }
        Self(out)
    }
}

/// Returns the highest bits of the lanes.
#[inline(always)]
fn high_bits(lanes: [u32; LANES]) -> u32 {
    let mut bits = 0;
    for (lane, of) in lanes.iter().enumerate() {
        bits |= (of >> 31) << lane;
    }
    bits
}

/// Implements a binary operator of numbers, lane by lane.
macro_rules! operator {
    ($operator:ident, $method:ident) => {
        impl $operator for ScalarF32x8 {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(zip(self.0, other.0, |a, b| $operator::$method(a, b)))
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

/// Implements a binary operator of bits, lane by lane.
macro_rules! bit_operator {
    ($operator:ident, $method:ident) => {
        impl $operator for ScalarF32x8 {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.zip_bits(other, |a, b| $operator::$method(a, b))
            }
        }

        impl $operator for ScalarMask {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(zip(self.0, other.0, |a, b| $operator::$method(a, b)))
            }
        }
    };
}

bit_operator!(BitAnd, bitand);
bit_operator!(BitOr, bitor);

impl F32x8 for ScalarF32x8 {
    type Mask = ScalarMask;

    #[inline(never)]
    fn enter<K: LaneKernel>(kernel: K) -> K::Output {
        kernel.run::<Self>()
    }

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; LANES])
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(zip(self.0, other.0, |a, b| if a < b { a } else { b }))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(zip(self.0, other.0, |a, b| if a > b { a } else { b }))
    }

    #[inline(always)]
    fn and_not(self, other: Self) -> Self {
        self.zip_bits(other, |a, b| !a & b)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> ScalarMask {
        self.compare(other, |a, b| a < b)
    }

    #[inline(always)]
    fn le(self, other: Self) -> ScalarMask {
        self.compare(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn ge(self, other: Self) -> ScalarMask {
        self.compare(other, |a, b| a >= b)
    }

    #[inline(always)]
    fn eq(self, other: Self) -> ScalarMask {
        self.compare(other, |a, b| a == b)
    }

    #[inline(always)]
    fn select(mask: ScalarMask, a: Self, b: Self) -> Self {
        let mask = Self(bytemuck::cast(mask.0));
        (mask & a) | mask.and_not(b)
    }

    #[inline(always)]
    fn movemask(self) -> u32 {
        high_bits(bytemuck::cast(self.0))
    }

    #[inline(always)]
    fn swap_halves(self) -> Self {
        self.swap(4)
    }

    #[inline(always)]
    fn swap_quarters(self) -> Self {
        self.swap(2)
    }

    #[inline(always)]
    fn swap_neighbours(self) -> Self {
        self.swap(1)
    }
}

impl Mask8 for ScalarMask {
    #[inline(always)]
    fn movemask(self) -> u32 {
        high_bits(self.0)
    }
}
