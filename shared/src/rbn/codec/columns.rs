//! Codec of fixed-size records, field by field: neighbours in a section are close in space, so a field is a column of
//! slowly changing numbers.
//!
//! A column is packed as values or as differences, whichever is shorter, in as few byte planes as needed. Numbers
//! rounded to multiples of a power of two (positions, texture coordinates) are stored as integer multiples.

use super::{Damaged, Reader, Writer};
use crate::octahedral::NORMAL_STEP;
use crate::rbn::bulk::{Copies, Cut, Instance, Point, Vertex};
use crate::rbn::light_groups::GroupValue;
use crate::rbn::lightmap::{ChartOffset, Texel, TexelCoordinates};
use bytemuck::Pod;

/// Type of a 32-bit word of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// An integer.
    Number,
    /// A float.
    Float,
    /// Two 16-bit numbers: a direction, or coordinates.
    Pair,
    /// A colour, rgb9e5.
    Colour,
    /// Number of cuts, samples, first cut: [`Point::cuts`].
    Cuts,
    /// Signed steps of three channels: [`GroupValue`].
    Steps,
}

/// Record of 32-bit words.
pub trait Columns: Pod {
    /// Types of the words.
    const KINDS: &'static [Kind];
}

impl Columns for u32 {
    const KINDS: &'static [Kind] = &[Kind::Number];
}

impl Columns for Vertex {
    const KINDS: &'static [Kind] =
        &[Kind::Float, Kind::Float, Kind::Float, Kind::Pair, Kind::Float, Kind::Float];
}

impl Columns for Point {
    const KINDS: &'static [Kind] =
        &[Kind::Float, Kind::Float, Kind::Float, Kind::Float, Kind::Pair, Kind::Cuts, Kind::Colour];
}

impl Columns for Instance {
    const KINDS: &'static [Kind] = &[Kind::Float; 12];
}

impl Columns for Copies {
    const KINDS: &'static [Kind] = &[Kind::Number; 2];
}

impl Columns for GroupValue {
    const KINDS: &'static [Kind] = &[Kind::Steps];
}

impl Columns for TexelCoordinates {
    const KINDS: &'static [Kind] = &[Kind::Pair];
}

impl Columns for ChartOffset {
    const KINDS: &'static [Kind] = &[Kind::Pair; 2];
}

impl Columns for Texel {
    const KINDS: &'static [Kind] = &[Kind::Colour];
}

impl Columns for Cut {
    const KINDS: &'static [Kind] = &[Kind::Float, Kind::Float, Kind::Float];
}

/// Offset of a float column's exponent; keeps the header above any number of bits.
const EXPONENT_BIAS: i32 = 256;

/// Packs records.
pub fn encode<T: Columns>(records: &[T]) -> Vec<u8> {
    encode_words(bytemuck::cast_slice(records), T::KINDS)
}

/// One copy of the code for all records.
fn encode_words(words: &[u32], kinds: &[Kind]) -> Vec<u8> {
    let mut writer = Writer::default();
    let width = kinds.len();
    writer.number(words.len() / width);
    for (w, kind) in kinds.iter().enumerate() {
        let column: Vec<u32> = words.iter().skip(w).step_by(width).copied().collect();
        encode_column(*kind, &column, &mut writer);
    }
    writer.finish(size_of_val(words))
}

/// Unpacks the records of a section.
///
/// # Errors
/// [`Damaged`].
pub fn decode<T: Columns>(section: &[u8]) -> Result<Vec<T>, Damaged> {
    let mut reader = Reader::new(section);
    let count = reader.number()?;
    reader.allow(count.checked_mul(size_of::<T>()).ok_or(Damaged)?)?;
    let mut out = vec![T::zeroed(); count];
    decode_words(&mut reader, bytemuck::cast_slice_mut(&mut out), T::KINDS)?;
    reader.finish()?;
    Ok(out)
}

fn decode_words(reader: &mut Reader<'_>, words: &mut [u32], kinds: &[Kind]) -> Result<(), Damaged> {
    let width = kinds.len();
    for (w, kind) in kinds.iter().enumerate() {
        let column = decode_column(*kind, reader, words.len() / width)?;
        for (records, column) in words.chunks_mut(CHUNK * width).zip(column.chunks(CHUNK)) {
            put(records, [w, width], column);
        }
    }
    Ok(())
}

