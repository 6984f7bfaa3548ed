//! Irradiance from the bins of the sky at a receiver: visibility rays in every bin over the horizon.
//!
//! A bin's irradiance per unit radiance is the integral of the cosine over the part of the bin above the horizon, which
//! holds no noise, times the bin's *opening*: the share that the rays find open, each weighted by its cosine. Bins that
//! the receiver's parents see in part, or whose neighbours they see otherwise, get more rays: edges of windows and roofs
//! are there. All openings of a receiver together are drawn towards the parents' by as much as their noise makes likely
//! ([`drawn`]).

use crate::geometry::Surfaces;
use crate::random::{Stream, mix};
use crate::sampling::SurfacePoint;
use glam::{UVec2, Vec2, Vec3};
use rebounce_shared::environment::bins::{BINS, SOLID_ANGLE, bin_of, direction};

/// Rows and columns of rays within a bin: at the edge of what is seen, and elsewhere.
const SIDES: [u32; 2] = [2, 1];
/// Rows and columns of rays within every bin of a receiver without parents.
const FIRST: u32 = 4;
/// Visible share of a bin at which it counts as partly hidden: above, and up to 1 minus this.
const PARTLY: u8 = 8;
/// Rows and columns of fixed directions within a bin.
const FIXED: u32 = 4;
/// Cosine of a bin's middle, above which the whole bin is over the horizon.
const ABOVE: f32 = 0.35;

/// Visible share of each bin, 0 to 255.
pub type Openings = [u8; BINS];

/// Irradiance of a receiver from the sky.
pub struct SkySeen {
    /// Irradiance from each bin per unit radiance.
    pub irradiance: [f32; BINS],
    /// Visible share of each bin.
    pub openings: Openings,
    /// Number of rays cast.
    pub rays: u64,
}

/// Tables of the bins.
pub struct SkyBins {
    /// Bins beside each bin.
    beside: Vec<Vec<u8>>,
    /// Integral of the direction over each bin, and fixed directions that sum up to it.
    directions: Vec<(Vec3, [Vec3; (FIXED * FIXED) as usize])>,
}

impl SkyBins {
    /// Finds the bins beside each bin, and fixed directions in each.
    pub fn new() -> Self {
        let beside = |bin: usize| {
            let middle = direction(bin, Vec2::splat(0.5));
            let (right, up) = middle.any_orthonormal_pair();
            // A circle around the middle, about the width of a bin away.
            let width = SOLID_ANGLE.sqrt();
            let around = (0..12).map(|k| {
                let (sin, cos) = (k as f32 / 12.0 * std::f32::consts::TAU).sin_cos();
                bin_of((middle + width * (cos * right + sin * up)).normalize()) as u8
            });
            let mut all: Vec<u8> = around.filter(|other| usize::from(*other) != bin).collect();
            all.sort_unstable();
            all.dedup();
            all
        };
        let directions = |bin: usize| {
            let share = SOLID_ANGLE / (FIXED * FIXED) as f32;
            let fixed = std::array::from_fn(|k| {
                let cell = UVec2::new(k as u32 % FIXED, k as u32 / FIXED).as_vec2();
                share * direction(bin, (cell + 0.5) / FIXED as f32)
            });
            (fixed.iter().sum(), fixed)
        };
        Self { beside: (0..BINS).map(beside).collect(), directions: (0..BINS).map(directions).collect() }
    }

    /// Irradiance from an open bin of radiance 1.
    pub fn unoccluded(&self, bin: usize, normal: Vec3) -> f32 {
        let (sum, fixed) = &self.directions[bin];
        let whole = sum.dot(normal);
        if whole.abs() > ABOVE * SOLID_ANGLE {
            return whole.max(0.0);
        }
        fixed.iter().map(|direction| direction.dot(normal).max(0.0)).sum()
    }

    /// Rows and columns of rays for each bin of a receiver, by what its parents see.
    fn sides(&self, parents: &[(&Openings, f32)]) -> [u32; BINS] {
        let Some(_) = parents.first() else { return [FIRST; BINS] };
        // Least and greatest share seen by a parent.
        let range = |bin: usize| {
            let seen = parents.iter().map(|(parent, _)| parent[bin]);
            seen.fold((u8::MAX, 0), |(least, most), share| (least.min(share), most.max(share)))
        };
        let ranges: [(u8, u8); BINS] = std::array::from_fn(range);
        std::array::from_fn(|bin| {
            let all = self.beside[bin].iter().map(|other| ranges[usize::from(*other)]);
            let (least, most) =
                all.fold(ranges[bin], |(least, most), other| (least.min(other.0), most.max(other.1)));
            let is_even = most <= PARTLY || least >= u8::MAX - PARTLY;
            SIDES[usize::from(is_even)]
        })
    }
}

/// Mean openings of a receiver's parents, by their weights.
pub fn mean_openings(parents: &[(&Openings, f32)]) -> [f32; BINS] {
    let total: f32 = parents.iter().map(|parent| parent.1).sum();
    let mean = |bin: usize| {
        parents.iter().map(|(openings, weight)| weight * f32::from(openings[bin])).sum::<f32>()
            / (255.0 * total)
    };
    std::array::from_fn(mean)
}

