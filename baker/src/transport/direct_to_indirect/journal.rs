//! Partial results: storage of finished chunks of the operator, for resuming an interrupted bake.

use super::gather::Gathered;
use glam::Vec3;

/// Rows of later bounces for a set of coarse senders.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Columns {
    /// Number of bounces in the rows.
    pub bounces: u32,
    /// Irradiance of each coarse receiver by sender and channel, senders ascending.
    pub rows: Vec<Vec<(u32, Vec3)>>,
}

impl Columns {
    /// Whether data of unknown origin is valid: rows for `count` points, from these senders
    /// (ascending), with finite irradiance.
    pub fn fits(&self, senders: &[u32], count: usize) -> bool {
        let row = |row: &Vec<(u32, Vec3)>| {
            row.windows(2).all(|pair| pair[0].0 < pair[1].0)
                && row.iter().all(|entry| entry.1.is_finite() && senders.binary_search(&entry.0).is_ok())
        };
        self.rows.len() == count && self.rows.iter().all(row)
    }
}

/// Storage for finished parts of the operator, including parts of an earlier run. Loaded parts are
/// bit-identical to the stored parts.
pub trait PartialResults: Sync {
    /// Loads the results of `count` receivers from `first` on; `None` if not stored.
    fn receivers(&self, first: usize, count: usize) -> Option<Vec<Gathered>>;

    /// Stores the results of receivers from `first` on.
    fn keep_receivers(&self, first: usize, found: &[Gathered]);

    /// Loads a part of the later bounces; `None` if not stored. Parts are numbered from 0.
    fn columns(&self, part: usize) -> Option<Columns>;

    /// Stores a part of the later bounces.
    fn keep_columns(&self, part: usize, columns: &Columns);
}

/// Stores nothing.
impl PartialResults for () {
    fn receivers(&self, _first: usize, _count: usize) -> Option<Vec<Gathered>> {
        None
    }

    fn keep_receivers(&self, _first: usize, _found: &[Gathered]) {}

    fn columns(&self, _part: usize) -> Option<Columns> {
        None
    }

    fn keep_columns(&self, _part: usize, _columns: &Columns) {}
}