fn encode_column(kind: Kind, column: &[u32], writer: &mut Writer) {
    let mut field = |value: &mut dyn FnMut(u32) -> u32| {
        let values: Vec<u32> = column.iter().map(|word| value(*word)).collect();
        encode_numbers(&values, writer);
    };
    match kind {
        Kind::Number => field(&mut |word| word),
        Kind::Float => match common_step(column) {
            Some(exponent) => {
                writer.number((exponent + EXPONENT_BIAS) as usize);
                let numbers: Vec<u32> = column.iter().map(|word| in_steps(*word, exponent)).collect();
                encode_numbers(&numbers, writer);
            }
            None => {
                let low = column.iter().fold(0, |all, word| all | word).trailing_zeros().min(31);
                writer.number(low as usize);
                let numbers: Vec<u32> = column.iter().map(|word| word >> low).collect();
                encode_numbers(&numbers, writer);
            }
        },
        Kind::Pair => {
            let halves = |word: u32| [word as i16, (word >> 16) as i16];
            let rounded = column.iter().all(|word| halves(*word).iter().all(|x| x % NORMAL_STEP == 0));
            let step = if rounded { NORMAL_STEP } else { 1 };
            writer.number(step as usize);
            for half in 0..2 {
                let numbers: Vec<u32> =
                    column.iter().map(|word| (halves(*word)[half] / step) as i32 as u32).collect();
                encode_numbers(&numbers, writer);
            }
        }
        Kind::Colour => {
            let all = column.iter().fold(0, |all, word| all | word);
            let low = (all | all >> 9 | all >> 18 | 1 << 8).trailing_zeros();
            writer.number(low as usize);
            for shift in [0, 9, 18] {
                let numbers: Vec<u32> = column.iter().map(|word| (word >> shift & 511) >> low).collect();
                encode_numbers(&numbers, writer);
            }
            let exponents: Vec<u32> = column.iter().map(|word| word >> 27).collect();
            encode_numbers(&exponents, writer);
        }
        Kind::Cuts => {
            field(&mut |word| word & 7);
            field(&mut |word| word >> 3 & 255);
            // The cuts of consecutive points are contiguous.
            let mut next = 0;
            field(&mut |word| {
                let skipped = (word >> 11).wrapping_sub(next);
                next = (word >> 11) + (word & 7);
                skipped
            });
        }
        Kind::Steps => {
            for part in 0..3 {
                field(&mut |word| zigzag(GroupValue(word).split()[part] as u32));
            }
        }
    }
}

fn decode_column(kind: Kind, reader: &mut Reader<'_>, count: usize) -> Result<Vec<u32>, Damaged> {
    match kind {
        Kind::Number => decode_numbers(reader, count),
        Kind::Float => {
            let header = reader.number()?;
            let mut column = decode_numbers(reader, count)?;
            if header < 32 {
                column.iter_mut().for_each(|word| *word <<= header);
            } else {
                // Step 2^exponent, a normal float.
                let exponent = header.checked_sub((EXPONENT_BIAS - 126) as usize).ok_or(Damaged)?;
                if exponent > 252 {
                    return Err(Damaged);
                }
                let step = f32::from_bits((exponent as u32 + 1) << 23);
                column.iter_mut().for_each(|word| *word = (*word as i32 as f32 * step).to_bits());
            }
            Ok(column)
        }
        Kind::Pair => {
            let step = reader.number()? as u32;
            if step != 1 && step != NORMAL_STEP as u32 {
                return Err(Damaged);
            }
            let mut column = decode_numbers(reader, count)?;
            let high = decode_numbers(reader, count)?;
            for (word, high) in column.iter_mut().zip(high) {
                *word = (word.wrapping_mul(step) & 0xffff) | high.wrapping_mul(step) << 16;
            }
            Ok(column)
        }
        Kind::Colour => {
            let low = reader.number()?;
            if low > 8 {
                return Err(Damaged);
            }
            let mut column = vec![0; count];
            for shift in [0, 9, 18] {
                for (word, value) in column.iter_mut().zip(decode_numbers(reader, count)?) {
                    *word |= (value << low & 511) << shift;
                }
            }
            for (word, value) in column.iter_mut().zip(decode_numbers(reader, count)?) {
                *word |= value << 27;
            }
            Ok(column)
        }
        Kind::Cuts => {
            let mut column = decode_numbers(reader, count)?;
            let samples = decode_numbers(reader, count)?;
            let skipped = decode_numbers(reader, count)?;
            let mut next = 0u32;
            for ((word, samples), skipped) in column.iter_mut().zip(samples).zip(skipped) {
                let (first, own) = (skipped.wrapping_add(next) & ((1 << 21) - 1), *word & 7);
                next = first + own;
                *word = own | (samples & 255) << 3 | first << 11;
            }
            Ok(column)
        }
        Kind::Steps => {
            let mut column = decode_numbers(reader, count)?;
            let second = decode_numbers(reader, count)?;
            let third = decode_numbers(reader, count)?;
            for ((word, second), third) in column.iter_mut().zip(second).zip(third) {
                *word = GroupValue::join([*word, second, third].map(|number| unzigzag(number) as i32)).0;
            }
            Ok(column)
        }
    }
}

