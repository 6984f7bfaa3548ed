//! Packed weights: the light from a tile to at most four functions, 32 bytes.

/// Greatest number of functions per tile or hit.
const SLOTS: usize = 4;
/// Index of an empty slot.
const NONE: u32 = u32::MAX;
/// Marker in the first slot of an unknown entry.
const UNKNOWN: u32 = u32::MAX - 1;

/// Light sent to functions, per unit of light at the hit; half a cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct PackedWeights {
    functions: [u32; SLOTS],
    amounts: [f32; SLOTS],
}

impl PackedWeights {
    /// No light.
    pub const NOTHING: Self = Self { functions: [NONE; SLOTS], amounts: [0.0; SLOTS] };
    /// Unknown weights: hits must be shaded individually.
    pub const UNKNOWN: Self = Self { functions: [UNKNOWN; SLOTS], amounts: [0.0; SLOTS] };

    /// Light that is lost because no function covers the hit.
    pub fn lost(amount: f32) -> Self {
        Self { amounts: [amount, 0.0, 0.0, 0.0], ..Self::NOTHING }
    }

    /// Packs functions as (index, weight, light per unit weight); the weights sum to 1. With more
    /// functions than slots, slots are filled by stratified sampling: each function appears with a
    /// probability proportional to its weight. `chance`, 0 to 1, is the random number.
    pub fn of(weights: &[(u32, f32, f32)], chance: f32) -> Self {
        let mut out = Self::NOTHING;
        if weights.len() <= SLOTS {
            for (slot, &(function, weight, light)) in weights.iter().enumerate() {
                (out.functions[slot], out.amounts[slot]) = (function, weight * light);
            }
            return out;
        }
        const EACH: f32 = 1.0 / SLOTS as f32;
        let (mut slot, mut below) = (0, 0.0);
        for (i, &(function, weight, light)) in weights.iter().enumerate() {
            below += weight;
            // The last function fills slots left over by rounding.
            while slot < SLOTS && ((slot as f32 + chance) * EACH < below || i + 1 == weights.len()) {
                (out.functions[slot], out.amounts[slot]) = (function, EACH * light);
                slot += 1;
            }
        }
        out
    }

    /// Returns the light multiplied by a factor.
    #[inline]
    pub fn scaled(mut self, factor: f32) -> Self {
        self.amounts.iter_mut().for_each(|amount| *amount *= factor);
        self
    }

    /// Total light.
    #[inline]
    pub fn sum(&self) -> f32 {
        self.amounts.iter().sum()
    }

    /// Whether the weights are unknown.
    #[inline]
    pub fn is_unknown(&self) -> bool {
        self.functions[0] == UNKNOWN
    }

    /// Whether no function covers the hit.
    #[inline]
    pub fn is_lost(&self) -> bool {
        self.functions[0] == NONE
    }

    /// Calls `visit(function, amount)` for each function with a slot.
    #[inline]
    pub fn each(&self, mut visit: impl FnMut(usize, f32)) {
        for (&function, &amount) in self.functions.iter().zip(&self.amounts) {
            if function != NONE {
                visit(function as usize, amount);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_goes_to_each_function_by_its_weight_on_average() {
        let weights =
            [(7, 0.05, 2.0), (3, 0.3, 1.0), (9, 0.02, 0.5), (1, 0.4, 1.5), (4, 0.13, 3.0), (8, 0.1, 1.0)];
        let mut sums = [0.0; 10];
        const TIMES: usize = 10_000;
        for k in 0..TIMES {
            let shares = PackedWeights::of(&weights, k as f32 / TIMES as f32);
            assert!(!shares.is_lost());
            let mut total = 0.0;
            shares.each(|function, amount| {
                sums[function] += amount / TIMES as f32;
                total += amount / weights.iter().find(|w| w.0 == function as u32).unwrap().2;
            });
            assert!((total - 1.0).abs() < 1e-6, "{total}");
        }
        for (function, weight, light) in weights {
            let sum = sums[function as usize];
            assert!((sum / (weight * light) - 1.0).abs() < 0.01, "{function}: {sum}, not {}", weight * light);
        }
        // Up to four functions are stored exactly.
        let shares = PackedWeights::of(&weights[..3], 0.9);
        let mut found = Vec::new();
        shares.each(|function, amount| found.push((function, amount)));
        assert_eq!(found, [(7, 0.05 * 2.0), (3, 0.3), (9, 0.02 * 0.5)]);
    }
}
