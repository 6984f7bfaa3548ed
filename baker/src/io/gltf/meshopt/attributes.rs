//! Mode ATTRIBUTES: elements in blocks; a block has a row per byte of the element, of deltas to the preceding element.

use super::{ByteStream, unzigzag};

/// Number of elements in a group of packed deltas.
const GROUP: usize = 16;

/// Decodes `count` elements of `stride` bytes.
pub(super) fn decode(packed: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let version = packed.first()?.checked_sub(0xa0).filter(|v| *v <= 1)?;
    let tail_len = stride + if version == 0 { 0 } else { stride / 4 };
    let padded = tail_len.max(if version == 0 { 32 } else { 24 });
    let (body, tail) = packed.get(1..)?.split_at_checked(packed.len().checked_sub(1 + padded)?)?;
    let tail = &tail[padded - tail_len..];
    let mut last = tail[..stride].to_vec();
    let channels = &tail[stride..];

    let mut stream = ByteStream { bytes: body };
    let most = ((8192 / stride) & !(GROUP - 1)).min(256);
    let mut out = Vec::new();
    let mut left = count;
    while left > 0 {
        let size = left.min(most);
        let deltas = block(&mut stream, version, size, stride)?;
        for element in 0..size {
            for quad in 0..stride / 4 {
                let delta: [u8; 4] = std::array::from_fn(|byte| {
                    deltas[(4 * quad + byte) * size.next_multiple_of(GROUP) + element]
                });
                let channel = channels.get(quad).copied().unwrap_or(0);
                let last = &mut last[4 * quad..][..4];
                let now = add([last[0], last[1], last[2], last[3]], delta, channel)?;
                last.copy_from_slice(&now);
            }
            out.extend_from_slice(&last);
        }
        left -= size;
    }
    stream.bytes.is_empty().then_some(out)
}

/// Decodes the deltas of a block: the row of the elements' first bytes, then of the second bytes, and on. A row is
/// padded to whole groups.
fn block(stream: &mut ByteStream, version: u8, size: usize, stride: usize) -> Option<Vec<u8>> {
    let row = size.next_multiple_of(GROUP);
    let groups = row / GROUP;
    let controls = stream.take(if version == 0 { 0 } else { stride / 4 })?;
    let mut out = vec![0; row * stride];
    for (byte, out) in out.chunks_exact_mut(row).enumerate() {
        let control = controls.get(byte / 4).map_or(0, |c| c >> (2 * (byte % 4)) & 3);
        let bits = match (version, control) {
            (0, _) => [0, 2, 4, 8],
            (_, 0) => [0, 1, 2, 4],
            (_, 1) => [1, 2, 4, 8],
            (_, 2) => continue,
            _ => {
                out[..size].copy_from_slice(stream.take(size)?);
                continue;
            }
        };
        let header = stream.take(groups.div_ceil(4))?;
        for (g, out) in out.chunks_exact_mut(GROUP).enumerate() {
            group(stream, bits[(header[g / 4] >> (2 * (g % 4)) & 3) as usize], out)?;
        }
    }
    Some(out)
}

/// Decodes 16 deltas of `bits` bits; a delta with all bits set is the escape for a following byte.
fn group(stream: &mut ByteStream, bits: u32, out: &mut [u8]) -> Option<()> {
    match bits {
        0 => {}
        8 => out.copy_from_slice(stream.take(GROUP)?),
        _ => {
            let packed = stream.take(2 * bits as usize)?;
            let (each, mask) = (8 / bits as usize, (1u8 << bits) - 1);
            for (i, out) in out.iter_mut().enumerate() {
                // 1-bit deltas begin at the lowest bit, wider deltas at the highest.
                let place = if bits == 1 { i % each } else { each - 1 - i % each };
                let value = packed[i / each] >> (place as u32 * bits) & mask;
                *out = if value == mask { stream.byte()? } else { value };
            }
        }
    }
    Some(())
}

/// Adds a delta to four bytes of the preceding element; `channel` selects byte sums, 16-bit sums or a rotated XOR.
fn add(last: [u8; 4], delta: [u8; 4], channel: u8) -> Option<[u8; 4]> {
    let pair = |b: [u8; 4], i: usize| u16::from_le_bytes([b[i], b[i + 1]]);
    match channel & 3 {
        0 => Some(std::array::from_fn(|i| last[i].wrapping_add(unzigzag(delta[i] as u32) as u8))),
        1 => {
            let sum = |i| pair(last, i).wrapping_add(unzigzag(pair(delta, i) as u32) as u16).to_le_bytes();
            let ([a, b], [c, d]) = (sum(0), sum(2));
            Some([a, b, c, d])
        }
        2 => {
            let turned = u32::from_le_bytes(delta).rotate_right((channel >> 4) as u32);
            Some((u32::from_le_bytes(last) ^ turned).to_le_bytes())
        }
        _ => None,
    }
}
