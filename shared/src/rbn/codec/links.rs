//! Rows of ascending indices with something beside each: transport links and interpolation rows.
//!
//! Of each row: how many; of each entry: the step from the index before it in the row. Numbers are written by
//! class ([`super::bits`]). What stands beside the indices is split into bytes that are entropy coded and bits
//! that are not, as suits each kind ([`Beside`]).

use super::bits::{BitReader, BitWriter, class, push_rest, take_value};
use super::{Damaged, Reader, Writer};
use crate::interpolation::{Entry, MAX_POINTS};
use crate::link::{LaterLink, Link, MAX_SENDERS, Sent};

/// An entry of a row: an index, and something beside it.
pub trait Beside: Copy {
    /// Streams of bytes that are entropy coded.
    const BYTES: usize;
    /// The index; ascends within a row.
    fn index(self) -> u32;
    /// Writes the rest: `bytes[k]` into stream k, and bits.
    fn split(self, bytes: &mut [Vec<u8>], bits: &mut BitWriter);
    /// Puts it together again; `bytes` has the next byte of each stream.
    ///
    /// # Errors
    /// [`Damaged`].
    fn join(index: u32, bytes: &[u8], bits: &mut BitReader<'_>) -> Result<Self, Damaged>;
}

impl Beside for Link {
    /// Sign and exponent; the mantissa's bits say little.
    const BYTES: usize = 1;

    fn index(self) -> u32 {
        self.sender() as u32
    }

    fn split(self, bytes: &mut [Vec<u8>], bits: &mut BitWriter) {
        bytes[0].push((self.0 >> 24) as u8);
        bits.push(self.0 >> 20, 4);
    }

    fn join(index: u32, bytes: &[u8], bits: &mut BitReader<'_>) -> Result<Self, Damaged> {
        if index as usize >= MAX_SENDERS || bytes[0] & 0x60 != 0 {
            return Err(Damaged);
        }
        Ok(Self((bytes[0] as u32) << 24 | bits.take(4)? << 20 | index))
    }
}

/// The low three bits of the mantissas of a later link's colour, which the baker leaves zero.
const LOW_BITS: u32 = 0b111 << 18 | 0b111 << 9 | 0b111;

impl Beside for LaterLink {
    /// The colour.
    const BYTES: usize = 4;

    fn index(self) -> u32 {
        self.sender
    }

    fn split(self, bytes: &mut [Vec<u8>], bits: &mut BitWriter) {
        // The mantissas' high bits, and the exponent; their low bits, where there are any.
        let low = self.colour & LOW_BITS;
        for c in 0..3 {
            bytes[c].push((self.colour >> (9 * c + 3)) as u8 & 63);
            if low != 0 {
                bits.push(self.colour >> (9 * c), 3);
            }
        }
        bytes[3].push((self.colour >> 27) as u8 | if low != 0 { 32 } else { 0 });
    }

    fn join(index: u32, bytes: &[u8], bits: &mut BitReader<'_>) -> Result<Self, Damaged> {
        let mut colour = (bytes[3] as u32) << 27;
        for c in 0..3 {
            let low = if bytes[3] & 32 != 0 { bits.take(3)? } else { 0 };
            colour |= ((bytes[c] as u32 & 63) << 3 | low) << (9 * c);
        }
        Ok(Self { sender: index, colour })
    }
}

impl Beside for Entry {
    /// None: weights are spread evenly.
    const BYTES: usize = 0;

    fn index(self) -> u32 {
        self.point() as u32
    }

    fn split(self, _: &mut [Vec<u8>], bits: &mut BitWriter) {
        bits.push(self.0 >> 22, 7);
    }

