//! Deduplication of many items: parallel, and without a hash table far larger than a cache.

use crate::random::mix;
use rayon::prelude::*;

/// Returns, for each of `count` items, the index of the first item with identical bits.
pub fn canonical_indices<const N: usize>(count: usize, bits: impl Fn(u32) -> [u32; N] + Sync) -> Vec<u32> {
    // Upper 32 bits: hash; lower 32 bits: index. Eight bytes sort faster than sixteen.
    let key = |i: u32| {
        let key = bits(i).into_iter().fold(N as u64, |key, bits| mix(key ^ u64::from(bits)));
        key & !u64::from(u32::MAX) | u64::from(i)
    };
    let mut order: Vec<u64> = (0..count as u32).into_par_iter().map(key).collect();
    order.par_sort_unstable();
    let mut canonical_indices = vec![0; count];
    let mut firsts: Vec<u32> = Vec::new();
    for alike in order.chunk_by(|a, b| a >> 32 == b >> 32) {
        // The first items of different bits: one but for hash collisions, which are rare.
        firsts.clear();
        for i in alike.iter().map(|key| *key as u32) {
            let same = firsts.iter().copied().find(|first| bits(*first) == bits(i));
            canonical_indices[i as usize] = same.unwrap_or(i);
            if same.is_none() {
                firsts.push(i);
            }
        }
    }
    canonical_indices
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_told_the_first_one_like_it() {
        let things = [[1, 2], [2, 1], [1, 2], [0, 0], [2, 1], [1, 2], [7, 7]];
        assert_eq!(canonical_indices(things.len(), |i| things[i as usize]), [0, 1, 0, 3, 1, 0, 6]);
        assert!(canonical_indices(0, |_| [0]).is_empty());
        let count = 50_000;
        let told = canonical_indices(count, |i| [i % 777, 5]);
        assert!(told.iter().enumerate().all(|(i, first)| *first == i as u32 % 777));
    }
}
