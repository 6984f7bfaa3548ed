//! Codec of rows of ascending indices with values: transport links.
//!
//! A row is stored as its length and, per entry, the step from the previous index. Numbers are written by class
//! ([`super::bits`]). The context of a step's class is the class of the previous step, since senders visible together
//! are close in index. Values beside the indices are split into entropy-coded bytes, signs (which come in runs), and
//! nearly random bits ([`Beside`]).

use super::bits::{BitReader, BitWriter, class, push_rest, take_value};
use super::{Damaged, Reader, Writer};
use crate::link::{LaterLink, Link, MAX_SENDERS, MAX_SOURCES, Sent, SourceLink};

/// Entry of a row: an index and a value.
pub trait Beside: Copy {
    /// Number of entropy-coded byte streams.
    const BYTES: usize;
    /// Returns the index; ascends within a row.
    fn index(self) -> u32;
    /// Returns true for a negative value.
    fn is_negative(self) -> bool;
    /// Writes the value: a byte to stream `bytes[k]`, and bits.
    fn split(self, bytes: &mut [Vec<u8>], bits: &mut BitWriter);
    /// Reassembles an entry; `bytes` has the next byte of every stream.
    ///
    /// # Errors
    /// [`Damaged`].
    fn join(index: u32, is_negative: bool, bytes: &[u8], bits: &mut BitReader<'_>) -> Result<Self, Damaged>;
}

impl Beside for Link {
    /// Exponent and mantissa.
    const BYTES: usize = 1;

    fn index(self) -> u32 {
        self.sender() as u32
    }

    fn is_negative(self) -> bool {
        self.0 >> 31 != 0
    }

    fn split(self, bytes: &mut [Vec<u8>], _: &mut BitWriter) {
        bytes[0].push((self.0 >> 20) as u8);
    }

    fn join(index: u32, is_negative: bool, bytes: &[u8], _: &mut BitReader<'_>) -> Result<Self, Damaged> {
        if index as usize >= MAX_SENDERS {
            return Err(Damaged);
        }
        Ok(Self((is_negative as u32) << 31 | (bytes[0] as u32) << 20 | index))
    }
}

impl Beside for SourceLink {
    /// Low and high byte of the number of steps.
    const BYTES: usize = 2;

    fn index(self) -> u32 {
        self.sender() as u32
    }

    fn is_negative(self) -> bool {
        self.steps() < 0
    }

    fn split(self, bytes: &mut [Vec<u8>], _: &mut BitWriter) {
        let [low, high, ..] = self.steps().unsigned_abs().to_le_bytes();
        bytes[0].push(low);
        bytes[1].push(high);
    }

    fn join(index: u32, is_negative: bool, bytes: &[u8], _: &mut BitReader<'_>) -> Result<Self, Damaged> {
        if index as usize >= MAX_SOURCES {
            return Err(Damaged);
        }
        let steps = i32::from(u16::from_le_bytes([bytes[0], bytes[1]]));
        Ok(Self::pack(index, if is_negative { -steps } else { steps }))
    }
}

/// Number of low mantissa bits of a later link's colour that the baker leaves zero.
const LOW: u32 = 4;
const LOW_BITS: u32 = 0b1111 << 18 | 0b1111 << 9 | 0b1111;

impl Beside for LaterLink {
    /// High bits of the mantissas: green, red minus green, blue minus green; then the exponent, plus 32 if low bits
    /// follow.
    const BYTES: usize = 4;

    fn index(self) -> u32 {
        self.sender
    }

    fn is_negative(self) -> bool {
        false
    }

    fn split(self, bytes: &mut [Vec<u8>], bits: &mut BitWriter) {
        let high = |c: u32| (self.colour >> (9 * c + LOW)) as u8 & 31;
        bytes[0].push(high(1));
        bytes[1].push(high(0).wrapping_sub(high(1)) & 31);
        bytes[2].push(high(2).wrapping_sub(high(1)) & 31);
        let low = self.colour & LOW_BITS;
        bytes[3].push((self.colour >> 27) as u8 | if low != 0 { 32 } else { 0 });
        if low != 0 {
            (0..3).for_each(|c| bits.push(self.colour >> (9 * c), LOW));
        }
    }

