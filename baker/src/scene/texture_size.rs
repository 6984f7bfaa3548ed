//! Limits of a picture's size, checked before allocation.

/// Number of texels of WebGPU's largest texture.
const MOST_TEXELS: u64 = 1 << 28;
/// Maximum number of texels without a check of the picture's bytes.
const MANY_TEXELS: u64 = 1 << 24;
/// Maximum number of texels per byte of a large picture. A PNG of a single colour has 344 texels per byte.
pub(super) const TEXELS_A_BYTE: u64 = 512;

/// Refuses a picture with a declared size beyond the capacity of the picture's bytes, before allocation.
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
