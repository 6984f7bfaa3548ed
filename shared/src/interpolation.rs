//! Packed entry of an interpolation row: point and weight. 4 bytes.
//!
//! ```text
//! bits  0..21  index of the point, over all levels
//! bits 22..31  weight, unorm relative to the row: the row's weights are divided by their sum
//! ```

use bytemuck::{Pod, Zeroable};

/// Largest number of points a file can hold.
pub const MAX_POINTS: usize = 1 << 22;
/// Largest weight.
pub const MAX_WEIGHT: u32 = 1023;

/// Entry; see the module's head for the bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Entry(pub u32);

impl Entry {
    /// Index of the point, over all levels.
    #[inline]
    pub fn point(self) -> usize {
        (self.0 & (MAX_POINTS as u32 - 1)) as usize
    }

    /// Weight, 0 to 1023, relative to the other weights of its row.
    #[inline]
    pub fn weight(self) -> f32 {
        (self.0 >> 22) as f32
    }
}

/// Packs a row of (point, weight); weights are not negative. Entries with a share that rounds to zero are dropped; a
/// row with a positive weight is never empty.
pub fn pack_row(row: &[(u32, f32)], out: &mut Vec<Entry>) {
    let largest = row.iter().fold(0f32, |m, e| m.max(e.1));
    if largest <= 0.0 {
        return;
    }
    for &(point, weight) in row {
        debug_assert!((point as usize) < MAX_POINTS);
        let weight = (weight / largest * MAX_WEIGHT as f32).round() as u32;
        if weight > 0 {
            out.push(Entry(point | weight << 22));
        }
    }
}

/// A sparse matrix of interpolation rows, borrowed from a file's section.
/// Row `i` is `entries[offsets[i]..offsets[i + 1]]`.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a> {
    /// One offset per row and one past the end.
    pub offsets: &'a [u32],
    /// Entries of all rows.
    pub entries: &'a [Entry],
}

impl<'a> Rows<'a> {
    /// The entries of row `i`.
    #[inline]
    pub fn row(&self, i: usize) -> &'a [Entry] {
        &self.entries[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// True when there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The weighted mean of `value` over a row; `None` for an empty row.
#[inline]
pub fn mean<T>(row: &[Entry], zero: T, value: impl Fn(usize) -> T) -> Option<T>
where
    T: std::ops::Add<Output = T> + std::ops::Mul<f32, Output = T>,
{
    let total: f32 = row.iter().map(|e| e.weight()).sum();
    if total <= 0.0 {
        return None;
    }
    let sum = row.iter().fold(zero, |sum, e| sum + value(e.point()) * e.weight());
    Some(sum * (1.0 / total))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_a_partition_of_unity_after_packing() {
        let mut out = Vec::new();
        pack_row(&[(1, 0.5), (4_000_000, 0.25), (3, 1e-7)], &mut out);
        assert_eq!(out.len(), 2);
        assert_eq!(out[1].point(), 4_000_000);
        assert_eq!(mean(&out, 0.0, |_| 1.0), Some(1.0));
        let value = mean(&out, 0.0, |p| if p == 1 { 3.0 } else { 0.0 }).unwrap_or_default();
        // A weight is off by half of one in 1023.
        assert!((value - 2.0).abs() < 8e-4, "{value}");
        assert_eq!(mean(&[], 0.0f32, |_| 1.0), None);
    }
}
