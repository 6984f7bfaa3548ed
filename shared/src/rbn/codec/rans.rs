//! Entropy coding of bytes: range asymmetric numeral systems (Duda 2013), order 0, two interleaved states.
//!
//! A stream consists of a frequency table, two states and words:
//!
//! ```text
//! 32 bytes        mask of the occurring byte values, one bit per value
//! 2 bytes each    frequencies of the occurring values minus one; frequencies sum to 4096
//! 4 + 4 bytes     final states of the encoder, initial states of a reader
//! the rest        bytes shifted into the states
//! ```

use super::Damaged;

/// Bits of a probability.
const SCALE_BITS: u32 = 12;
const SCALE: u32 = 1 << SCALE_BITS;
/// Lower bound of the states.
const LOW: u32 = 1 << 23;

/// Size of the shortest stream, bytes: a table of one value, and the states.
pub const LEAST: usize = 32 + 2 + 8;

/// Returns frequencies of the byte values with sum 4096, at least 1 for an occurring value.
fn frequencies(bytes: &[u8]) -> [u32; 256] {
    let mut counts = [0u64; 256];
    for &byte in bytes {
        counts[byte as usize] += 1;
    }
    let total = bytes.len().max(1) as u64;
    let mut scaled = counts.map(|c| if c == 0 { 0 } else { ((c * SCALE as u64 / total) as u32).max(1) });
    // The most frequent values absorb the rounding error of the sum.
    loop {
        let sum: u32 = scaled.iter().sum();
        let Some(largest) = (0..256).max_by_key(|i| scaled[*i]).filter(|i| scaled[*i] > 0) else {
            return scaled;
        };
        match sum.cmp(&SCALE) {
            std::cmp::Ordering::Equal => return scaled,
            std::cmp::Ordering::Less => scaled[largest] += SCALE - sum,
            std::cmp::Ordering::Greater => {
                let spare = (scaled[largest] / 2).max(1).min(sum - SCALE);
                scaled[largest] -= spare;
            }
        }
    }
}

fn starts(frequencies: &[u32; 256]) -> [u32; 256] {
    let mut start = 0;
    frequencies.map(|f| {
        start += f;
        start - f
    })
}

/// Appends the stream of these bytes.
pub fn encode(bytes: &[u8], out: &mut Vec<u8>) {
    let frequencies = frequencies(bytes);
    let starts = starts(&frequencies);
    let mut mask = [0u8; 32];
    for value in (0..256).filter(|v| frequencies[*v] > 0) {
        mask[value / 8] |= 1 << (value % 8);
    }
    out.extend_from_slice(&mask);
    for f in frequencies.into_iter().filter(|f| *f > 0) {
        out.extend_from_slice(&((f - 1) as u16).to_le_bytes());
    }
    let mut shifted = Vec::with_capacity(bytes.len());
    let mut states = [LOW; 2];
    for (i, &byte) in bytes.iter().enumerate().rev() {
        let (f, start) = (frequencies[byte as usize], starts[byte as usize]);
        let x = &mut states[i % 2];
        let most = ((LOW >> SCALE_BITS) << 8) * f;
        while f < SCALE && *x >= most {
            shifted.push(*x as u8);
            *x >>= 8;
        }
        *x = ((*x / f) << SCALE_BITS) + *x % f + start;
    }
    for x in states {
        out.extend_from_slice(&x.to_le_bytes());
    }
    out.extend(shifted.into_iter().rev());
}

