//! Four lanes in a register of NEON, which every 64-bit Arm processor has.

use super::halves::F32x4;
use std::arch::aarch64::*;

/// Calls functions with the target feature of NEON.
macro_rules! neon {
    ($call:expr) => {{
        // SAFETY: every 64-bit Arm processor that this compiles for has NEON, which is a part of the target.
        #[expect(unsafe_code, reason = "all of a processor's own instructions are")]
        unsafe {
            $call
        }
    }};
}

/// Returns the highest bits of the lanes.
#[inline(always)]
fn high_bits(lanes: uint32x4_t) -> u32 {
    // Bit 31 of lane i becomes bit i.
    let places: int32x4_t = bytemuck::cast([0, 1, 2, 3]);
    neon!(vaddvq_u32(vshlq_u32(vshrq_n_u32::<31>(lanes), places)))
}

impl F32x4 for float32x4_t {
    type Mask = uint32x4_t;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        neon!(vdupq_n_f32(x))
    }

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        neon!(vaddq_f32(self, other))
    }

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        neon!(vsubq_f32(self, other))
    }

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        neon!(vmulq_f32(self, other))
    }

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        neon!(vdivq_f32(self, other))
    }

    #[inline(always)]
    fn and(self, other: Self) -> Self {
        neon!(vreinterpretq_f32_u32(vandq_u32(vreinterpretq_u32_f32(self), vreinterpretq_u32_f32(other))))
    }

    #[inline(always)]
    fn or(self, other: Self) -> Self {
        neon!(vreinterpretq_f32_u32(vorrq_u32(vreinterpretq_u32_f32(self), vreinterpretq_u32_f32(other))))
    }

    #[inline(always)]
    fn and_not(self, other: Self) -> Self {
        neon!(vreinterpretq_f32_u32(vbicq_u32(vreinterpretq_u32_f32(other), vreinterpretq_u32_f32(self))))
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        neon!(vbslq_f32(vcltq_f32(self, other), self, other))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        neon!(vbslq_f32(vcgtq_f32(self, other), self, other))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        neon!(vcltq_f32(self, other))
    }

    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        neon!(vcleq_f32(self, other))
    }

    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        neon!(vcgeq_f32(self, other))
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Self::Mask {
        neon!(vceqq_f32(self, other))
    }

    #[inline(always)]
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self {
        neon!(vbslq_f32(mask, a, b))
    }

    #[inline(always)]
    fn movemask(self) -> u32 {
        high_bits(neon!(vreinterpretq_u32_f32(self)))
    }

    #[inline(always)]
    fn swap_halves(self) -> Self {
        neon!(vextq_f32::<2>(self, self))
    }

    #[inline(always)]
    fn swap_neighbours(self) -> Self {
        neon!(vrev64q_f32(self))
    }

    #[inline(always)]
    fn mask_and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        neon!(vandq_u32(a, b))
    }

    #[inline(always)]
    fn mask_or(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        neon!(vorrq_u32(a, b))
    }

    #[inline(always)]
    fn mask_movemask(mask: Self::Mask) -> u32 {
        high_bits(mask)
    }
}
