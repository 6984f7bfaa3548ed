//! A sparse matrix of transport links: sections of offsets and of links.

/// Links by receiver: row `i` is `links[offsets[i]..offsets[i + 1]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkMatrix<L> {
    /// Offset of each row, plus the end offset.
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

impl<L: Copy> LinkMatrix<L> {
    /// Creates a matrix from rows in order of receivers.
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
}
