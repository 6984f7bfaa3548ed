//! Byte encodings of glTF: GLB container, base64, percent-encoding.

use std::borrow::Cow;

/// JSON and binary chunk of a GLB file.
pub(super) fn split_glb(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    let word = |at: usize| -> Option<u32> {
        Some(u32::from_le_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?))
    };
    match word(4) {
        Some(2) => {}
        Some(version) => return Err(format!("it is GLB version {version}")),
        None => return Err("it ends within its header".into()),
    }
    let mut at = 12usize;
    let (mut json, mut chunk) = (None, None);
    while let (Some(len), Some(kind)) = (word(at), word(at.saturating_add(4))) {
        let body = at
            .checked_add(8)
            .and_then(|start| bytes.get(start..start.checked_add(len as usize)?))
            .ok_or("a chunk ends after the file does; the file is cut short")?;
        match kind {
            0x4e4f_534a if json.is_none() => json = Some(body),
            0x004e_4942 if chunk.is_none() => chunk = Some(body),
            _ => {}
        }
        at += 8 + len as usize;
    }
    Ok((json.ok_or("it has no JSON chunk")?, chunk))
}

/// Decodes JSON bytes as text, without the byte-order mark and the trailing zeros that exporters may write; invalid
/// UTF-8 becomes U+FFFD.
pub(super) fn text(json: &[u8]) -> Cow<'_, str> {
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    let end = json.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    String::from_utf8_lossy(&json[..end])
}

/// Replaces %XX by the byte; the rest stays.
pub(super) fn percent_decoded(text: &str) -> Cow<'_, [u8]> {
    if !text.contains('%') {
        return Cow::Borrowed(text.as_bytes());
    }
    let bytes = text.as_bytes();
    let digit = |b: Option<&u8>| b.and_then(|&b| (b as char).to_digit(16));
    let mut out = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        match (bytes[i], digit(bytes.get(i + 1)), digit(bytes.get(i + 2))) {
            (b'%', Some(high), Some(low)) => {
                out.push((high * 16 + low) as u8);
                i += 3;
            }
            (byte, ..) => {
                out.push(byte);
                i += 1;
            }
        }
    }
    Cow::Owned(out)
}

/// Base64 (RFC 4648, both alphabets, padding optional, white space ignored).
pub(super) fn base64_decoded(text: &[u8]) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0u32, 0);
    for &byte in text {
        let value = match byte {
            b'A'..=b'Z' => byte - b'A',
            b'a'..=b'z' => byte - b'a' + 26,
            b'0'..=b'9' => byte - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            b'=' | b' ' | b'\n' | b'\r' | b'\t' => continue,
            _ => return None,
        };
        bits = bits << 6 | value as u32;
        count += 6;
        if count >= 8 {
            count -= 8;
            out.push((bits >> count) as u8);
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_and_percent_follow_their_rfcs() {
        assert_eq!(base64_decoded(b"Zm9vYmE="), Some(b"fooba".to_vec()));
        assert_eq!(base64_decoded(b"Zm9v YmFy"), Some(b"foobar".to_vec()));
        assert_eq!(base64_decoded(b"Zm*v"), None);
        assert_eq!(percent_decoded("a%20b%2").as_ref(), b"a b%2");
    }

    #[test]
    fn a_cut_glb_is_an_error_at_every_length() {
        let mut glb = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
        let json = b"{\"asset\":{\"version\":\"2.0\"}}  ";
        glb.extend((json.len() as u32).to_le_bytes());
        glb.extend(b"JSON");
        glb.extend(json);
        assert!(split_glb(&glb).is_ok());
        for len in 4..glb.len() {
            assert!(split_glb(&glb[..len]).is_err(), "cut to {len}");
        }
    }
}
