//! What a receiver gets, summed by sender while its rays come in.

/// A receiver's irradiance from senders, ascending.
pub type IrradianceRow = Vec<(u32, f32)>;

/// Irradiance along the receiver's normal by sender; few are not zero.
pub struct Tally {
    sums: Vec<f32>,
    /// One bit a sender, so that those touched come in order.
    touched: Vec<u64>,
    /// One bit a word of `touched`: most are empty.
    words: Vec<u64>,
}

/// Calls `visit` with the number of each bit that is set, ascending.
#[inline]
fn bits(mut word: u64, mut visit: impl FnMut(usize)) {
    while word != 0 {
        visit(word.trailing_zeros() as usize);
        word &= word - 1;
    }
}

impl Tally {
    /// For this many senders.
    pub fn new(senders: usize) -> Self {
        let words = senders.div_ceil(64);
        Self { sums: vec![0.0; senders], touched: vec![0; words], words: vec![0; words.div_ceil(64)] }
    }

    /// What a sender gave so far.
    #[inline]
    pub fn get(&self, sender: u32) -> f32 {
        self.sums[sender as usize]
    }

    /// Adds to one sender.
    #[inline]
    pub fn add(&mut self, sender: usize, amount: f32) {
        self.sums[sender] += amount;
        self.touched[sender / 64] |= 1 << (sender % 64);
        self.words[sender / 4096] |= 1 << (sender / 64 % 64);
    }

    /// Visits the senders touched here or there, ascending. `other` is for as many senders.
    #[inline]
    pub fn touched_with(&self, other: Option<&Self>, mut visit: impl FnMut(u32)) {
        for (i, words) in self.words.iter().enumerate() {
            bits(words | other.map_or(0, |other| other.words[i]), |j| {
                let word = 64 * i + j;
                bits(self.touched[word] | other.map_or(0, |other| other.touched[word]), |bit| {
                    visit((64 * word + bit) as u32);
                });
            });
        }
    }

    /// Back to nothing.
    pub fn clear(&mut self) {
        for (i, words) in self.words.iter_mut().enumerate() {
            bits(std::mem::take(words), |j| {
                let word = 64 * i + j;
                bits(std::mem::take(&mut self.touched[word]), |bit| self.sums[64 * word + bit] = 0.0);
            });
        }
    }

    /// The irradiance from each sender. What is not over `least` is carried over to the next sender, as in
    /// [`super::choose`].
    pub fn row(&self, least: f32) -> IrradianceRow {
        let (mut carried, mut first) = (0.0, None);
        let mut row: IrradianceRow = Vec::new();
        self.touched_with(None, |sender| {
            first = first.or(Some(sender));
            carried += self.sums[sender as usize];
            if carried > least {
                row.push((sender, std::mem::take(&mut carried)));
            }
        });
        match (row.last_mut(), first) {
            (Some((_, last)), _) => *last += carried,
            (None, Some(sender)) => row.push((sender, carried)),
            (None, None) => {}
        }
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tally_sums_by_sender_in_order_and_forgets() {
        let (mut here, mut there) = (Tally::new(10_000), Tally::new(10_000));
        for round in 0..3 {
            for sender in [9_999, 3, 4_096, 63, 3, 64] {
                here.add(sender, 1.0 + round as f32);
            }
            there.add(5_000, 1.0);
            let mut found = Vec::new();
            here.touched_with(Some(&there), |sender| found.push((sender, here.get(sender))));
            let one = 1.0 + round as f32;
            let expected = [(3, 2.0 * one), (63, one), (64, one), (4_096, one), (5_000, 0.0), (9_999, one)];
            assert_eq!(found, expected);
            assert_eq!(here.row(1e9), [(3, 6.0 * one)]);
            here.clear();
            there.clear();
            here.touched_with(Some(&there), |sender| panic!("{sender} is left"));
        }
    }
}
