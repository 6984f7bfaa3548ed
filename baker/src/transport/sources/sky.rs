//! Irradiance from the bins of the sky at a receiver: visibility rays in every bin over the horizon.
//!
//! A bin's irradiance per unit radiance is the integral of visibility times cosine over the bin's solid angle. Its
//! estimate has a control variate: with c the cosine of a ray, v what passes, C the integral of the cosine over the open
//! bin and β the share of the bin that the parents see,
//!
//! ```text
//! E = Ω/n Σ c (v − β) + β C
//! ```
//!
//! which is exact where parents and rays agree that the bin is open or closed, and unbiased elsewhere. Bins that the
//! parents see in part, or whose neighbours they see otherwise, get more rays: edges of windows and roofs are there. What
//! the receiver's own rays find does not change their number.

use crate::geometry::Surfaces;
use crate::random::{Stream, mix};
use crate::sampling::SurfacePoint;
use glam::{UVec2, Vec2, Vec3};
use rebounce_shared::elementary::Elementary;
use rebounce_shared::environment::bins::{BINS, SOLID_ANGLE, bin_of, direction};

/// Rows and columns of rays within a bin, at the edge of what is seen and elsewhere: on the finest level, the next, and so
/// on. Errors of coarse levels stay on finer levels, and coarse levels have few points.
const SIDES: [[u32; 2]; 4] = [[2, 1], [2, 1], [3, 1], [4, 2]];
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
    /// Its variance: that of the share of a bin which independent rays find open.
    pub variance: [f32; BINS],
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
    pub fn prepared() -> Self {
        let beside = |bin: usize| {
            let middle = direction(bin, Vec2::splat(0.5));
            let (right, up) = middle.any_orthonormal_pair();
            // A circle around the middle, about the width of a bin away.
            let width = SOLID_ANGLE.sqrt();
            let around = (0..12).map(|k| {
                let (sin, cos) = (k as f32 / 12.0 * std::f32::consts::TAU).sine_cosine();
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

    /// Rows and columns of rays for each bin of a receiver, by what its parents see; `coarser` counts the levels finer than
    /// the receiver's.
    fn sides(&self, coarser: usize, parents: &[(&Openings, f32)]) -> [u32; BINS] {
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
            SIDES[coarser.min(SIDES.len() - 1)][usize::from(is_even)]
        })
    }
}

/// Mean openings of a receiver's parents, by their weights.
fn mean_openings(parents: &[(&Openings, f32)]) -> [f32; BINS] {
    let total: f32 = parents.iter().map(|parent| parent.1).sum();
    let mean = |bin: usize| {
        parents.iter().map(|(openings, weight)| weight * f32::from(openings[bin])).sum::<f32>()
            / (255.0 * total)
    };
    std::array::from_fn(mean)
}

/// Shares as bytes.
fn openings(shares: &[f32; BINS]) -> Openings {
    shares.map(|share| (255.0 * share + 0.5) as u8)
}

/// Casts the rays of a receiver toward the sky; `coarser` counts the levels finer than its own, `parents` have a weight
/// each.
pub fn see_sky<S: Surfaces + ?Sized>(
    surfaces: &S,
    point: &SurfacePoint,
    (receiver, coarser): (usize, usize),
    bins: &SkyBins,
    parents: &[(&Openings, f32)],
    seed: u64,
) -> SkySeen {
    let origin = point.position + point.geometric_normal * surfaces.epsilon_at(point.position);
    let (low, high) = surfaces.bounds();
    let far = 2.0 * (high - low).length();
    let mut stream = Stream::new(mix(seed) ^ 0x0073_6b79, receiver as u64);
    let expected = if parents.is_empty() { [0.5; BINS] } else { mean_openings(parents) };
    let [mut irradiance, mut variance] = [[0.0; BINS]; 2];
    let (mut shares, mut rays) = ([0.0; BINS], 0);
    for (bin, side) in bins.sides(coarser, parents).into_iter().enumerate() {
        let unoccluded = bins.unoccluded(bin, point.normal);
        if unoccluded == 0.0 {
            continue;
        }
        let (mut sum, mut open, mut over) = (0.0, 0.0, 0.0);
        for cell in 0..side * side {
            let at = (UVec2::new(cell % side, cell / side).as_vec2() + stream.square()) / side as f32;
            let way = direction(bin, at);
            let cosine = point.normal.dot(way).max(0.0);
            let mut through = 0.0;
            if cosine > 0.0 && point.geometric_normal.dot(way) > 0.0 {
                rays += 1;
                through = surfaces.transmittance(origin, origin + far * way).element_sum() / 3.0;
            }
            sum += cosine * (through - expected[bin]);
            (open, over) = (open + cosine * through, over + cosine);
        }
        irradiance[bin] = SOLID_ANGLE * sum / (side * side) as f32 + expected[bin] * unoccluded;
        // A bin of which no ray is over the horizon counts as closed.
        shares[bin] = open / f32::max(over, f32::MIN_POSITIVE);
        // Of a few rays that agree what the parents see tells the variance.
        let binomial = |share: f32| share * (1.0 - share);
        let larger = binomial(shares[bin]).max(binomial(expected[bin]));
        variance[bin] = larger * unoccluded * unoccluded / (side * side) as f32;
    }
    SkySeen { irradiance, variance, openings: openings(&shares), rays }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    #[test]
    fn open_bins_give_a_hemispheres_irradiance() {
        let bins = SkyBins::prepared();
        for normal in [Vec3::Y, Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.3, 0.5, -0.7).normalize()] {
            let sum: f32 = (0..BINS).map(|bin| bins.unoccluded(bin, normal)).sum();
            assert!((sum / PI - 1.0).abs() < 2e-3, "{sum}");
        }
    }
}