/// Fills `out` with the bytes of a stream; `stream` must be used up.
///
/// # Errors
/// [`Damaged`].
pub fn decode(stream: &[u8], out: &mut [u8]) -> Result<(), Damaged> {
    let mut rest = stream;
    let mut take = |n: usize| -> Result<&[u8], Damaged> {
        let (head, tail) = rest.split_at_checked(n).ok_or(Damaged)?;
        rest = tail;
        Ok(head)
    };
    let mask = take(32)?;
    // Slots: value, frequency minus one, and index of the slot within the value's range.
    let mut table = [0u32; SCALE as usize];
    let mut start = 0u32;
    for value in (0..256u32).filter(|v| mask[*v as usize / 8] >> (v % 8) & 1 != 0) {
        let f = take(2)?;
        let f = u16::from_le_bytes([f[0], f[1]]) as u32 + 1;
        let slots = table.get_mut(start as usize..(start + f) as usize).ok_or(Damaged)?;
        for (within, slot) in (0u32..).zip(slots) {
            *slot = value | (f - 1) << 8 | within << 20;
        }
        start += f;
    }
    if out.is_empty() {
        return Ok(());
    }
    if start != SCALE {
        return Err(Damaged);
    }
    let mut states = [0u32; 2];
    for x in &mut states {
        let bytes = take(4)?;
        *x = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        if *x < LOW || *x >= LOW << 8 {
            return Err(Damaged);
        }
    }
    let mut words = rest.iter();
    // A constant stream leaves the states unchanged.
    if table[0] >> 8 == SCALE - 1 {
        out.fill(table[0] as u8);
        return if rest.is_empty() && states == [LOW; 2] { Ok(()) } else { Err(Damaged) };
    }
    for part in out.chunks_mut(CHUNK) {
        decode_part(&table, &mut states, &mut words, part)?;
    }
    if words.next().is_some() || states != [LOW; 2] { Err(Damaged) } else { Ok(()) }
}

/// Chunk length, even since two states alternate. A browser runs a wasm function at full speed only from a later call
/// on, not from the middle of the first call.
const CHUNK: usize = 4096;

#[inline(never)]
fn decode_part(
    table: &[u32],
    states: &mut [u32; 2],
    words: &mut std::slice::Iter<'_, u8>,
    out: &mut [u8],
) -> Result<(), Damaged> {
    for (i, byte) in out.iter_mut().enumerate() {
        let x = &mut states[i % 2];
        let slot = table[(*x & (SCALE - 1)) as usize];
        *x = ((slot >> 8 & (SCALE - 1)) + 1) * (*x >> SCALE_BITS) + (slot >> 20);
        while *x < LOW {
            *x = *x << 8 | *words.next().ok_or(Damaged)? as u32;
        }
        *byte = slot as u8;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(stream: &[u8], len: usize) -> Result<Vec<u8>, Damaged> {
        let mut out = vec![0; len];
        decode(stream, &mut out).map(|()| out)
    }

    fn noise(n: u32, spread: f32) -> Vec<u8> {
        let random = |i: u32| {
            let x = (i ^ 0x85eb_ca6b).wrapping_mul(0x9e37_79b9);
            ((x ^ (x >> 15)).wrapping_mul(0x846c_a68b) >> 8) as f32 / (1 << 24) as f32
        };
        (0..n).map(|i| (random(i).powf(spread) * 256.0) as u8).collect()
    }

    #[test]
    fn bytes_come_back_and_take_about_their_entropy() {
        let cases =
            [Vec::new(), vec![7], vec![9; 5000], noise(1, 1.0), noise(100_000, 1.0), noise(100_000, 8.0)];
        for bytes in cases {
            let mut stream = Vec::new();
            encode(&bytes, &mut stream);
            assert_eq!(decoded(&stream, bytes.len()).unwrap(), bytes);
            let mut counts = [0f64; 256];
            bytes.iter().for_each(|b| counts[*b as usize] += 1.0);
            let n = bytes.len() as f64;
            let bits: f64 = counts.iter().filter(|c| **c > 0.0).map(|c| c * (n / c).log2()).sum();
            assert!(stream.len() as f64 <= bits / 8.0 * 1.01 + 560.0, "{} of {}", stream.len(), bits / 8.0);
        }
    }

    #[test]
    fn damaged_streams_are_refused_or_give_other_bytes_but_never_panic() {
        let bytes = noise(3000, 3.0);
        let mut stream = Vec::new();
        encode(&bytes, &mut stream);
        assert!(decoded(&stream[..stream.len() - 1], bytes.len()).is_err());
        assert!(decoded(&stream, bytes.len() + 1).is_err());
        assert!(decoded(&[], 1).is_err());
        for i in 0..stream.len() {
            let mut damaged = stream.clone();
            damaged[i] ^= 1 << (i % 8);
            if let Ok(other) = decoded(&damaged, bytes.len()) {
                assert_ne!(other, bytes, "byte {i} does not matter");
            }
        }
    }
}
