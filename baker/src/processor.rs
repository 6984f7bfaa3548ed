//! CPU features, detected at run time. Feature-specific code does the same arithmetic in the same
//! order as the generic code (no fused multiply-add), so that files do not depend on the baking
//! machine.

/// Whether the CPU has AVX2 and the bit manipulation instructions of all AVX2 processors: `avx2`,
/// `bmi1`, `lzcnt`.
#[cfg(target_arch = "x86_64")]
#[inline]
pub fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("bmi1") && is_x86_feature_detected!("lzcnt")
}

/// Whether the CPU has AVX-512 Foundation.
#[cfg(target_arch = "x86_64")]
#[inline]
pub fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
}

/// Prefetches `slice[index]` into the cache for a read soon after. No effect for an index out of
/// range.
#[inline(always)]
pub fn fetch<T>(slice: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(place) = slice.get(index) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: every x86-64 processor has the instruction, and a prefetch has no effect visible
        // to the program.
        #[expect(unsafe_code, reason = "all of a processor's own instructions are")]
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(place).cast());
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (slice, index);
}
