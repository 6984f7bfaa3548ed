//! From differences of a receiver's row to links: steps of equal size, with error diffusion along the bins of the sky.

use rebounce_shared::link::{MAX_STEPS, SourceLink};

/// Least sum, as a share of ε, for which a row without links becomes a single link.
const LEAST_SUM: f32 = 0.5;

/// Thresholds and step of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantizer {
    /// Least magnitude of a link's amount.
    pub epsilon: f32,
    /// Size of a step.
    pub step: f32,
    /// Least ratio of a link's amount to the standard deviation of its noise.
    pub significance: f32,
}

impl Quantizer {
    /// Returns the number of steps nearest to an amount.
    pub fn steps(&self, amount: f32) -> i32 {
        ((amount / self.step).round() as i32).clamp(-MAX_STEPS, MAX_STEPS)
    }

    /// Converts a row of values, their variances, and their prediction, to links that start at sender `first`. An amount that is too small
    /// for a link is carried over to the next sender, as is the rounding of a link: the row keeps its sum.
    pub fn row(
        &self,
        first: u32,
        (values, variances): (&[f32], &[f32]),
        predicted: &[f32],
        links: &mut Vec<SourceLink>,
    ) {
        // A smaller amount is no step.
        let least = self.epsilon.max(0.5 * self.step);
        let begin = links.len();
        let (mut carried, mut noise) = (0f32, 0f32);
        let least_noise = self.significance * self.significance;
        let mut strongest = (0, 0f32);
        for (sender, ((value, variance), predicted)) in
            (first..).zip(values.iter().zip(variances).zip(predicted))
        {
            let size = value.abs().max(predicted.abs());
            if size == 0.0 {
                continue;
            }
            carried += value - predicted;
            noise += least_noise * variance;
            if size > strongest.1 {
                strongest = (sender, size);
            }
            if carried * carried > noise.max(least * least) {
                let steps = self.steps(carried);
                links.push(SourceLink::pack(sender, steps));
                carried -= steps as f32 * self.step;
                noise = 0.0;
            }
        }
        let steps = self.steps(carried);
        if links.len() == begin {
            if carried.abs() > LEAST_SUM * self.epsilon && carried * carried > noise && steps != 0 {
                links.push(SourceLink::pack(strongest.0, steps));
            }
        } else if let Some(last) = links.last_mut() {
            let sum = (last.steps() + steps).clamp(-MAX_STEPS, MAX_STEPS);
            *last = SourceLink::pack(last.0 & (rebounce_shared::link::MAX_SOURCES as u32 - 1), sum);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::link::Sent;

    const QUANTIZER: Quantizer = Quantizer { epsilon: 0.1, step: 0.05, significance: 1.0 };

    #[test]
    fn rows_keep_their_sum_and_merge_what_is_small() {
        let values: Vec<f32> =
            (0..256).map(|k| if k < 100 { 0.013 + 0.001 * (k % 7) as f32 } else { 0.0 }).collect();
        let mut links = Vec::new();
        QUANTIZER.row(3, (&values, &[0.0; 256]), &[0.0; 256], &mut links);
        let sum: f32 = links.iter().map(|link| 0.05 * link.steps() as f32).sum();
        assert!((sum - values.iter().sum::<f32>()).abs() <= 0.026, "{sum}");
        assert!(links.len() < 20 && links.iter().all(|link| (3..103).contains(&link.sender())));
        assert!(links.windows(2).all(|pair| pair[0].sender() < pair[1].sender()));
    }

    #[test]
    fn what_is_predicted_or_noise_makes_no_link() {
        let (mut links, values) = (Vec::new(), [0.5f32; 16]);
        QUANTIZER.row(0, (&values, &[0.0; 16]), &values, &mut links);
        QUANTIZER.row(0, (&values, &[1e3; 16]), &[0.4; 16], &mut links);
        assert!(links.is_empty());
        // A prediction far too large is taken back to within a step.
        QUANTIZER.row(0, (&[0.01], &[0.0]), &[700.0], &mut links);
        assert!((700.0 + 0.05 * links[0].steps() as f32 - 0.01).abs() <= 0.03);
    }
}
