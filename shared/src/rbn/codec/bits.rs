//! Integers split into an entropy-coded class and raw bits below the leading bit.

use super::Damaged;

/// Writer of bits, low bits first.
#[derive(Default)]
pub struct BitWriter {
    bytes: Vec<u8>,
    pending: u64,
    count: u32,
}

impl BitWriter {
    /// Appends the low `count` bits of `value`, at most 32.
    #[inline]
    pub fn push(&mut self, value: u32, count: u32) {
        self.pending |= (value as u64 & ((1 << count) - 1)) << self.count;
        self.count += count;
        while self.count >= 8 {
            self.bytes.push(self.pending as u8);
            self.pending >>= 8;
            self.count -= 8;
        }
    }

    /// Returns the bits, padded with zeros to a byte.
    pub fn finish(mut self) -> Vec<u8> {
        if self.count > 0 {
            self.bytes.push(self.pending as u8);
        }
        self.bytes
    }
}

/// Reader of bits written by [`BitWriter`].
pub struct BitReader<'a> {
    bytes: &'a [u8],
    pending: u64,
    count: u32,
}

impl<'a> BitReader<'a> {
    /// Creates a reader at the first bit.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, pending: 0, count: 0 }
    }

    /// Reads the next `count` bits, at most 32.
    ///
    /// # Errors
    /// [`Damaged`] past the end.
    #[inline]
    pub fn take(&mut self, count: u32) -> Result<u32, Damaged> {
        while self.count < count {
            let (first, rest) = self.bytes.split_first().ok_or(Damaged)?;
            self.pending |= (*first as u64) << self.count;
            self.count += 8;
            self.bytes = rest;
        }
        let value = self.pending & ((1 << count) - 1);
        self.pending >>= count;
        self.count -= count;
        Ok(value as u32)
    }

    /// # Errors
    /// [`Damaged`] for unread bytes or nonzero padding bits.
    pub fn finish(self) -> Result<(), Damaged> {
        if self.bytes.is_empty() && self.pending == 0 { Ok(()) } else { Err(Damaged) }
    }
}

/// Returns the class of a number: the number of bits, 0 for 0. A number has `class - 1` bits below the leading bit.
#[inline]
pub fn class(value: u32) -> u8 {
    (32 - value.leading_zeros()) as u8
}

/// Writes the bits below the leading bit.
#[inline]
pub fn push_rest(bits: &mut BitWriter, value: u32) {
    let class = class(value) as u32;
    if class > 1 {
        bits.push(value, class - 1);
    }
}

/// Reads a number of this class, at most 32, with low bits from `bits`.
///
/// # Errors
/// [`Damaged`].
#[inline]
pub fn take_value(bits: &mut BitReader<'_>, class: u8) -> Result<u32, Damaged> {
    match class {
        0 => Ok(0),
        1..=32 => Ok(1 << (class - 1) | bits.take(class as u32 - 1)?),
        _ => Err(Damaged),
    }
}
