//! Four lanes in a register of WebAssembly's simd128.

use super::halves::F32x4;
use std::arch::wasm32::*;

impl F32x4 for v128 {
    type Mask = v128;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        f32x4_splat(x)
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        f32x4_add(self, other)
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        f32x4_sub(self, other)
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        f32x4_mul(self, other)
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        f32x4_div(self, other)
    }

    #[inline(always)]
    fn and(self, other: Self) -> Self {
        v128_and(self, other)
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        v128_or(self, other)
    }

    #[inline(always)]
    fn and_not(self, other: Self) -> Self {
        v128_andnot(other, self)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // The second operand where `other < self` is false: x86's minimum with its operands exchanged.
        f32x4_pmin(other, self)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        f32x4_pmax(other, self)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        f32x4_lt(self, other)
    }

    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        f32x4_le(self, other)
    }

    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        f32x4_ge(self, other)
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Self::Mask {
        f32x4_eq(self, other)
    }

    #[inline(always)]
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self {
        v128_bitselect(a, b, mask)
    }

    #[inline(always)]
    fn movemask(self) -> u32 {
        u32x4_bitmask(self) as u32
    }

    #[inline(always)]
    fn swap_halves(self) -> Self {
        u32x4_shuffle::<2, 3, 0, 1>(self, self)
    }

    #[inline(always)]
    fn swap_neighbours(self) -> Self {
        u32x4_shuffle::<1, 0, 3, 2>(self, self)
    }

    #[inline(always)]
    fn mask_and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        v128_and(a, b)
    }

    #[inline(always)]
    fn mask_or(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        v128_or(a, b)
    }

    #[inline(always)]
    fn mask_movemask(mask: Self::Mask) -> u32 {
        u32x4_bitmask(mask) as u32
    }
}
