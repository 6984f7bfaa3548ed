//! A sparse matrix of transport links: sections of rows and of links.

use super::RbnError;
use super::bulk::Row;
use crate::link::{self, Link, columns};

/// Links by receiver.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkMatrix {
    /// Receivers that have links, ascending, and a sentinel.
    pub rows: Vec<Row>,
    /// The links, row after row.
    pub links: Vec<Link>,
}

impl Default for LinkMatrix {
    /// No links.
    fn default() -> Self {
        Self::new(std::iter::empty::<(u32, &[Link])>())
    }
}

impl LinkMatrix {
    /// From receivers, ascending, with their rows; empty rows are left out.
    pub fn new<'a>(rows: impl IntoIterator<Item = (u32, &'a [Link])>) -> Self {
        let mut matrix = Self { rows: Vec::new(), links: Vec::new() };
        for (receiver, row) in rows.into_iter().filter(|(_, row)| !row.is_empty()) {
            matrix.rows.push(Row { receiver, first_link: matrix.links.len() as u32 });
            matrix.links.extend_from_slice(row);
        }
        matrix.rows.push(Row { receiver: u32::MAX, first_link: matrix.links.len() as u32 });
        matrix
    }

    /// From all receivers' rows, the first one's first.
    pub fn from_rows(rows: &[Vec<Link>]) -> Self {
        Self::new((0..).zip(rows.iter().map(Vec::as_slice)))
    }

    /// Receivers and their links, packed, in ascending order of the receiver.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &[Link])> + '_ {
        self.rows.windows(2).map(|w| {
            (w[0].receiver as usize, &self.links[w[0].first_link as usize..w[1].first_link as usize])
        })
    }

    /// Number of links, page marks not counted.
    pub fn link_count(&self) -> usize {
        link::count(&self.links)
    }

    /// Checks that rows and columns are in order, and within this many receivers and senders.
    /// The sections are named in errors.
    pub(super) fn check(
        &self,
        [rows_name, links_name]: [&str; 2],
        receivers: usize,
        senders: usize,
    ) -> Result<(), RbnError> {
        let Some((sentinel, rows)) = self.rows.split_last() else {
            return Err(RbnError::invalid(rows_name, "the sentinel is missing"));
        };
        let ascending =
            self.rows.windows(2).all(|w| w[0].receiver < w[1].receiver && w[0].first_link <= w[1].first_link);
        if sentinel.receiver != u32::MAX
            || sentinel.first_link as usize != self.links.len()
            || !ascending
            || self.rows[0].first_link != 0
            || rows.iter().any(|r| r.receiver as usize >= receivers)
        {
            return Err(RbnError::invalid(rows_name, "receivers or links are out of order"));
        }
        for (_, row) in self.iter() {
            let mut last = None;
            for (column, _) in columns(row) {
                if column >= senders || last.is_some_and(|l| l >= column) {
                    return Err(RbnError::invalid(links_name, "a sender is out of range or order"));
                }
                last = Some(column);
            }
        }
        Ok(())
    }
}
