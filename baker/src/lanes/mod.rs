//! Eight lanes: the 32-bit floats of eight rays or eight boxes, computed at once.
//!
//! A kernel is written once, generic over [`F32x8`], and [`dispatch`] runs it with the widest backend of the
//! processor: `avx2`, found at run time; `wasm` (simd128) and `neon`, two `halves` of four lanes each; or
//! `scalar`, arrays. Every operation is one IEEE 754 operation per lane, never fused with another, so every backend
//! gives the bits of `scalar`. Only the sign and payload of a computed NaN are the processor's own. Minimum and maximum
//! are x86's: the second operand where one is NaN or both are zero.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(any(target_arch = "aarch64", all(target_arch = "wasm32", target_feature = "simd128")))]
mod halves;
#[cfg(target_arch = "aarch64")]
mod neon;
mod scalar;
#[cfg(test)]
pub mod tests;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod wasm;

#[cfg(target_arch = "x86_64")]
use crate::processor;
use bytemuck::Pod;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// Number of lanes.
pub const LANES: usize = 8;

/// The backend of a processor of which nothing more is known than what the program is compiled for.
#[cfg(target_arch = "aarch64")]
type Baseline = halves::Halves<std::arch::aarch64::float32x4_t>;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
type Baseline = halves::Halves<std::arch::wasm32::v128>;
#[cfg(not(any(target_arch = "aarch64", all(target_arch = "wasm32", target_feature = "simd128"))))]
type Baseline = scalar::ScalarF32x8;

/// A computation with eight lanes.
pub trait LaneKernel {
    /// Result of the computation.
    type Output;

    /// Computes the result. `#[inline(always)]`, as are the functions that it calls with `V`: a backend's instructions
    /// are compiled where [`F32x8::enter`] enables them.
    fn run<V: F32x8>(self) -> Self::Output;
}

/// Eight 32-bit floats. `&` and `|` are of bits.
///
/// The types are private to this module: where there is a value, the processor has the backend's instructions.
pub trait F32x8:
    Pod
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
{
    /// Result of a comparison.
    type Mask: Mask8;

    /// Runs a kernel as a function of its own, compiled for this backend.
    fn enter<K: LaneKernel>(kernel: K) -> K::Output;

    /// Returns `x` in every lane.
    fn splat(x: f32) -> Self;
    /// Returns `self` where `self < other`, otherwise `other`.
    fn min(self, other: Self) -> Self;
    /// Returns `self` where `self > other`, otherwise `other`.
    fn max(self, other: Self) -> Self;
    /// Returns the bits of `other` that `self` does not have.
    fn and_not(self, other: Self) -> Self;

    /// Returns where `self < other`; false for NaN, as [`Self::le`], [`Self::ge`] and [`Self::eq`].
    fn lt(self, other: Self) -> Self::Mask;
    /// Returns where `self <= other`.
    fn le(self, other: Self) -> Self::Mask;
    /// Returns where `self >= other`.
    fn ge(self, other: Self) -> Self::Mask;
    /// Returns where `self == other`.
    fn eq(self, other: Self) -> Self::Mask;
    /// Returns `a` where the mask is true, otherwise `b`.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// Returns the sign bits; lane 0 is the lowest.
    fn movemask(self) -> u32;

    /// Swaps lanes 0 to 3 with lanes 4 to 7.
    fn swap_halves(self) -> Self;
    /// Swaps lanes 0 and 1 with lanes 2 and 3, and likewise in the other half.
    fn swap_quarters(self) -> Self;
    /// Swaps lanes 0 and 1, 2 and 3, and so on.
    fn swap_neighbours(self) -> Self;

    /// Loads eight lanes.
    #[inline(always)]
    fn from_array(lanes: [f32; LANES]) -> Self {
        bytemuck::cast(lanes)
    }

    /// Returns the lanes.
    #[inline(always)]
    fn to_array(self) -> [f32; LANES] {
        bytemuck::cast(self)
    }

    /// Returns the minimum of all lanes, in every lane.
    #[inline(always)]
    fn least(self) -> Self {
        let of_pairs = self.min(self.swap_halves());
        let of_fours = of_pairs.min(of_pairs.swap_quarters());
        of_fours.min(of_fours.swap_neighbours())
    }

    /// Returns the maximum of all lanes, in every lane.
    #[inline(always)]
    fn greatest(self) -> Self {
        let of_pairs = self.max(self.swap_halves());
        let of_fours = of_pairs.max(of_pairs.swap_quarters());
        of_fours.max(of_fours.swap_neighbours())
    }
}

/// Eight truth values.
pub trait Mask8: Copy + BitAnd<Output = Self> + BitOr<Output = Self> {
    /// Returns the truth values as bits; lane 0 is the lowest.
    fn movemask(self) -> u32;
}

/// Runs a kernel with the widest backend of this processor.
#[inline(always)]
pub fn dispatch<K: LaneKernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if processor::has_avx2() {
        return avx2::Avx2F32x8::enter(kernel);
    }
    Baseline::enter(kernel)
}

/// Runs a kernel of loops, which the compiler makes as wide as it can, as [`dispatch`] does; with sixteen lanes where
/// the processor has AVX-512.
#[inline(always)]
pub fn dispatch_loops<K: LaneKernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if processor::has_avx512() && processor::has_avx2() {
        // SAFETY: the processor has the target features of the function.
        #[expect(unsafe_code, reason = "what a processor has is known when the program runs")]
        return unsafe { avx2::enter_avx512(kernel) };
    }
    dispatch(kernel)
}