/// Shares as bytes.
pub fn openings(shares: &[f32; BINS]) -> Openings {
    shares.map(|share| (255.0 * share + 0.5) as u8)
}

/// Casts the rays of a receiver toward the sky. `parents` have a weight each; their openings are trusted the more the
/// greater the `significance`.
pub fn see_sky<S: Surfaces + ?Sized>(
    surfaces: &S,
    point: &SurfacePoint,
    receiver: usize,
    bins: &SkyBins,
    parents: &[(&Openings, f32)],
    (significance, seed): (f32, u64),
) -> SkySeen {
    let origin = point.position + point.geometric_normal * surfaces.epsilon_at(point.position);
    let (low, high) = surfaces.bounds();
    let far = 2.0 * (high - low).length();
    let mut stream = Stream::new(mix(seed) ^ 0x0073_6b79, receiver as u64);
    let expected = if parents.is_empty() { [0.0; BINS] } else { mean_openings(parents) };
    let unoccluded: [f32; BINS] = std::array::from_fn(|bin| bins.unoccluded(bin, point.normal));
    let (mut shares, mut counts, mut rays) = (expected, [0u32; BINS], 0);
    for (bin, side) in bins.sides(parents).into_iter().enumerate() {
        if unoccluded[bin] == 0.0 {
            continue;
        }
        let (mut open, mut over) = (0.0, 0.0);
        for cell in 0..side * side {
            let at = (UVec2::new(cell % side, cell / side).as_vec2() + stream.square()) / side as f32;
            let way = direction(bin, at);
            let cosine = point.normal.dot(way);
            if cosine <= 0.0 {
                continue;
            }
            (over, counts[bin]) = (over + cosine, counts[bin] + 1);
            if point.geometric_normal.dot(way) > 0.0 {
                rays += 1;
                open += cosine * surfaces.transmittance(origin, origin + far * way).element_sum() / 3.0;
            }
        }
        if over > 0.0 {
            shares[bin] = open / over;
        }
    }
    if !parents.is_empty() {
        shares = drawn(&unoccluded, &expected, &shares, &counts, significance);
    }
    SkySeen {
        irradiance: std::array::from_fn(|bin| unoccluded[bin] * shares[bin]),
        openings: openings(&shares),
        rays,
    }
}

/// Returns the openings, moved towards what the parents lead to expect: their difference is multiplied by
/// 1 − s² N / D, at least 0, with D the sum over the bins of the squared differences of the irradiance, N the sum of their
/// variances, and s the `significance` (James and Stein 1961, positive part). Where few bins differ from the parents the
/// differences are noise; at the edge of a shadow many do. `counts` are the rays of each bin; of a few rays that agree
/// the expected opening tells the variance.
fn drawn(
    unoccluded: &[f32; BINS],
    expected: &[f32; BINS],
    shares: &[f32; BINS],
    counts: &[u32; BINS],
    significance: f32,
) -> [f32; BINS] {
    let (mut differences, mut noise) = (0.0, 0.0);
    for bin in (0..BINS).filter(|bin| counts[*bin] > 0) {
        let square = unoccluded[bin] * unoccluded[bin];
        let binomial = |share: f32| share * (1.0 - share);
        differences += square * (shares[bin] - expected[bin]).powi(2);
        noise += square * binomial(shares[bin]).max(binomial(expected[bin])) / counts[bin] as f32;
    }
    noise *= significance * significance;
    let kept = if differences > noise { 1.0 - noise / differences } else { 0.0 };
    std::array::from_fn(|bin| expected[bin] + kept * (shares[bin] - expected[bin]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    #[test]
    fn open_bins_give_a_hemispheres_irradiance() {
        let bins = SkyBins::new();
        for normal in [Vec3::Y, Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.3, 0.5, -0.7).normalize()] {
            let sum: f32 = (0..BINS).map(|bin| bins.unoccluded(bin, normal)).sum();
            assert!((sum / PI - 1.0).abs() < 2e-3, "{sum}");
        }
    }

    #[test]
    fn noise_follows_the_parents_and_shadows_do_not() {
        let (unoccluded, counts) = ([0.02; BINS], [4; BINS]);
        let expected: [f32; BINS] = std::array::from_fn(|bin| if bin < 64 { 0.5 } else { 1.0 });
        // Quarters more or less in half-open bins are what four rays scatter by.
        let noisy: [f32; BINS] =
            std::array::from_fn(|bin| if bin < 64 { 0.25 + 0.5 * (bin % 2) as f32 } else { 1.0 });
        assert_eq!(drawn(&unoccluded, &expected, &noisy, &counts, 1.0), expected);
        // A hundred bins that are closed against expectation are a shadow.
        let shadow: [f32; BINS] = std::array::from_fn(|bin| if bin < 164 { 0.0 } else { 1.0 });
        let drawn = drawn(&unoccluded, &expected, &shadow, &counts, 1.0);
        assert!(drawn[100] < 0.05 && drawn[0] < 0.03 && drawn[200] == 1.0, "{} {}", drawn[100], drawn[0]);
    }
}
