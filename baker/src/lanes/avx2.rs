//! Eight lanes in an AVX2 register.

use super::{F32x8, LaneKernel, Mask8};
use bytemuck::{Pod, Zeroable};
use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// A register. Only [`dispatch`](super::dispatch) names the type, and only for a processor with the target features of
/// [`enter`].
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(transparent)]
pub struct Avx2F32x8(__m256);

/// A register of lanes with all bits set, or none.
#[derive(Clone, Copy)]
pub struct Avx2Mask(__m256);

/// Runs a kernel as a function with the instructions of all AVX2 processors.
#[target_feature(enable = "avx2,bmi1,lzcnt")]
#[inline(never)]
fn enter<K: LaneKernel>(kernel: K) -> K::Output {
    kernel.run::<Avx2F32x8>()
}

/// As [`enter`], with AVX-512 for the loops of a kernel.
#[target_feature(enable = "avx512f,avx2,bmi1,lzcnt")]
#[inline(never)]
pub fn enter_avx512<K: LaneKernel>(kernel: K) -> K::Output {
    kernel.run::<Avx2F32x8>()
}

/// Calls a function with the target features of [`enter`].
macro_rules! avx2 {
    ($call:expr) => {{
        // SAFETY: the processor has the target features, as this type has a use.
        #[expect(unsafe_code, reason = "what a processor has is known when the program runs")]
        unsafe {
            $call
        }
    }};
}

/// Implements a binary operator by an instruction.
macro_rules! operator {
    ($type:ident: $operator:ident, $method:ident, $instruction:ident) => {
        impl $operator for $type {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(avx2!($instruction(self.0, other.0)))
            }
        }
    };
}

operator!(Avx2F32x8: Add, add, _mm256_add_ps);
operator!(Avx2F32x8: Sub, sub, _mm256_sub_ps);
operator!(Avx2F32x8: Mul, mul, _mm256_mul_ps);
operator!(Avx2F32x8: Div, div, _mm256_div_ps);
operator!(Avx2F32x8: BitAnd, bitand, _mm256_and_ps);
operator!(Avx2F32x8: BitOr, bitor, _mm256_or_ps);
operator!(Avx2Mask: BitAnd, bitand, _mm256_and_ps);
operator!(Avx2Mask: BitOr, bitor, _mm256_or_ps);

impl F32x8 for Avx2F32x8 {
    type Mask = Avx2Mask;

    #[inline(always)]
    fn enter<K: LaneKernel>(kernel: K) -> K::Output {
        avx2!(enter(kernel))
    }

    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self(avx2!(_mm256_set1_ps(x)))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(avx2!(_mm256_min_ps(self.0, other.0)))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(avx2!(_mm256_max_ps(self.0, other.0)))
    }

    #[inline(always)]
    fn and_not(self, other: Self) -> Self {
        Self(avx2!(_mm256_andnot_ps(self.0, other.0)))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Avx2Mask {
        Avx2Mask(avx2!(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)))
    }

    #[inline(always)]
    fn le(self, other: Self) -> Avx2Mask {
        Avx2Mask(avx2!(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)))
    }

    #[inline(always)]
    fn ge(self, other: Self) -> Avx2Mask {
        Avx2Mask(avx2!(_mm256_cmp_ps::<_CMP_GE_OQ>(self.0, other.0)))
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Avx2Mask {
        Avx2Mask(avx2!(_mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, other.0)))
    }

    #[inline(always)]
    fn select(mask: Avx2Mask, a: Self, b: Self) -> Self {
        Self(avx2!(_mm256_blendv_ps(b.0, a.0, mask.0)))
    }

    #[inline(always)]
    fn movemask(self) -> u32 {
        avx2!(_mm256_movemask_ps(self.0)) as u32
    }

    #[inline(always)]
    fn swap_halves(self) -> Self {
        Self(avx2!(_mm256_permute2f128_ps::<1>(self.0, self.0)))
    }

    #[inline(always)]
    fn swap_quarters(self) -> Self {
        Self(avx2!(_mm256_permute_ps::<0b01_00_11_10>(self.0)))
    }

    #[inline(always)]
    fn swap_neighbours(self) -> Self {
        Self(avx2!(_mm256_permute_ps::<0b10_11_00_01>(self.0)))
    }
}

impl Mask8 for Avx2Mask {
    #[inline(always)]
    fn movemask(self) -> u32 {
        avx2!(_mm256_movemask_ps(self.0)) as u32
    }
}
