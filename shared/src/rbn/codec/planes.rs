//! Records of one size: each byte of the record is a stream of its own, and of each the difference to the record
//! before it. Neighbours in a section lie near each other, so high bytes seldom change.

use super::{Damaged, Reader, Writer};
use bytemuck::Pod;
use std::ops::Range;

/// Packs records, which are made of 32-bit words.
pub fn encode<T: Pod>(records: &[T]) -> Vec<u8> {
    let size = size_of::<T>();
    let mut writer = Writer::default();
    writer.number(records.len());
    // Words of four bytes change as a whole: their differences as numbers.
    let words: &[u32] = bytemuck::cast_slice(records);
    let width = size / 4;
    let mut plane = vec![0; records.len()];
    for column in 0..width {
        for byte in 0..4 {
            let mut last = 0u32;
            for (i, out) in plane.iter_mut().enumerate() {
                let word = words[i * width + column];
                *out = (zigzag(word.wrapping_sub(last)) >> (8 * byte)) as u8;
                last = word;
            }
            writer.bytes(&plane);
        }
    }
    writer.finish(size * records.len())
}

/// The records of a section.
///
/// # Errors
/// [`Damaged`].
pub fn decode<T: Pod>(section: &[u8]) -> Result<Vec<T>, Damaged> {
    let size = size_of::<T>();
    let mut reader = Reader::new(section);
    let count = reader.number()?;
    reader.allow(count.checked_mul(size).ok_or(Damaged)?)?;
    let mut out = vec![T::zeroed(); count];
    let words: &mut [u32] = bytemuck::cast_slice_mut(&mut out);
    let width = size / 4;
    for column in 0..width {
        let planes = [reader.bytes(count)?, reader.bytes(count)?, reader.bytes(count)?, reader.bytes(count)?];
        let mut last = 0u32;
        for first in (0..count).step_by(CHUNK) {
            last = decode_part(words, [width, column], &planes, first..count.min(first + CHUNK), last);
        }
    }
    reader.finish()?;
    Ok(out)
}

/// In parts, as a browser runs a wasm function at full speed only from some call of it on.
const CHUNK: usize = 1024;

/// One word of some records; the last one's.
#[inline(never)]
fn decode_part(
    words: &mut [u32],
    [width, column]: [usize; 2],
    planes: &[Vec<u8>; 4],
    records: Range<usize>,
    mut last: u32,
) -> u32 {
    for i in records {
        let difference = u32::from_le_bytes([planes[0][i], planes[1][i], planes[2][i], planes[3][i]]);
        last = last.wrapping_add(unzigzag(difference));
        words[i * width + column] = last;
    }
    last
}

/// Small differences of either sign as small numbers.
fn zigzag(difference: u32) -> u32 {
    difference << 1 ^ ((difference as i32 >> 31) as u32)
}

fn unzigzag(value: u32) -> u32 {
    value >> 1 ^ (value & 1).wrapping_neg()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_come_back_and_neighbours_cost_little() {
        let records: Vec<[u32; 3]> =
            (0..5000u32).map(|i| [i * 7, (0.1 * i as f32).to_bits(), 0xffff_ffff - i]).collect();
        let packed = encode(&records);
        assert_eq!(decode::<[u32; 3]>(&packed).unwrap(), records);
        assert!(packed.len() < records.len() * 4, "{}", packed.len());
        assert_eq!(decode::<u32>(&encode::<u32>(&[])).unwrap(), Vec::<u32>::new());
    }

    #[test]
    fn a_section_that_promises_too_much_is_refused_before_it_is_made() {
        let packed = encode(&vec![5u32; 1_000_000]);
        assert_eq!(decode::<u32>(&packed).unwrap().len(), 1_000_000);
        assert!(decode::<u32>(&packed[..packed.len() - 1]).is_err());
        let mut lying = encode(&[1u32, 2, 3]);
        lying[..4].copy_from_slice(&u32::MAX.to_le_bytes());
        assert_eq!(decode::<u32>(&lying), Err(Damaged));
    }
}
