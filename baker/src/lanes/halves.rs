//! Eight lanes in two registers of four, for instruction sets with registers of 128 bits.

use super::{F32x8, LaneKernel, Mask8};
use bytemuck::{Pod, Zeroable};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// A register of four 32-bit floats: what [`F32x8`] is made of.
pub trait F32x4: Pod {
    /// A register of lanes with all bits set, or none.
    type Mask: Copy;

    fn splat(x: f32) -> Self;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn and(self, other: Self) -> Self;
    fn or(self, other: Self) -> Self;
    fn and_not(self, other: Self) -> Self;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn lt(self, other: Self) -> Self::Mask;
    fn le(self, other: Self) -> Self::Mask;
    fn ge(self, other: Self) -> Self::Mask;
    fn eq(self, other: Self) -> Self::Mask;
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    fn movemask(self) -> u32;
    /// Swaps lanes 0 and 1 with lanes 2 and 3.
    fn swap_halves(self) -> Self;
    /// Swaps lanes 0 and 1, and lanes 2 and 3.
    fn swap_neighbours(self) -> Self;
    fn mask_and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn mask_or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    fn mask_movemask(mask: Self::Mask) -> u32;
}

/// Lanes 0 to 3, and lanes 4 to 7.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(transparent)]
pub struct Halves<H: F32x4>([H; 2]);

/// Masks of lanes 0 to 3, and of lanes 4 to 7.
#[derive(Clone, Copy)]
pub struct MaskHalves<H: F32x4>([H::Mask; 2]);

impl<H: F32x4> Halves<H> {
    #[inline(always)]
    fn zip(self, other: Self, f: fn(H, H) -> H) -> Self {
        Self([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }

    #[inline(always)]
    fn compare(self, other: Self, f: fn(H, H) -> H::Mask) -> MaskHalves<H> {
        MaskHalves([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }
}

/// Implements a binary operator, half by half.
macro_rules! operator {
    ($type:ident: $operator:ident, $method:ident, $function:ident) => {
        impl<H: F32x4> $operator for $type<H> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self([H::$function(self.0[0], other.0[0]), H::$function(self.0[1], other.0[1])])
            }
        }
    };
}

operator!(Halves: Add, add, add);
operator!(Halves: Sub, sub, sub);
operator!(Halves: Mul, mul, mul);
operator!(Halves: Div, div, div);
operator!(Halves: BitAnd, bitand, and);
operator!(Halves: BitOr, bitor, or);
operator!(MaskHalves: BitAnd, bitand, mask_and);
operator!(MaskHalves: BitOr, bitor, mask_or);

impl<H: F32x4> F32x8 for Halves<H> {
    type Mask = MaskHalves<H>;

    #[inline(never)]
    fn enter<K: LaneKernel>(kernel: K) -> K::Output {
        kernel.run::<Self>()
    }

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([H::splat(x); 2])
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, H::min)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, H::max)
    }

    #[inline(always)]
    fn and_not(self, other: Self) -> Self {
        self.zip(other, H::and_not)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> MaskHalves<H> {
        self.compare(other, H::lt)
    }

    #[inline(always)]
    fn le(self, other: Self) -> MaskHalves<H> {
        self.compare(other, H::le)
    }

    #[inline(always)]
    fn ge(self, other: Self) -> MaskHalves<H> {
        self.compare(other, H::ge)
    }

    #[inline(always)]
    fn eq(self, other: Self) -> MaskHalves<H> {
        self.compare(other, H::eq)
    }

    #[inline(always)]
    fn select(mask: MaskHalves<H>, a: Self, b: Self) -> Self {
        Self([H::select(mask.0[0], a.0[0], b.0[0]), H::select(mask.0[1], a.0[1], b.0[1])])
    }

    #[inline(always)]
    fn movemask(self) -> u32 {
        self.0[0].movemask() | self.0[1].movemask() << 4
    }

    #[inline(always)]
    fn swap_halves(self) -> Self {
        Self([self.0[1], self.0[0]])
    }

    #[inline(always)]
    fn swap_quarters(self) -> Self {
        Self([self.0[0].swap_halves(), self.0[1].swap_halves()])
    }

    #[inline(always)]
    fn swap_neighbours(self) -> Self {
        Self([self.0[0].swap_neighbours(), self.0[1].swap_neighbours()])
    }
}

impl<H: F32x4> Mask8 for MaskHalves<H> {
    #[inline(always)]
    fn movemask(self) -> u32 {
        H::mask_movemask(self.0[0]) | H::mask_movemask(self.0[1]) << 4
    }
}