    fn join(index: u32, is_negative: bool, bytes: &[u8], bits: &mut BitReader<'_>) -> Result<Self, Damaged> {
        if is_negative {
            return Err(Damaged);
        }
        let green = bytes[0];
        let high = [green.wrapping_add(bytes[1]), green, green.wrapping_add(bytes[2])];
        let mut colour = (bytes[3] as u32) << 27;
        for (c, high) in high.into_iter().enumerate() {
            let low = if bytes[3] & 32 != 0 { bits.take(LOW)? } else { 0 };
            colour |= ((high as u32 & 31) << LOW | low) << (9 * c);
        }
        Ok(Self { sender: index, colour })
    }
}

/// Number of classes of a step; the class is the context of the next step's class.
const CLASSES: usize = 33;

/// Packs rows `entries[offsets[i]..offsets[i + 1]]` with ascending indices.
pub fn encode<E: Beside>(offsets: &[u32], entries: &[E]) -> Vec<u8> {
    let mut bits = BitWriter::default();
    let mut lengths = Vec::new();
    let mut steps = vec![Vec::new(); CLASSES];
    let mut signs = vec![0u8; entries.len().div_ceil(8)];
    let mut bytes = vec![Vec::with_capacity(entries.len()); E::BYTES];
    for row in offsets.windows(2) {
        lengths.push(class(row[1] - row[0]));
        push_rest(&mut bits, row[1] - row[0]);
        let (mut last, mut context) = (0, 0);
        for k in row[0] as usize..row[1] as usize {
            let entry = entries[k];
            let step = entry.index() - last;
            last = entry.index();
            steps[context].push(class(step));
            context = class(step) as usize;
            push_rest(&mut bits, step);
            signs[k / 8] |= (entry.is_negative() as u8) << (k % 8);
            entry.split(&mut bytes, &mut bits);
        }
    }
    let mut writer = Writer::default();
    writer.number(lengths.len());
    writer.number(entries.len());
    writer.bytes(&lengths);
    steps.iter().for_each(|stream| writer.bytes(stream));
    writer.bytes(&signs);
    bytes.iter().for_each(|stream| writer.bytes(stream));
    let bits = bits.finish();
    writer.bytes(&bits);
    writer.finish(4 * offsets.len() + size_of_val(entries) + bits.len())
}

/// The streams of a section, before its entries are joined.
struct Streams {
    lengths: Vec<u8>,
    count: usize,
    steps: Vec<std::vec::IntoIter<u8>>,
    signs: Vec<u8>,
    bytes: Vec<Vec<u8>>,
    bits: Vec<u8>,
}

impl Streams {
    /// Reads the streams of entries that take `size` bytes in memory and have `beside` bytes each. Not generic: the
    /// viewer has the code once.
    fn read(section: &[u8], size: usize, beside: usize) -> Result<Self, Damaged> {
        let mut reader = Reader::new(section);
        let (rows, count) = (reader.number()?, reader.number()?);
        reader.allow(rows.checked_mul(4).and_then(|bytes| bytes.checked_add(4)).ok_or(Damaged)?)?;
        reader.allow(count.checked_mul(size).ok_or(Damaged)?)?;
        let lengths = reader.bytes(rows)?;
        let mut steps = Vec::with_capacity(CLASSES);
        let mut left = count;
        for _ in 0..CLASSES {
            let stream = reader.bytes_up_to(left)?;
            left -= stream.len();
            steps.push(stream.into_iter());
        }
        let signs = reader.bytes(count.div_ceil(8))?;
        // Unused bits of the last sign byte are zero.
        let spare = signs.last().is_some_and(|last| count % 8 != 0 && last >> (count % 8) != 0);
        let bytes = (0..beside).map(|_| reader.bytes(count)).collect::<Result<Vec<_>, _>>()?;
        let bits = reader.any_bytes()?;
        reader.finish()?;
        if left != 0 || spare {
            return Err(Damaged);
        }
        Ok(Self { lengths, count, steps, signs, bytes, bits })
    }
}

/// Unpacks the offsets and entries of a section.
///
/// # Errors
/// [`Damaged`].
pub fn decode<E: Beside>(section: &[u8]) -> Result<(Vec<u32>, Vec<E>), Damaged> {
    let mut streams = Streams::read(section, size_of::<E>(), E::BYTES)?;
    let (lengths, bits) = (std::mem::take(&mut streams.lengths), std::mem::take(&mut streams.bits));
    let mut bits = BitReader::new(&bits);
    let (mut offsets, mut entries) =
        (Vec::with_capacity(lengths.len() + 1), Vec::with_capacity(streams.count));
    offsets.push(0);
    for length in lengths {
        let length = take_value(&mut bits, length)? as usize;
        if length > streams.count - entries.len() {
            return Err(Damaged);
        }
        decode_row(length, &mut streams, &mut bits, &mut entries)?;
        offsets.push(entries.len() as u32);
    }
    bits.finish()?;
    if entries.len() == streams.count { Ok((offsets, entries)) } else { Err(Damaged) }
}

/// Decodes one row. A separate function, since a browser runs wasm at full speed only from a later call of a function
/// on.
#[inline(never)]
fn decode_row<E: Beside>(
    length: usize,
    streams: &mut Streams,
    bits: &mut BitReader<'_>,
    entries: &mut Vec<E>,
) -> Result<(), Damaged> {
    let (mut index, mut context, mut beside) = (0u32, 0, [0; 4]);
    for _ in 0..length {
        let k = entries.len();
        let class = streams.steps[context].next().ok_or(Damaged)?;
        index = index.checked_add(take_value(bits, class)?).ok_or(Damaged)?;
        context = class as usize;
        for (byte, stream) in beside.iter_mut().zip(&streams.bytes) {
            *byte = stream[k];
        }
        let is_negative = streams.signs[k / 8] >> (k % 8) & 1 != 0;
        entries.push(E::join(index, is_negative, &beside[..E::BYTES], bits)?);
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
        // Damage gives an error or different rows, no panic.
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
        // Constant rows: next to nothing once packed, and still within the limit of a reader.
        round_trip(((0..=20_000).collect(), vec![Link::pack(0, 1.0); 20_000]));
        round_trip::<Link>((vec![0], Vec::new()));
        round_trip::<Link>((vec![0; 400], Vec::new()));
    }
}
