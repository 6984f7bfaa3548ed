//! Work that reflections do: samples of lobes, and steps along their rays.

use std::sync::atomic::{AtomicU64, Ordering};

/// Work of one lobe, or of all lobes of a picture.
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
    pub fn add(&self, Cost { lobes, samples, steps, fallbacks }: Cost) {
        let of = [
            (&self.lobes, lobes),
            (&self.samples, samples),
            (&self.steps, steps),
            (&self.fallbacks, fallbacks),
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
