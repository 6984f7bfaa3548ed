//! What the processor has, told when the program runs. Code for it does the same arithmetic in the same order as code for
//! any other (no fused multiplication and addition), so that files do not depend on where they are baked.

/// Whether there are AVX2 and the instructions on bits that every processor with it has: `avx2`, `bmi1`, `lzcnt`.
#[cfg(target_arch = "x86_64")]
#[inline]
pub fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("bmi1") && is_x86_feature_detected!("lzcnt")
}

/// Whether there is the foundation of AVX-512.
#[cfg(target_arch = "x86_64")]
#[inline]
pub fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
}

/// Asks for a place of memory that is read soon, so that it is near by then. Nothing where there is no such place.
#[inline(always)]
pub fn fetch<T>(slice: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(place) = slice.get(index) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: every x86-64 processor has it, and it changes nothing that a program could see.
        #[expect(unsafe_code, reason = "all of a processor's own instructions are")]
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(place).cast());
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (slice, index);
}