/// Returns the exponent of the largest power of two that divides every float, if the multiples fit in 31 bits.
fn common_step(column: &[u32]) -> Option<i32> {
    let (mut lowest, mut highest) = (i32::MAX, i32::MIN);
    for &word in column {
        let exponent = (word >> 23 & 255) as i32 - 127;
        if word == 0 {
            continue;
        }
        // Columns with negative zero, denormals, infinities or NaNs are stored as bits.
        if exponent == -127 || exponent == 128 {
            return None;
        }
        let zeros = ((word & 0x7f_ffff) | 0x80_0000).trailing_zeros() as i32;
        lowest = lowest.min(exponent - 23 + zeros);
        highest = highest.max(exponent);
    }
    let lowest = if lowest == i32::MAX { 0 } else { lowest };
    // The step is a normal float: multiples of smaller steps are stored as bits.
    (highest.max(lowest) - lowest < 30 && (-126..=126).contains(&lowest)).then_some(lowest)
}

/// Converts a float to an integer multiple of 2^exponent.
fn in_steps(word: u32, exponent: i32) -> u32 {
    (f32::from_bits(word) as f64 * (-exponent as f64).exp2()) as i32 as u32
}

/// Writes numbers as values or differences. Header: twice the number of byte planes, plus 1 for differences; then the
/// planes, low bytes first.
fn encode_numbers(values: &[u32], writer: &mut Writer) {
    let plain = planes(values, 0);
    let mut last = 0u32;
    let differences: Vec<u32> = values
        .iter()
        .map(|value| {
            let difference = value.wrapping_sub(last);
            last = *value;
            zigzag(difference)
        })
        .collect();
    let differences = planes(&differences, 1);
    writer.append_shorter(differences, plain);
}

fn planes(values: &[u32], flag: usize) -> Writer {
    let bits = 32 - values.iter().fold(0, |all, value| all | value).leading_zeros();
    let count = bits.div_ceil(8);
    let mut writer = Writer::default();
    writer.number((count as usize) << 1 | flag);
    for byte in 0..count {
        let plane: Vec<u8> = values.iter().map(|value| (value >> (8 * byte)) as u8).collect();
        writer.bytes(&plane);
    }
    writer
}

fn decode_numbers(reader: &mut Reader<'_>, count: usize) -> Result<Vec<u32>, Damaged> {
    let header = reader.number()?;
    let mut values = vec![0u32; count];
    if header >> 1 > 4 {
        return Err(Damaged);
    }
    for byte in 0..header >> 1 {
        let plane = reader.bytes(count)?;
        for (values, plane) in values.chunks_mut(CHUNK).zip(plane.chunks(CHUNK)) {
            add_plane(values, plane, 8 * byte as u32);
        }
    }
    if header & 1 != 0 {
        let mut last = 0;
        for part in values.chunks_mut(CHUNK) {
            last = add_up(part, last);
        }
    }
    Ok(values)
}

/// Chunk length: a browser runs a wasm function at full speed only from a later call on.
const CHUNK: usize = 1024;

#[inline(never)]
fn put(records: &mut [u32], [w, width]: [usize; 2], column: &[u32]) {
    for (record, value) in records.chunks_exact_mut(width).zip(column) {
        record[w] = *value;
    }
}

#[inline(never)]
fn add_plane(values: &mut [u32], plane: &[u8], shift: u32) {
    for (value, byte) in values.iter_mut().zip(plane) {
        *value |= (*byte as u32) << shift;
    }
}

/// Sums differences in place; returns the last number.
#[inline(never)]
fn add_up(part: &mut [u32], mut last: u32) -> u32 {
    for value in part {
        last = last.wrapping_add(unzigzag(*value));
        *value = last;
    }
    last
}

/// Maps small differences of either sign to small numbers.
fn zigzag(difference: u32) -> u32 {
    difference << 1 ^ ((difference as i32 >> 31) as u32)
}

fn unzigzag(value: u32) -> u32 {
    value >> 1 ^ (value & 1).wrapping_neg()
}

#[cfg(test)]
mod tests;
