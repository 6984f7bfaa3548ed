//! Slices of messages longer than the maximum message size.

/// Returns the offsets of consecutive parts with these lengths; lengths and offsets are MPI counts, 31 bits.
pub fn places(lengths: &[i32]) -> Vec<i32> {
    let mut end = 0;
    let place = |length: &i32| {
        end += length;
        end - length
    };
    lengths.iter().map(place).collect()
}

/// Returns the byte range of a message of `length` bytes to send in round `round`, up to `most` bytes long.
pub fn slice(length: usize, round: usize, most: usize) -> std::ops::Range<usize> {
    length.min(round * most)..length.min((round + 1) * most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_cover_a_message_once() {
        for length in [0usize, 1, 9, 10, 11, 35] {
            let slices: Vec<usize> =
                (0..length.div_ceil(10)).flat_map(|round| slice(length, round, 10)).collect();
            assert!(slices.into_iter().eq(0..length));
            assert!(slice(length, 9, 10).is_empty());
        }
        assert_eq!(places(&[3, 0, 2]), [0, 3, 3]);
    }
}
