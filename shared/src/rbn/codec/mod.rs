//! Lossless packing of the bulk sections in a file.
//!
//! * [`rans`] – entropy coding of bytes;
//! * [`bits`] – numbers as classes and bits;
//! * [`links`] – rows of ascending indices with values: transport links;
//! * [`columns`] – other records, field by field.
//!
//! Contents are at most [`MOST_TIMES`] times the packed size, so that a reader can bound allocations by the bytes
//! present.

mod bits;
pub mod columns;
pub mod links;
mod rans;

/// Maximum ratio of a section's contents to its packed size.
pub const MOST_TIMES: usize = 64;

/// Number of stream bytes coded with one table.
const BLOCK: usize = 1 << 15;

/// Maximum size of a section's contents, bytes.
const MOST: usize = 1 << 30;

/// A packed section that was not written by [`Writer`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Damaged;

/// Packs a section: a sequence of numbers and streams.
#[derive(Default)]
pub struct Writer {
    out: Vec<u8>,
}

impl Writer {
    /// Appends a number.
    pub fn number(&mut self, value: usize) {
        self.out.extend_from_slice(&(value as u32).to_le_bytes());
    }

    /// Appends bytes in blocks, entropy coded if shorter. Statistics change along a section with the level of the
    /// rows, so blocks have separate tables.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.number(bytes.len());
        for block in bytes.chunks(BLOCK) {
            let mut packed = Vec::new();
            // Shorter blocks cannot shrink.
            if block.len() > rans::LEAST {
                rans::encode(block, &mut packed);
            }
            let is_shorter = !packed.is_empty() && packed.len() < block.len();
            let (is_packed, content) = if is_shorter { (1, &packed[..]) } else { (0, block) };
            self.number(content.len() << 1 | is_packed);
            self.out.extend_from_slice(content);
        }
    }

    /// Appends the shorter of two outputs, the second in a tie.
    pub fn append_shorter(&mut self, one: Writer, other: Writer) {
        self.out.extend_from_slice(if one.out.len() < other.out.len() { &one.out } else { &other.out });
    }

    /// Returns the section, given the size of its contents in bytes.
    pub fn finish(mut self, contents: usize) -> Vec<u8> {
        // Zero padding keeps the ratio of contents to size within the limit.
        let least = contents.div_ceil(MOST_TIMES);
        if self.out.len() < least {
            self.out.resize(least, 0);
        }
        self.out
    }
}

/// Reads a section packed by [`Writer`].
pub struct Reader<'a> {
    rest: &'a [u8],
    /// Remaining bytes that may be decoded.
    allowed: usize,
}

impl<'a> Reader<'a> {
    /// Creates a reader for a section's bytes.
    pub fn new(section: &'a [u8]) -> Self {
        Self { rest: section, allowed: section.len().saturating_mul(MOST_TIMES).min(MOST) }
    }

    fn take(&mut self, n: usize) -> Result<&'a [u8], Damaged> {
        let (head, tail) = self.rest.split_at_checked(n).ok_or(Damaged)?;
        self.rest = tail;
        Ok(head)
    }

    /// The next number.
    ///
    /// # Errors
    /// [`Damaged`].
    pub fn number(&mut self) -> Result<usize, Damaged> {
        let bytes = self.take(4)?;
        Ok(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as usize)
    }

    /// Reserves decoded bytes against the section's limit.
    ///
    /// # Errors
    /// [`Damaged`] past the section's limit.
    pub fn allow(&mut self, bytes: usize) -> Result<(), Damaged> {
        self.allowed = self.allowed.checked_sub(bytes).ok_or(Damaged)?;
        Ok(())
    }

    /// Reads the next stream, of length `len`.
    ///
    /// # Errors
    /// [`Damaged`].
    pub fn bytes(&mut self, len: usize) -> Result<Vec<u8>, Damaged> {
        if self.number()? != len {
            return Err(Damaged);
        }
        let mut out = vec![0; len];
        for block in out.chunks_mut(BLOCK) {
            let content = self.number()?;
            let stream = self.take(content >> 1)?;
            if content & 1 != 0 {
                rans::decode(stream, block)?;
            } else if stream.len() == block.len() {
                block.copy_from_slice(stream);
            } else {
                return Err(Damaged);
            }
        }
        Ok(out)
    }

    /// Reads the next stream, at most `most` bytes.
    ///
    /// # Errors
    /// [`Damaged`] for a longer stream.
    pub fn bytes_up_to(&mut self, most: usize) -> Result<Vec<u8>, Damaged> {
        let len = self.next_len()?;
        if len <= most { self.bytes(len) } else { Err(Damaged) }
    }

    /// Returns the length of the next stream, bytes.
    fn next_len(&self) -> Result<usize, Damaged> {
        let len = self.rest.get(..4).ok_or(Damaged)?;
        Ok(u32::from_le_bytes([len[0], len[1], len[2], len[3]]) as usize)
    }

    /// Reads the next stream of any length; reserves its bytes.
    ///
    /// # Errors
    /// [`Damaged`].
    pub fn any_bytes(&mut self) -> Result<Vec<u8>, Damaged> {
        let len = self.next_len()?;
        self.allow(len)?;
        self.bytes(len)
    }

    /// # Errors
    /// [`Damaged`] if unread bytes are not zero.
    pub fn finish(self) -> Result<(), Damaged> {
        if self.rest.iter().all(|byte| *byte == 0) { Ok(()) } else { Err(Damaged) }
    }
}
