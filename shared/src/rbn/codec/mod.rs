//! How bulk sections are packed in a file. No record changes: what was written is read back bit by bit.
//!
//! * [`rans`] – entropy coding of bytes;
//! * [`bits`] – numbers as classes and bits;
//! * [`links`] – rows of ascending indices with something beside each: links;
//! * [`columns`] – any other records, field by field.
//!
//! A packed section never holds more than [`MOST_TIMES`] times its own size: a reader knows what it must allocate
//! from the bytes that are there.

mod bits;
pub mod columns;
pub mod links;
mod rans;

/// A section's contents over its packed size, at most.
pub const MOST_TIMES: usize = 64;

/// Bytes of a stream that share a table.
const BLOCK: usize = 1 << 15;

/// A section's contents at most, bytes.
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

    /// Appends bytes, entropy coded where that makes them fewer, in blocks: what is common changes along a section,
    /// with the levels that its rows are of.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.number(bytes.len());
        for block in bytes.chunks(BLOCK) {
            let mut packed = Vec::new();
            // Of fewer bytes nothing shorter can be made.
            if block.len() > rans::LEAST {
                rans::encode(block, &mut packed);
            }
            let is_shorter = !packed.is_empty() && packed.len() < block.len();
            let (is_packed, content) = if is_shorter { (1, &packed[..]) } else { (0, block) };
            self.number(content.len() << 1 | is_packed);
            self.out.extend_from_slice(content);
        }
    }

    /// Appends what the shorter of two has written, the second of equal ones.
    pub fn append_shorter(&mut self, one: Writer, other: Writer) {
        self.out.extend_from_slice(if one.out.len() < other.out.len() { &one.out } else { &other.out });
    }

    /// The section, for contents of so many bytes.
    pub fn finish(mut self, contents: usize) -> Vec<u8> {
        // Filled up with zeros where it holds too much for its size.
        let least = contents.div_ceil(MOST_TIMES);
        if self.out.len() < least {
            self.out.resize(least, 0);
        }
        self.out
    }
}

/// Reads what [`Writer`] packed.
pub struct Reader<'a> {
    rest: &'a [u8],
    /// Bytes that may still be made.
    allowed: usize,
}

impl<'a> Reader<'a> {
    /// From a section's bytes.
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

    /// Says that so many bytes will be made.
    ///
    /// # Errors
    /// [`Damaged`] if that is more than the section can hold.
    pub fn allow(&mut self, bytes: usize) -> Result<(), Damaged> {
        self.allowed = self.allowed.checked_sub(bytes).ok_or(Damaged)?;
        Ok(())
    }

    /// The next bytes; there must be so many.
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

    /// The next bytes, at most so many.
    ///
    /// # Errors
    /// [`Damaged`] if there are more.
    pub fn bytes_up_to(&mut self, most: usize) -> Result<Vec<u8>, Damaged> {
        let len = self.next_len()?;
        if len <= most { self.bytes(len) } else { Err(Damaged) }
    }

    /// How many bytes come next.
    fn next_len(&self) -> Result<usize, Damaged> {
        let len = self.rest.get(..4).ok_or(Damaged)?;
        Ok(u32::from_le_bytes([len[0], len[1], len[2], len[3]]) as usize)
    }

    /// The next bytes, however many; they count as made.
    ///
    /// # Errors
    /// [`Damaged`].
    pub fn any_bytes(&mut self) -> Result<Vec<u8>, Damaged> {
        let len = self.next_len()?;
        self.allow(len)?;
        self.bytes(len)
    }

    /// # Errors
    /// [`Damaged`] unless all is read but zeros.
    pub fn finish(self) -> Result<(), Damaged> {
        if self.rest.iter().all(|byte| *byte == 0) { Ok(()) } else { Err(Damaged) }
    }
}
