//! What a receiver gets, summed by sender while its rays come in.

/// A receiver's irradiance from senders, ascending.
pub type IrradianceRow = Vec<(u32, f32)>;

/// Irradiance along the receiver's normal by sender; few are not zero.
pub struct Tally {
    sums: Vec<f32>,
    /// One bit a sender, so that those touched come in order.
    is_touched: Vec<u64>,
}

impl Tally {
    /// For this many senders.
    pub fn new(senders: usize) -> Self {
        Self { sums: vec![0.0; senders], is_touched: vec![0; senders.div_ceil(64)] }
    }

    #[inline]
    fn touch(&mut self, sender: usize) {
        self.is_touched[sender / 64] |= 1 << (sender % 64);
    }

    /// What a sender gave so far.
    #[inline]
    pub fn get(&self, sender: u32) -> f32 {
        self.sums[sender as usize]
    }

    /// Adds to one sender.
    #[inline]
    pub fn add(&mut self, sender: usize, amount: f32) {
        self.touch(sender);
        self.sums[sender] += amount;
    }

    /// The senders touched, ascending.
    pub fn touched(&self) -> impl Iterator<Item = u32> + '_ {
        self.touched_with(None)
    }

    /// The senders touched here or there, ascending.
    pub fn touched_with<'a>(&'a self, other: Option<&'a Self>) -> impl Iterator<Item = u32> + 'a {
        self.is_touched.iter().enumerate().flat_map(move |(i, &word)| {
            let mut rest = word | other.map_or(0, |other| other.is_touched[i]);
            let first = 64 * i as u32;
            std::iter::from_fn(move || {
                let bit = (rest != 0).then(|| rest.trailing_zeros())?;
                rest &= rest - 1;
                Some(first + bit)
            })
        })
    }

    /// Back to nothing.
    pub fn clear(&mut self) {
        for (word, sums) in self.is_touched.iter_mut().zip(self.sums.chunks_mut(64)) {
            if std::mem::take(word) != 0 {
                sums.fill(0.0);
            }
        }
    }

    /// The irradiance from each sender. What is not over `least` is carried over to the next sender, as in
    /// [`super::choose`].
    pub fn row(&self, least: f32) -> IrradianceRow {
        let mut carried = 0.0;
        let mut row: IrradianceRow = Vec::new();
        for sender in self.touched() {
            carried += self.sums[sender as usize];
            if carried > least {
                row.push((sender, std::mem::take(&mut carried)));
            }
        }
        match (row.last_mut(), self.touched().next()) {
            (Some((_, last)), _) => *last += carried,
            (None, Some(sender)) => row.push((sender, carried)),
            (None, None) => {}
        }
        row
    }
}