    fn join(index: u32, _: &[u8], bits: &mut BitReader<'_>) -> Result<Self, Damaged> {
        if index as usize >= MAX_POINTS { Err(Damaged) } else { Ok(Self(bits.take(7)? << 22 | index)) }
    }
}

/// Packs rows: `entries[offsets[i]..offsets[i + 1]]`; indices ascend within each.
pub fn encode<E: Beside>(offsets: &[u32], entries: &[E]) -> Vec<u8> {
    let mut bits = BitWriter::default();
    let (mut lengths, mut steps) = (Vec::new(), Vec::with_capacity(entries.len()));
    let mut bytes = vec![Vec::with_capacity(entries.len()); E::BYTES];
    for row in offsets.windows(2) {
        lengths.push(class(row[1] - row[0]));
        push_rest(&mut bits, row[1] - row[0]);
        let mut last = 0;
        for entry in &entries[row[0] as usize..row[1] as usize] {
            let step = entry.index() - last;
            last = entry.index();
            steps.push(class(step));
            push_rest(&mut bits, step);
            entry.split(&mut bytes, &mut bits);
        }
    }
    let mut writer = Writer::default();
    writer.number(lengths.len());
    writer.number(entries.len());
    writer.bytes(&lengths);
    writer.bytes(&steps);
    bytes.iter().for_each(|stream| writer.bytes(stream));
    let bits = bits.finish();
    writer.bytes(&bits);
    writer.finish(4 * offsets.len() + size_of::<E>() * entries.len() + bits.len())
}

/// The offsets and entries of a section.
///
/// # Errors
/// [`Damaged`].
pub fn decode<E: Beside>(section: &[u8]) -> Result<(Vec<u32>, Vec<E>), Damaged> {
    let mut reader = Reader::new(section);
    let (rows, count) = (reader.number()?, reader.number()?);
    reader.allow(rows.checked_mul(4).and_then(|bytes| bytes.checked_add(4)).ok_or(Damaged)?)?;
    reader.allow(count.checked_mul(size_of::<E>()).ok_or(Damaged)?)?;
    let lengths = reader.bytes(rows)?;
    let steps = reader.bytes(count)?;
    let streams = (0..E::BYTES).map(|_| reader.bytes(count)).collect::<Result<Vec<_>, _>>()?;
    let bits = reader.any_bytes()?;
    reader.finish()?;
    let mut bits = BitReader::new(&bits);
    let (mut offsets, mut entries) = (Vec::with_capacity(rows + 1), Vec::with_capacity(count));
    offsets.push(0);
    for length in lengths {
        let length = take_value(&mut bits, length)? as usize;
        if length > count - entries.len() {
            return Err(Damaged);
        }
        decode_row(length, &steps, &streams, &mut bits, &mut entries)?;
        offsets.push(entries.len() as u32);
    }
    bits.finish()?;
    if entries.len() == count { Ok((offsets, entries)) } else { Err(Damaged) }
}

/// One row; a function of its own, as a browser runs wasm at full speed only from some call of a function on.
#[inline(never)]
fn decode_row<E: Beside>(
    length: usize,
    steps: &[u8],
    streams: &[Vec<u8>],
    bits: &mut BitReader<'_>,
    entries: &mut Vec<E>,
) -> Result<(), Damaged> {
    let (mut index, mut beside) = (0u32, [0; 4]);
    for _ in 0..length {
        let k = entries.len();
        index = index.checked_add(take_value(bits, steps[k])?).ok_or(Damaged)?;
        for (byte, stream) in beside.iter_mut().zip(streams) {
            *byte = stream[k];
        }
        entries.push(E::join(index, &beside[..E::BYTES], bits)?);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn random(i: u32) -> u32 {
        let x = (i ^ 0x85eb_ca6b).wrapping_mul(0x9e37_79b9);
        (x ^ (x >> 15)).wrapping_mul(0x846c_a68b) >> 5
    }

    fn rows<E: Beside>(entry: impl Fn(u32, u32) -> E) -> (Vec<u32>, Vec<E>) {
        let (mut offsets, mut entries) = (vec![0], Vec::new());
        for row in 0..500 {
            let mut index = random(row) % 50;
            for k in 0..random(row + 7000) % 40 {
                entries.push(entry(index, row * 40 + k));
                index += 1 + random(row * 40 + k + 99) % 1000;
            }
            offsets.push(entries.len() as u32);
        }
        (offsets, entries)
    }

    fn round_trip<E: Beside + PartialEq + std::fmt::Debug>((offsets, entries): (Vec<u32>, Vec<E>)) -> f64 {
        let packed = encode(&offsets, &entries);
        assert_eq!(decode::<E>(&packed).unwrap(), (offsets.clone(), entries.clone()));
        // Whatever is damaged: an error or other rows, no panic.
        for i in (0..packed.len()).step_by(7) {
            let mut damaged = packed.clone();
            damaged[i] ^= 1 << (i % 8);
            if let Ok(other) = decode::<E>(&damaged) {
                assert_ne!(other, (offsets.clone(), entries.clone()));
            }
            assert!(decode::<E>(&packed[..i]).is_err());
        }
        packed.len() as f64 / entries.len() as f64
    }

    #[test]
    fn every_kind_of_row_comes_back() {
        let amount = |seed: u32| (random(seed) % 1000) as f32 * 1e-5 - 3e-3;
        assert!(round_trip(rows(|index, seed| Link::pack(index, amount(seed)))) < 3.1);
        let direction = |seed: u32| Vec3::new(amount(seed), amount(seed + 1), amount(seed + 2));
        round_trip(rows(|index, seed| LaterLink::pack(index, direction(seed).abs())));
        round_trip(rows(|index, seed| Entry(random(seed) % 128 << 22 | index)));
        // Equal everywhere: next to nothing once packed, and yet not over what a reader allows.
        round_trip(((0..=20_000).collect(), vec![Entry(127 << 22); 20_000]));
        round_trip(((0..=20_000).collect(), vec![Link::pack(0, 1.0); 20_000]));
        round_trip::<Link>((vec![0], Vec::new()));
        round_trip::<Link>((vec![0; 400], Vec::new()));
    }
}
