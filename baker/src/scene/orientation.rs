//! Removal of the orientation in pictures' metadata.
//!
//! glTF ignores all metadata of pictures; browsers always rotate pictures by the tag "orientation" of the Exif metadata
//! (CIPA DC-008). Therefore the tag is set to "upright" in place: no texel is encoded again, and no other contents
//! change.

/// Exif tag of the picture's orientation.
const ORIENTATION: u16 = 0x0112;
/// Header of the metadata in JPEG files, and in a few PNG and WebP files; followed by an arbitrary byte.
const HEAD: &[u8] = b"Exif\0";

/// Sets the orientation of a PNG, JPEG or WebP picture to upright. A damaged picture is unchanged from the damage on.
pub fn straighten(picture: &mut [u8]) {
    match picture {
        [0xff, 0xd8, ..] => jpeg(picture),
        [0x89, b'P', b'N', b'G', ..] => png(picture),
        [b'R', b'I', b'F', b'F', ..] => webp(picture),
        _ => {}
    }
}

/// Searches a JPEG file's segments, up to the start of the texels.
fn jpeg(file: &mut [u8]) {
    let mut at = 2;
    while let Some(&[0xff, marker]) = file.get(at..at + 2) {
        match marker {
            // Fill byte; markers without a segment; start of the texels, or end.
            0xff => at += 1,
            0x01 | 0xd0..=0xd8 => at += 2,
            0xd9 | 0xda => return,
            _ => {
                let Some(length) = file.get(at + 2..at + 4).and_then(|bytes| number(bytes, true)) else {
                    return;
                };
                let end = at + 2 + length.max(2);
                let Some(segment) = file.get_mut(at + 4..end) else { return };
                if marker == 0xe1 && segment.starts_with(HEAD) {
                    exif(segment.get_mut(HEAD.len() + 1..).unwrap_or_default());
                }
                at = end;
            }
        }
    }
}

/// Searches a PNG file's chunks.
fn png(file: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = file.get(at..at + 4).and_then(|bytes| number(bytes, true)) {
        // Name, contents and checksum.
        let Some(chunk) = at.checked_add(length.saturating_add(12)).and_then(|end| file.get_mut(at + 4..end))
        else {
            return;
        };
        let (contents, sum) = chunk.split_at_mut(4 + length);
        if contents.starts_with(b"eXIf") && exif(&mut contents[4..]) {
            sum.copy_from_slice(&crc32fast::hash(contents).to_be_bytes());
        }
        at += length + 12;
    }
}

/// Searches a WebP file's chunks, padded to an even number of bytes.
fn webp(file: &mut [u8]) {
    let mut at = 12;
    while let Some(length) = file.get(at + 4..at + 8).and_then(|bytes| number(bytes, false)) {
        let Some(chunk) = at.checked_add(length.saturating_add(8)).and_then(|end| file.get_mut(at..end))
        else {
            return;
        };
        if chunk.starts_with(b"EXIF") {
            exif(&mut chunk[8..]);
        }
        at += 8 + length.next_multiple_of(2);
    }
}

/// Sets the orientation of Exif metadata, with or without header, to upright. Returns true if a byte has changed.
fn exif(metadata: &mut [u8]) -> bool {
    let start = if metadata.starts_with(HEAD) { HEAD.len() + 1 } else { 0 };
    set_upright(metadata.get_mut(start..).unwrap_or_default()).unwrap_or(false)
}

/// Sets the orientation in the first directory of a TIFF file (the format of Exif metadata) to upright; `None` if the
/// file is cut off or not TIFF.
fn set_upright(tiff: &mut [u8]) -> Option<bool> {
    let is_big = match tiff.get(..2)? {
        b"MM" => true,
        b"II" => false,
        _ => return None,
    };
    let directory = number(tiff.get(4..8)?, is_big)?;
    let count = number(tiff.get(directory..directory.checked_add(2)?)?, is_big)?;
    let mut has_changed = false;
    for entry in 0..count {
        // Tag, type, count, value: 12 bytes.
        let at = directory + 2 + 12 * entry;
        let entry = tiff.get_mut(at..at + 12)?;
        if number(&entry[..2], is_big)? == usize::from(ORIENTATION) {
            // A single number of 16 bits: 1, upright.
            let upright: [u8; 10] =
                if is_big { [0, 3, 0, 0, 0, 1, 0, 1, 0, 0] } else { [3, 0, 1, 0, 0, 0, 1, 0, 0, 0] };
            has_changed |= entry[2..] != upright;
            entry[2..].copy_from_slice(&upright);
        }
    }
    Some(has_changed)
}

/// Unsigned integer of up to four bytes.
fn number(bytes: &[u8], is_big: bool) -> Option<usize> {
    let add = |sum: u32, byte: &u8| sum << 8 | u32::from(*byte);
    let sum = if is_big { bytes.iter().fold(0, add) } else { bytes.iter().rev().fold(0, add) };
    usize::try_from(sum).ok()
}

#[cfg(test)]
mod tests;
