//! Serialization of finished parts of the operator: for checkpoints, and for messages between the
//! processes of a communicator. All numbers are little-endian.

use super::gather::Gathered;
use super::gather_context::GatherCost;
use super::journal::Columns;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use rebounce_shared::link::Link;

/// Appends the bytes of `values`.
pub fn put<T: Pod>(out: &mut Vec<u8>, values: &[T]) {
    out.extend_from_slice(bytemuck::cast_slice(values));
}

/// Returns the lengths of rows.
pub fn lengths<'a, T: 'a>(rows: impl Iterator<Item = &'a Vec<T>>) -> Vec<u32> {
    rows.map(|row| row.len() as u32).collect()
}

/// Appends the gathered results of receivers from `first` on.
pub fn put_receivers(out: &mut Vec<u8>, first: usize, found: &[Gathered]) {
    put(out, &[first as u64, found.len() as u64]);
    put(out, &found.iter().map(|g| g.cost.rays).collect::<Vec<u64>>());
    put(out, &found.iter().map(|g| [g.cost.seen, g.cost.lost]).collect::<Vec<_>>());
    put(out, &lengths(found.iter().map(|g| &g.links)));
    put(out, &lengths(found.iter().map(|g| &g.value)));
    for gathered in found {
        put(out, &gathered.links);
        put(out, &gathered.value);
    }
}

/// Appends a part of the later bounces.
pub fn put_columns(out: &mut Vec<u8>, part: usize, columns: &Columns) {
    put(out, &[part as u64, columns.rows.len() as u64]);
    put(out, &[columns.bounces]);
    put(out, &lengths(columns.rows.iter()));
    for row in &columns.rows {
        put(out, &row.iter().map(|entry| entry.0).collect::<Vec<u32>>());
        put(out, &row.iter().map(|entry| entry.1).collect::<Vec<Vec3>>());
    }
}

/// Reader of serialized bytes; a read past the end returns `None`.
pub struct Reader<'a>(pub &'a [u8]);

impl Reader<'_> {
    /// Whether all bytes are read.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Reads `count` numbers.
    pub fn take<T: Pod + Zeroable>(&mut self, count: usize) -> Option<Vec<T>> {
        let (bytes, rest) = self.0.split_at_checked(count.checked_mul(size_of::<T>())?)?;
        self.0 = rest;
        Some(bytemuck::pod_collect_to_vec(bytes))
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

    /// Reads the output of [`put_receivers`].
    pub fn receivers(&mut self) -> Option<(usize, Vec<Gathered>)> {
        let [first, count] = self.one::<[u64; 2]>()?.map(|n| n as usize);
        let rays = self.take::<u64>(count)?;
        let light = self.take::<[f64; 2]>(count)?;
        let lengths: Vec<_> = self.take::<u32>(count)?.into_iter().zip(self.take::<u32>(count)?).collect();
        let mut found = Vec::with_capacity(count);
        for ((rays, [seen, lost]), (links, value)) in rays.into_iter().zip(light).zip(lengths) {
            let links: Vec<Link> = self.take(links as usize)?;
            let value: Vec<Link> = self.take(value as usize)?;
            found.push(Gathered { links, value, cost: GatherCost { rays, seen, lost } });
        }
        Some((first, found))
    }

    /// Reads the output of [`put_columns`].
    pub fn columns(&mut self) -> Option<(usize, Columns)> {
        let [part, count] = self.one::<[u64; 2]>()?.map(|n| n as usize);
        let bounces = self.one()?;
        let mut rows = Vec::new();
        for length in self.take::<u32>(count)? {
            let senders = self.take::<u32>(length as usize)?;
            rows.push(senders.into_iter().zip(self.take::<Vec3>(length as usize)?).collect());
        }
        Some((part, Columns { bounces, rows }))
    }
}
