//! How large a picture may be, told before anything is allocated for it.

/// Texels that WebGPU's largest texture has.
const MOST_TEXELS: u64 = 1 << 28;
/// Pictures of so many texels need no proof; larger ones must have bytes to show for it.
const MANY_TEXELS: u64 = 1 << 24;
/// Texels that a byte of large pictures can stand for, at most. A PNG of one colour has 344 a byte.
pub(super) const TEXELS_A_BYTE: u64 = 512;

/// Refuses a picture that says it is larger than its bytes can be, before anything is allocated for it.
pub(super) fn check_size(width: u64, height: u64, len: usize) -> Result<(), String> {
    let texels = width.saturating_mul(height);
    if texels == 0 {
        return Err("it has no texels: replace it".into());
    }
    if texels > MOST_TEXELS {
        return Err(format!("it has {width} x {height} texels; the limit is {MOST_TEXELS}: make it smaller"));
    }
    if texels > MANY_TEXELS.max(TEXELS_A_BYTE * len as u64) {
        return Err(format!(
            "its {len} bytes would be {width} x {height} texels: save it again if it is damaged, smaller if it has \
             one colour"
        ));
    }
    Ok(())
}
