//! EXT_meshopt_compression and KHR_meshopt_compression: compressed buffer views.
//!
//! * `attributes` – mode ATTRIBUTES, versions 0 and 1 of the stream;
//! * `indices` – modes TRIANGLES and INDICES;
//! * `filters` – inverse filters of decoded attributes.
//!
//! Follows the specification (appendix A of EXT_meshopt_compression and KHR_meshopt_compression). Allocations grow with
//! the decoded data, never with a count stated by the file.

mod attributes;
mod filters;
mod indices;
#[cfg(test)]
mod known;

use serde::Deserialize;

/// Names of the extension: the Khronos name, and the earlier name.
pub(super) const NAMES: [&str; 2] = ["KHR_meshopt_compression", "EXT_meshopt_compression"];

/// A packed buffer view.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Meshopt {
    pub buffer: usize,
    pub byte_offset: usize,
    pub byte_length: usize,
    pub byte_stride: usize,
    pub count: usize,
    pub mode: String,
    pub filter: Option<String>,
}

/// Flag of a buffer that is a placeholder for decompressed bytes and may have no data.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Fallback {
    pub fallback: bool,
}

/// Decodes a packed buffer view of `count` elements of `byte_stride` bytes; the error describes the problem.
pub(super) fn decode(view: &Meshopt, packed: &[u8]) -> Result<Vec<u8>, String> {
    let (count, stride) = (view.count, view.byte_stride);
    let filter = view.filter.as_deref().unwrap_or("NONE");
    let sizes: &[usize] = match view.mode.as_str() {
        "ATTRIBUTES" => &[],
        "TRIANGLES" | "INDICES" => &[2, 4],
        other => return Err(format!("has the unknown mode {other:?}")),
    };
    if !sizes.is_empty() && (!sizes.contains(&stride) || filter != "NONE") {
        return Err(format!("has indices of {stride} bytes and the filter {filter}"));
    }
    let cut = || "is damaged or cut short".to_owned();
    match view.mode.as_str() {
        "ATTRIBUTES" => {
            if stride == 0 || stride > 256 || !stride.is_multiple_of(4) {
                return Err(format!("has a stride of {stride} bytes"));
            }
            let mut bytes = attributes::decode(packed, count, stride).ok_or_else(cut)?;
            filters::undo(filter, &mut bytes, stride)?;
            Ok(bytes)
        }
        "TRIANGLES" => indices::triangles(packed, count).map(|i| narrow(&i, stride)).ok_or_else(cut),
        _ => indices::sequence(packed, count).map(|i| narrow(&i, stride)).ok_or_else(cut),
    }
}

/// Encodes indices as 16 or 32 bits.
fn narrow(indices: &[u32], stride: usize) -> Vec<u8> {
    match stride {
        2 => indices.iter().flat_map(|&i| (i as u16).to_le_bytes()).collect(),
        _ => indices.iter().flat_map(|i| i.to_le_bytes()).collect(),
    }
}

/// Reads a stream byte by byte; `None` at its end.
struct ByteStream<'a> {
    bytes: &'a [u8],
}

impl<'a> ByteStream<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.bytes.split_at_checked(count)?;
        self.bytes = rest;
        Some(taken)
    }

    fn byte(&mut self) -> Option<u8> {
        Some(self.take(1)?[0])
    }

    /// Reads a variable-length integer: at most five groups of seven bits, lowest first.
    fn number(&mut self) -> Option<u32> {
        let mut value = 0;
        for group in 0..5 {
            let byte = self.byte()?;
            value |= ((byte & 127) as u32) << (7 * group);
            if byte < 128 {
                return Some(value);
            }
        }
        None
    }
}

/// Decodes a zigzag integer: the lowest bit is the sign.
fn unzigzag(v: u32) -> u32 {
    (v >> 1) ^ (v & 1).wrapping_neg()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(mode: &str, count: usize, byte_stride: usize) -> Meshopt {
        Meshopt { mode: mode.into(), count, byte_stride, ..Meshopt::default() }
    }

    fn bytes(hexadecimal: &str) -> Vec<u8> {
        let digit = |d: u8| (d as char).to_digit(16).unwrap() as u8;
        hexadecimal.as_bytes().as_chunks::<2>().0.iter().map(|&[a, b]| digit(a) * 16 + digit(b)).collect()
    }

    #[test]
    fn known_streams_decode_to_what_their_encoder_was_given() {
        for known in known::KNOWN {
            let filter = known.filter.map(str::to_owned);
            let packed = bytes(known.packed);
            let view = |count| Meshopt { filter: filter.clone(), ..view(known.mode, count, known.stride) };
            assert_eq!(decode(&view(known.count), &packed), Ok(bytes(known.bytes)), "{}", known.packed);
            // A truncated stream or a wrong count is an error, never a different list.
            for len in 0..packed.len() {
                assert!(
                    decode(&view(known.count), &packed[..len]).is_err(),
                    "cut to {len}: {}",
                    known.packed
                );
            }
            for count in [known.count + 768, usize::MAX - 2, usize::MAX] {
                assert!(decode(&view(count), &packed).is_err(), "{count} elements: {}", known.packed);
            }
        }
    }

    #[test]
    fn what_no_stream_can_be_is_refused_in_words() {
        for (broken, says) in [
            (view("POINTS", 3, 4), "POINTS"),
            (view("ATTRIBUTES", 3, 6), "stride of 6"),
            (view("ATTRIBUTES", usize::MAX, 256), "cut short"),
            (view("INDICES", 3, 8), "8 bytes"),
            (Meshopt { filter: Some("EXPONENTIAL".into()), ..view("TRIANGLES", 3, 4) }, "EXPONENTIAL"),
        ] {
            let error = decode(&broken, &[0xa0; 40]).unwrap_err();
            assert!(error.contains(says), "{error}");
        }
    }
}
