//! An estimate of the irradiance from one group of emissive surfaces, and its noise.
//!
//! Irradiance = unoccluded irradiance × visibility. The first has a closed form where the triangles are few; the second is
//! the share of visibility rays that arrive. A receiver's own rays are weighed against the visibility at its parents.

use glam::Vec3;
use smallvec::SmallVec;

/// Samples of an estimate: irradiance without visibility, and with it.
pub(super) type Pairs = SmallVec<[(Vec3, Vec3); 32]>;

/// Irradiance from one group, linear RGB, and what its estimate is worth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GroupSeen {
    /// Irradiance.
    pub irradiance: Vec3,
    /// Irradiance if nothing were hidden.
    pub unoccluded: Vec3,
    /// Variance of the unoccluded irradiance; 0 where it is a closed form.
    pub variance: Vec3,
    /// Sum of the squares of what single visibility rays stand for. Times V (1 − V) it is the variance of the irradiance
    /// that comes from the visibility V.
    pub spread: Vec3,
}

/// Returns the irradiance by the ratio estimator: the unoccluded irradiance `whole` times the share of the samples that
/// arrives.
pub(super) fn by_ratio(whole: Vec3, pairs: &[(Vec3, Vec3)]) -> GroupSeen {
    let [all, through] = pairs.iter().fold([Vec3::ZERO; 2], |[a, t], pair| [a + pair.0, t + pair.1]);
    // A channel that no sample found has the visibility of the others.
    let mean = through.element_sum() / all.element_sum().max(f32::MIN_POSITIVE);
    let ratio = Vec3::select(all.cmpgt(Vec3::ZERO), through / all, Vec3::splat(mean));
    let squares: Vec3 = pairs.iter().map(|pair| pair.0 * pair.0).sum();
    let scale = Vec3::select(all.cmpgt(Vec3::ZERO), whole / all, Vec3::ZERO);
    GroupSeen {
        irradiance: whole * ratio,
        unoccluded: whole,
        variance: Vec3::ZERO,
        spread: squares * scale * scale,
    }
}

/// Triangles to which no ray went, of unoccluded irradiance `whole`: as visible as those that were `found`, by a single
/// ray's word. Without these nothing is known of the visibility: the spread is infinite.
pub(super) fn as_visible_as(found: &GroupSeen, whole: Vec3) -> GroupSeen {
    let is_known = found.unoccluded.cmpgt(Vec3::ZERO) | whole.cmpeq(Vec3::ZERO);
    GroupSeen {
        irradiance: whole * found.visibility(Vec3::ONE),
        unoccluded: whole,
        variance: Vec3::ZERO,
        spread: Vec3::select(is_known, whole * whole, Vec3::INFINITY),
    }
}

impl GroupSeen {
    pub(super) fn add(&mut self, other: Self) {
        self.irradiance += other.irradiance;
        self.unoccluded += other.unoccluded;
        self.variance += other.variance;
        self.spread += other.spread;
    }

    /// The mean of two independent estimates, of which the other had `times` as many rays.
    pub(super) fn with(self, other: Self, times: f32) -> Self {
        let [a, b] = [1.0 / (1.0 + times), times / (1.0 + times)];
        Self {
            irradiance: a * self.irradiance + b * other.irradiance,
            unoccluded: a * self.unoccluded + b * other.unoccluded,
            variance: a * a * self.variance + b * b * other.variance,
            spread: a * a * self.spread + b * b * other.spread,
        }
    }

    /// The share of the unoccluded irradiance that arrives, by channel; `absent` where nothing would.
    pub fn visibility(&self, absent: Vec3) -> Vec3 {
        let share = self.irradiance / self.unoccluded;
        Vec3::select(self.unoccluded.cmpgt(Vec3::ZERO), share, absent)
    }

    /// Variance of the visibility. A few rays of which all arrive say little of their own spread; `parents` is the
    /// visibility that is expected, and the larger variance of both counts.
    fn visibility_variance(&self, parents: Vec3) -> Vec3 {
        let binomial =
            |share: Vec3| share.clamp(Vec3::ZERO, Vec3::ONE) * (1.0 - share.clamp(Vec3::ZERO, Vec3::ONE));
        let larger = binomial(self.visibility(parents)).max(binomial(parents));
        let square = self.unoccluded * self.unoccluded;
        Vec3::select(square.cmpgt(Vec3::ZERO), self.spread * larger / square, Vec3::ZERO)
    }

    /// Whether the estimate is noisier than `tolerance`, an irradiance.
    pub(super) fn is_noisy(&self, parents: Vec3, tolerance: Vec3) -> bool {
        let variance = self.visibility_variance(parents) * self.unoccluded * self.unoccluded;
        variance.cmpgt(tolerance * tolerance).any() || !self.spread.is_finite()
    }

    /// Moves the visibility towards that of the `parents` by as much as its noise makes likely: the difference is
    /// multiplied by 1 − s² σ² / difference², at least 0 (James and Stein 1961, positive part), with s the `significance`.
    /// A visibility of which nothing is known becomes the parents'.
    #[must_use]
    pub fn towards(mut self, parents: Vec3, significance: f32) -> Self {
        let difference = self.visibility(parents) - parents;
        let noise = significance * significance * self.visibility_variance(parents);
        let square = difference * difference;
        let kept = Vec3::select(square.cmpgt(noise), 1.0 - noise / square, Vec3::ZERO);
        self.irradiance = self.unoccluded * (parents + difference * kept);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight rays of equal weight, `arriving` of them unoccluded.
    fn eight(arriving: usize) -> GroupSeen {
        let pairs: Vec<(Vec3, Vec3)> =
            (0..8).map(|k| (Vec3::ONE, Vec3::splat(f32::from(u8::from(k < arriving))))).collect();
        by_ratio(Vec3::splat(4.0), &pairs)
    }

    #[test]
    fn certain_visibilities_stay_and_uncertain_ones_follow_the_parents() {
        // Nothing hidden here nor at the parents.
        assert_eq!(eight(8).towards(Vec3::ONE, 1.0).irradiance, Vec3::splat(4.0));
        // All of eight rays arrive where nine tenths are expected to: eight say no more than the parents do.
        let moved = eight(8).towards(Vec3::splat(0.9), 1.0).irradiance.x;
        assert!((moved - 3.6).abs() < 1e-5, "{moved}");
        // None of eight where all are expected: shadow.
        let dark = eight(0).towards(Vec3::ONE, 1.0).irradiance.x;
        assert!(dark.abs() < 1e-5, "{dark}");
        // Between both the estimate lies between both.
        let between = eight(2).towards(Vec3::splat(0.9), 1.0).irradiance.x;
        assert!((1.0..3.6).contains(&between), "{between}");
        // A group to which no ray went is as visible as at the parents.
        let unknown = as_visible_as(&GroupSeen::default(), Vec3::splat(2.0));
        assert_eq!(unknown.towards(Vec3::splat(0.25), 1.0).irradiance, Vec3::splat(0.5));
        assert!(unknown.is_noisy(Vec3::ONE, Vec3::ONE) && !eight(8).is_noisy(Vec3::ONE, Vec3::ZERO));
    }

    #[test]
    fn two_estimates_count_by_their_rays() {
        let both = eight(8).with(eight(0), 3.0);
        assert_eq!(both.irradiance, Vec3::ONE);
        assert_eq!(both.unoccluded, Vec3::splat(4.0));
        // A weight of 2 each: 8 × 4 for the first alone, ten sixteenths of that for both.
        assert_eq!(both.spread, Vec3::splat(0.5 * 0.5 * 8.0 * 10.0 / 16.0));
    }
}
