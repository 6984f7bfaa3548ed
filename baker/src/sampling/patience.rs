//! The end of a level.

/// Shares per try.
pub(super) const SHARES: u64 = 16;
/// Number of last points for the decision about a level's end: enough to average out chance.
const LAST: usize = 16;

/// Counts tries at insertion, and tells the end of a level: when the last points took too many on average.
pub(super) struct Patience {
    /// Tries, in shares: a try at a place without need for points of this level counts less.
    pub tried: u64,
    /// Number of tries at the insertion of each of the last few points.
    lately: [u64; LAST],
    /// Limit of the shares between the last [`LAST`] insertions.
    most: u64,
}

impl Patience {
    /// Of a level that ends at so many candidates per point.
    pub fn new(patience: u64) -> Self {
        Self { tried: 0, lately: [0; LAST], most: SHARES * patience * LAST as u64 }
    }

    /// Notes that the point of this index was inserted.
    pub fn inserted(&mut self, index: usize) {
        self.lately[index % LAST] = self.tried;
    }

    /// Whether a board with so many points is full.
    pub fn is_over(&self, count: usize) -> bool {
        let oldest = count % LAST;
        // With few points, the latest point.
        let since = if count < LAST { (oldest + LAST - 1) % LAST } else { oldest };
        count > 0 && self.tried - self.lately[since] >= self.most
    }
}
