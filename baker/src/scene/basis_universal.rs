//! Basis Universal pictures (ETC1S and UASTC in KTX2), without native support in browsers: converted to PNG.

use super::foreign;
use super::texture_size::check_size;
use basisu::{DecodeFlags, TargetFormat, Transcoder};

/// True if `bytes` starts with the signature of a KTX2 file.
pub(super) fn is_ktx2(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\xabKTX 20\xbb\r\n\x1a\n")
}

/// Width and height, from the header.
pub(super) fn size(bytes: &[u8]) -> Option<(u64, u64)> {
    let word = |at: usize| bytes.get(at..at + 4).map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]]) as u64);
    word(20).zip(word(24))
}

/// Converts the largest level of the picture to PNG, lossless. The error is a sentence with the problem.
pub(super) fn to_png(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let damaged = |problem: &str| {
        format!(
            "its KTX2 picture cannot be decoded ({problem}): export it again, as ETC1S or UASTC, PNG or JPEG"
        )
    };
    let (width, height) = size(bytes).ok_or_else(|| damaged("it is cut short"))?;
    check_size(width, height, bytes.len())?;
    let picture = Transcoder::new(bytes).map_err(|e| damaged(&format!("{e:?}")))?;
    let rgba = picture
        .transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE)
        .map_err(|e| damaged(&format!("{e:?}")))?;
    foreign::png(&rgba, width as u32, height as u32).map_err(|e| damaged(&e.to_string()))
}
