//! Work that reflections do: samples of lobes, and steps along their rays.

use std::sync::atomic::{AtomicU64, Ordering};

/// Work of one lobe.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LobeCost {
    /// Samples of the lobe.
    pub samples: u64,
    /// Texels and pixels read on the way of their rays.
    pub steps: u64,
    /// Samples whose way did not find a sure answer.
    pub fallbacks: u64,
}

/// Work of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Lobes: hits on metals.
    pub lobes: u64,
    /// Samples of the lobes.
    pub samples: u64,
    /// Texels and pixels read on the way of their rays.
    pub steps: u64,
    /// Samples whose way did not find a sure answer.
    pub fallbacks: u64,
}

/// Sums over a picture, from any thread.
#[derive(Debug, Default)]
pub(super) struct CostSums {
    lobes: AtomicU64,
    samples: AtomicU64,
    steps: AtomicU64,
    fallbacks: AtomicU64,
}

impl CostSums {
    /// Adds the work of a lobe.
    pub fn add(&self, lobe: &LobeCost) {
        let of = [
            (&self.lobes, 1),
            (&self.samples, lobe.samples),
            (&self.steps, lobe.steps),
            (&self.fallbacks, lobe.fallbacks),
        ];
        for (sum, n) in of {
            sum.fetch_add(n, Ordering::Relaxed);
        }
    }

    /// The sums.
    pub fn cost(&self) -> Cost {
        let [lobes, samples, steps, fallbacks] =
            [&self.lobes, &self.samples, &self.steps, &self.fallbacks].map(|sum| sum.load(Ordering::Relaxed));
        Cost { lobes, samples, steps, fallbacks }
    }
}
