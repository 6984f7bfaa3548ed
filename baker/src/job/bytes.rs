//! Numbers as little-endian bytes, for partial results and for messages between processes.

use bytemuck::{Pod, Zeroable};

/// Appends the bytes of `values`.
pub fn put<T: Pod>(out: &mut Vec<u8>, values: &[T]) {
    out.extend_from_slice(bytemuck::cast_slice(values));
}

/// Returns the lengths of rows.
pub fn lengths<'a, T: 'a>(rows: impl Iterator<Item = &'a Vec<T>>) -> Vec<u32> {
    rows.map(|row| row.len() as u32).collect()
}

/// Reader of serialized bytes; a read past the end returns `None`.
pub struct Reader<'a>(pub &'a [u8]);

impl<'a> Reader<'a> {
    /// Whether all bytes are read.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Reads `count` numbers.
    pub fn take<T: Pod + Zeroable>(&mut self, count: usize) -> Option<Vec<T>> {
        Some(bytemuck::pod_collect_to_vec(self.slice(count.checked_mul(size_of::<T>())?)?))
    }

    /// Reads `count` bytes.
    pub fn slice(&mut self, count: usize) -> Option<&'a [u8]> {
        let (bytes, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(bytes)
    }

    /// Reads a single number.
    pub fn one<T: Pod + Zeroable>(&mut self) -> Option<T> {
        self.take(1)?.pop()
    }

    /// Reads rows of these lengths.
    pub fn rows<T: Pod + Zeroable>(&mut self, lengths: &[u32]) -> Option<Vec<Vec<T>>> {
        lengths.iter().map(|length| self.take(*length as usize)).collect()
    }

    /// Number of whole values of type `T` in the unread bytes.
    pub fn rest<T>(&self) -> usize {
        self.0.len() / size_of::<T>()
    }
}
