//! A sparse matrix of transport links: sections of offsets and of links.

use super::RbnError;
use crate::link::Sent;

/// Links by receiver: row `i` is `links[offsets[i]..offsets[i + 1]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkMatrix<L> {
    /// Where each row begins, and one past the end.
    pub offsets: Vec<u32>,
    /// The links, row after row.
    pub links: Vec<L>,
}

impl<L> Default for LinkMatrix<L> {
    /// No rows.
    fn default() -> Self {
        Self { offsets: vec![0], links: Vec::new() }
    }
}

impl<L: Sent> LinkMatrix<L> {
    /// From all receivers' rows, the first one's first.
    pub fn from_rows(rows: &[Vec<L>]) -> Self {
        let mut matrix = Self::default();
        for row in rows {
            matrix.links.extend_from_slice(row);
            matrix.offsets.push(matrix.links.len() as u32);
        }
        matrix
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// True when there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The links of row `i`.
    #[inline]
    pub fn row(&self, i: usize) -> &[L] {
        &self.links[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }

    /// All rows, in order.
    pub fn iter(&self) -> impl Iterator<Item = &[L]> + '_ {
        self.offsets.windows(2).map(|w| &self.links[w[0] as usize..w[1] as usize])
    }

    /// Checks that there are so many rows, in order, and that their senders ascend and are within this many.
    /// The section is named in errors.
    pub(super) fn check(&self, section: &str, rows: usize, senders: usize) -> Result<(), RbnError> {
        let whole = self.len() == rows
            && self.offsets.first() == Some(&0)
            && self.offsets.windows(2).all(|w| w[0] <= w[1])
            && self.offsets.last().map(|&end| end as usize) == Some(self.links.len());
        if !whole {
            return Err(RbnError::invalid(section, "rows do not follow each other"));
        }
        let ascending = |row: &[L]| row.windows(2).all(|w| w[0].sender() < w[1].sender());
        let within = |row: &[L]| row.last().is_none_or(|last| last.sender() < senders);
        if self.iter().any(|row| !ascending(row) || !within(row)) {
            return Err(RbnError::invalid(section, "a sender is out of range or order"));
        }
        Ok(())
    }
}
