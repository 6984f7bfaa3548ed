//! Sparse accumulator: sums of a receiver's row by sender during shading. Also the row format of
//! coarse irradiance.

use crate::processor;
use crate::random::{mix, unit};
use crate::transport::operator::IrradianceRow;

/// `N` sums per sender, mostly zero, such as gathered and predicted irradiance. The sums of a
/// sender are adjacent in memory.
pub struct SparseAccumulator<const N: usize> {
    sums: Vec<[f32; N]>,
    /// One bit per sender, set by additions, for visits in ascending order.
    touched: Vec<u64>,
    /// One bit per word of `touched`; few words are non-zero.
    words: Vec<u64>,
}

/// Calls `visit` with the index of each set bit, ascending.
#[inline]
fn bits(mut word: u64, mut visit: impl FnMut(usize)) {
    while word != 0 {
        visit(word.trailing_zeros() as usize);
        word &= word - 1;
    }
}

impl<const N: usize> SparseAccumulator<N> {
    /// Allocates sums for `senders` senders.
    pub fn new(senders: usize) -> Self {
        let words = senders.div_ceil(64);
        Self { sums: vec![[0.0; N]; senders], touched: vec![0; words], words: vec![0; words.div_ceil(64)] }
    }

    /// Prefetches the sums of a sender.
    #[inline]
    pub fn fetch(&self, sender: usize) {
        processor::fetch(&self.sums, sender);
    }

    /// Adds to sum `which` of a sender.
    #[inline]
    pub fn add(&mut self, which: usize, sender: usize, amount: f32) {
        self.sums[sender][which] += amount;
        self.touched[sender / 64] |= 1 << (sender % 64);
        self.words[sender / 4096] |= 1 << (sender / 64 % 64);
    }

    /// Adds to all sums of a sender.
    #[inline]
    pub fn add_each(&mut self, sender: usize, amounts: [f32; N]) {
        for (sum, amount) in self.sums[sender].iter_mut().zip(amounts) {
            *sum += amount;
        }
        self.touched[sender / 64] |= 1 << (sender % 64);
        self.words[sender / 4096] |= 1 << (sender / 64 % 64);
    }

    /// Visits the senders with additions, ascending.
    #[inline]
    pub fn each(&self, mut visit: impl FnMut(u32, [f32; N])) {
        for (i, words) in self.words.iter().enumerate() {
            bits(*words, |j| {
                let word = 64 * i + j;
                bits(self.touched[word], |bit| {
                    let sender = 64 * word + bit;
                    visit(sender as u32, self.sums[sender]);
                });
            });
        }
    }

    /// Resets all sums to zero.
    pub fn clear(&mut self) {
        for (i, words) in self.words.iter_mut().enumerate() {
            bits(std::mem::take(words), |j| {
                let word = 64 * i + j;
                bits(std::mem::take(&mut self.touched[word]), |bit| self.sums[64 * word + bit] = [0.0; N]);
            });
        }
    }
}

impl SparseAccumulator<1> {
    /// Returns the irradiance by sender. An amount up to `least` is carried over to the next
    /// sender; the entry of a carried sum is assigned by chance to a contributing sender
    /// ([`reservoir_takes`]), seeded by `name`.
    pub fn row(&self, least: f32, name: u64) -> IrradianceRow {
        let (mut carried, mut speaks) = (0.0, 0);
        let mut row: IrradianceRow = Vec::new();
        self.each(|sender, [sum]| {
            carried += sum;
            if reservoir_takes(mix(name) ^ sender as u64, sum, carried) {
                speaks = sender;
            }
            if carried > least {
                row.push((speaks, std::mem::take(&mut carried)));
            }
        });
        if carried != 0.0 {
            row.push((speaks, carried));
        }
        row
    }
}

/// Whether the last sender, with `amount` of the carried `sum`, becomes the sender of the sum. The
/// probability is the sender's share of the sum, so that on average a sender represents exactly its
/// own light. Always choosing the last sender would move light along the curve: light of a lit room
/// would come from a dark room that follows on the curve.
pub fn reservoir_takes(name: u64, amount: f32, sum: f32) -> bool {
    unit(mix(name)) * sum < amount
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tally_sums_by_sender_in_order_and_forgets() {
        let (mut two, mut one) = (SparseAccumulator::<2>::new(10_000), SparseAccumulator::<1>::new(10_000));
        for round in 0..3 {
            let amount = 1.0 + round as f32;
            for sender in [9_999, 3, 4_096, 63, 3, 64] {
                two.add(0, sender, amount);
                one.add(0, sender, amount);
            }
            two.add(1, 5_000, 1.0);
            two.add(1, 63, 2.0);
            let mut found = Vec::new();
            two.each(|sender, sums| found.push((sender, sums)));
            let a = amount;
            let expected = [
                (3, [2.0 * a, 0.0]),
                (63, [a, 2.0]),
                (64, [a, 0.0]),
                (4_096, [a, 0.0]),
                (5_000, [0.0, 1.0]),
                (9_999, [a, 0.0]),
            ];
            assert_eq!(found, expected);
            let row = one.row(1e9, round);
            assert!(
                row.len() == 1 && row[0].1 == 6.0 * a && expected.iter().any(|e| e.0 == row[0].0),
                "{row:?}"
            );
            two.clear();
            one.clear();
            two.each(|sender, _| panic!("{sender} is left"));
            one.each(|sender, _| panic!("{sender} is left"));
        }
    }

    #[test]
    fn rows_keep_their_sum_and_on_the_whole_each_sender_speaks_for_what_it_gives() {
        // Strong senders after many weak senders, as where the curve leads from far away to near.
        let gives = |sender: u32| if sender % 10 == 9 { 0.5 } else { 0.1 };
        let (count, rows) = (100u32, 4_000);
        let mut tally = SparseAccumulator::<1>::new(count as usize);
        (0..count).for_each(|sender| tally.add(0, sender as usize, gives(sender)));
        let mut spoken = vec![0.0; count as usize];
        for name in 0..rows {
            let row = tally.row(1.0, name);
            assert!(row.len() < 20 && row.windows(2).all(|pair| pair[0].0 < pair[1].0));
            assert!((row.iter().map(|entry| entry.1).sum::<f32>() - 14.0).abs() < 1e-3);
            row.iter().for_each(|(sender, amount)| spoken[*sender as usize] += amount / rows as f32);
        }
        for (sender, spoken) in (0..count).zip(spoken) {
            // Four standard deviations of a mean over `rows` rows.
            let wanted = gives(sender);
            let noise = 4.0 * (1.4 * wanted / rows as f32).sqrt();
            assert!((spoken - wanted).abs() < noise, "{sender}: {spoken}, not {wanted}");
        }
    }
}
