//! Children of every function, with the shares of each child that stand under it: the push rows, transposed.

use crate::basis::Relations;

/// Children of all functions. Of a child's parents, the shares sum to 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Children {
    offsets: Vec<u32>,
    /// Child and share, children ascending within a row.
    entries: Vec<(u32, f32)>,
}

impl Children {
    /// Transposes the push rows of `count` points.
    pub fn new(relations: &Relations, count: usize) -> Self {
        let push = relations.push();
        let mut next = vec![0u32; count + 1];
        for entry in (0..count).flat_map(|child| push.row(child)) {
            next[entry.point() + 1] += 1;
        }
        for k in 0..count {
            next[k + 1] += next[k];
        }
        let offsets = next.clone();
        let mut entries = vec![(0, 0.0); offsets[count] as usize];
        for child in 0..count {
            let row = push.row(child);
            let total: f32 = row.iter().map(|entry| entry.weight()).sum();
            for entry in row {
                let place = &mut next[entry.point()];
                entries[*place as usize] = (child as u32, entry.weight() / total);
                *place += 1;
            }
        }
        Self { offsets, entries }
    }

    /// Children of a function: index, and the share of the child that stands under this parent.
    #[inline]
    pub fn of(&self, parent: usize) -> &[(u32, f32)] {
        &self.entries[self.offsets[parent] as usize..self.offsets[parent + 1] as usize]
    }
}
