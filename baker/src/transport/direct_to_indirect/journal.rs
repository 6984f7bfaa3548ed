//! Partial results: where finished chunks of the operator are kept, so that a bake that was ended can be resumed.

use super::gather::Gathered;
use glam::Vec3;

/// Rows of later bounces for some coarse senders.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Columns {
    /// Bounces that they hold.
    pub bounces: u32,
    /// For each coarse receiver what it gets, by sender and channel, senders ascending.
    pub rows: Vec<Vec<(u32, Vec3)>>,
}

impl Columns {
    /// Whether they can be what these senders, which ascend, send to so many points, whoever says it.
    pub fn fits(&self, senders: &[u32], count: usize) -> bool {
        let row = |row: &Vec<(u32, Vec3)>| {
            row.windows(2).all(|pair| pair[0].0 < pair[1].0)
                && row.iter().all(|entry| entry.1.is_finite() && senders.binary_search(&entry.0).is_ok())
        };
        self.rows.len() == count && self.rows.iter().all(row)
    }
}

/// Keeps parts of the operator as they are done, and has those of an earlier run. What it gives back is, to the bit,
/// what it was given.
pub trait PartialResults: Sync {
    /// What was found for `count` receivers from `first` on, if it is known.
    fn receivers(&self, first: usize, count: usize) -> Option<Vec<Gathered>>;

    /// Keeps what was found for receivers from `first` on.
    fn keep_receivers(&self, first: usize, found: &[Gathered]);

    /// One part of the later bounces, if it is known; parts are counted from 0.
    fn columns(&self, part: usize) -> Option<Columns>;

    /// Keeps one part of the later bounces.
    fn keep_columns(&self, part: usize, columns: &Columns);
}

/// Nothing is kept.
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
