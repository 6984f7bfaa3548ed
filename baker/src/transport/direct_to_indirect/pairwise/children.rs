//! Children of every function, with the shares of each child that stand under it: rows of parents, transposed.
//!
//! A receiver's parents are those of the push (Eq. 7). A sender's are the functions that cover its places on the finest
//! coarser level, each with its mean weight there: senders are narrower than receivers, and Σ_j share_jJ B_j is close to B_J
//! only for shares of their own width.

use crate::basis::Relations;

/// Children of all functions. Of a child's parents, the shares sum to 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Children {
    offsets: Vec<u32>,
    /// Child and share, children ascending within a row.
    entries: Vec<(u32, f32)>,
}

impl Children {
    /// Children of `count` receivers: the push rows, transposed.
    pub fn of_receivers(relations: &Relations, count: usize) -> Self {
        let push = relations.push();
        let parents = |child: usize| {
            let row = push.row(child);
            let total: f32 = row.iter().map(|entry| entry.weight()).sum();
            row.iter().map(move |entry| (entry.point() as u32, entry.weight() / total))
        };
        Self::transposed(count, parents)
    }

    /// Transposes rows of parents and shares, one for each of `count` functions.
    pub fn transposed<R: Iterator<Item = (u32, f32)>>(count: usize, parents: impl Fn(usize) -> R) -> Self {
        let mut next = vec![0u32; count + 1];
        for (parent, _) in (0..count).flat_map(&parents) {
            next[parent as usize + 1] += 1;
        }
        for k in 0..count {
            next[k + 1] += next[k];
        }
        let offsets = next.clone();
        let mut entries = vec![(0, 0.0); offsets[count] as usize];
        for child in 0..count {
            for (parent, share) in parents(child) {
                let place = &mut next[parent as usize];
                entries[*place as usize] = (child as u32, share);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_under_all_parents_are_the_rows_turned_over() {
        let rows: [&[(u32, f32)]; 5] =
            [&[], &[], &[(0, 0.25), (1, 0.75)], &[(1, 1.0)], &[(0, 0.5), (2, 0.5)]];
        let children = Children::transposed(5, |child| rows[child].iter().copied());
        assert_eq!(children.of(0), [(2, 0.25), (4, 0.5)]);
        assert_eq!(children.of(1), [(2, 0.75), (3, 1.0)]);
        assert_eq!(children.of(2), [(4, 0.5)]);
        assert!(children.of(3).is_empty() && children.of(4).is_empty());
    }
}
