//! Packed weights: the light that a tile passes to at most four functions, 32 bytes.

/// Functions that a tile, or a hit, passes its light to.
const SLOTS: usize = 4;
/// No function.
const NONE: u32 = u32::MAX;
/// In place of the first function: nobody knows.
const UNKNOWN: u32 = u32::MAX - 1;

/// Light passed to functions: shares of a whole, half a cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub struct PackedWeights {
    functions: [u32; SLOTS],
    amounts: [f32; SLOTS],
}

impl PackedWeights {
    /// No light.
    pub const NOTHING: Self = Self { functions: [NONE; SLOTS], amounts: [0.0; SLOTS] };
    /// Nobody knows: whoever hits it must look.
    pub const UNKNOWN: Self = Self { functions: [UNKNOWN; SLOTS], amounts: [0.0; SLOTS] };

    /// So much that no function covers.
    pub fn lost(amount: f32) -> Self {
        Self { amounts: [amount, 0.0, 0.0, 0.0], ..Self::NOTHING }
    }

    /// From some functions' weights, which sum to 1, and the light that each of them gets for a whole. Of more than
    /// fit, each is there as often on average as it weighs; `chance`, 0 to 1, decides.
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
            // The last one takes what rounding leaves.
            while slot < SLOTS && ((slot as f32 + chance) * EACH < below || i + 1 == weights.len()) {
                (out.functions[slot], out.amounts[slot]) = (function, EACH * light);
                slot += 1;
            }
        }
        out
    }

    /// The same light, scaled.
    #[inline]
    pub fn scaled(mut self, factor: f32) -> Self {
        self.amounts.iter_mut().for_each(|amount| *amount *= factor);
        self
    }

    /// All light together.
    #[inline]
    pub fn sum(&self) -> f32 {
        self.amounts.iter().sum()
    }

    /// Whether nobody knows.
    #[inline]
    pub fn is_unknown(&self) -> bool {
        self.functions[0] == UNKNOWN
    }

    /// Whether no function covers what is there.
    #[inline]
    pub fn is_lost(&self) -> bool {
        self.functions[0] == NONE
    }

    /// Calls `visit(function, amount)` for each function that gets light.
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
        // Few are there as they are.
        let shares = PackedWeights::of(&weights[..3], 0.9);
        let mut found = Vec::new();
        shares.each(|function, amount| found.push((function, amount)));
        assert_eq!(found, [(7, 0.05 * 2.0), (3, 0.3), (9, 0.02 * 0.5)]);
    }
}
