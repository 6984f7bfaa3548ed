//! Irradiance from the bins of the sky at a receiver: visibility rays in every bin over the horizon.
//!
//! A bin's irradiance per unit radiance is the integral of visibility times cosine over the bin's solid angle. Bins that
//! the receiver's parents see in part, or whose neighbours they see otherwise, get more rays: edges of windows and roofs
//! are there. What the receiver's own rays find does not change the number of rays, so that the estimate is unbiased.

use crate::geometry::Surfaces;
use crate::random::{Stream, mix};
use crate::sampling::SurfacePoint;
use glam::{UVec2, Vec2};
use rebounce_shared::elementary::Elementary;
use rebounce_shared::environment::bins::{BINS, SOLID_ANGLE, bin_of, direction};

/// Rows and columns of rays within a bin: at the edge of what is seen, and elsewhere.
const SIDES: [u32; 2] = [2, 1];
/// Rows and columns of rays within every bin of a receiver without parents.
const FIRST: u32 = 4;
/// Visible share of a bin at which it counts as partly hidden: above, and up to 1 minus this.
const PARTLY: u8 = 8;

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

/// Table of the bins beside each bin.
pub struct Beside(Vec<Vec<u8>>);

impl Beside {
    /// Finds the bins beside each bin.
    pub fn of_bins() -> Self {
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
        Self((0..BINS).map(beside).collect())
    }

    /// Rows and columns of rays for each bin of a receiver, by what its parents see.
    fn sides(&self, parents: &[&Openings]) -> [u32; BINS] {
        let Some(_) = parents.first() else { return [FIRST; BINS] };
        // Least and greatest share seen by a parent.
        let range = |bin: usize| {
            let seen = parents.iter().map(|parent| parent[bin]);
            seen.fold((u8::MAX, 0), |(least, most), share| (least.min(share), most.max(share)))
        };
        let ranges: [(u8, u8); BINS] = std::array::from_fn(range);
        std::array::from_fn(|bin| {
            let all = self.0[bin].iter().map(|other| ranges[usize::from(*other)]);
            let (least, most) =
                all.fold(ranges[bin], |(least, most), other| (least.min(other.0), most.max(other.1)));
            let is_even = most <= PARTLY || least >= u8::MAX - PARTLY;
            SIDES[usize::from(is_even)]
        })
    }
}

/// Casts the rays of a receiver toward the sky.
pub fn see_sky<S: Surfaces + ?Sized>(
    surfaces: &S,
    point: &SurfacePoint,
    receiver: usize,
    beside: &Beside,
    parents: &[&Openings],
    seed: u64,
) -> SkySeen {
    let origin = point.position + point.geometric_normal * surfaces.epsilon_at(point.position);
    let (low, high) = surfaces.bounds();
    let far = 2.0 * (high - low).length();
    let mut stream = Stream::new(mix(seed) ^ 0x0073_6b79, receiver as u64);
    let mut seen = SkySeen { irradiance: [0.0; BINS], openings: [0; BINS], rays: 0 };
    for (bin, side) in beside.sides(parents).into_iter().enumerate() {
        let share = 1.0 / (side * side) as f32;
        let (mut open, mut over) = (0.0, 0.0);
        for cell in 0..side * side {
            let at = (UVec2::new(cell % side, cell / side).as_vec2() + stream.square()) / side as f32;
            let way = direction(bin, at);
            let cosine = point.normal.dot(way);
            if cosine <= 0.0 || point.geometric_normal.dot(way) <= 0.0 {
                continue;
            }
            seen.rays += 1;
            let through = surfaces.transmittance(origin, origin + far * way).element_sum() / 3.0;
            seen.irradiance[bin] += SOLID_ANGLE * share * cosine * through;
            (open, over) = (open + through, over + 1.0);
        }
        if over > 0.0 {
            seen.openings[bin] = (255.0 * open / over + 0.5) as u8;
        }
    }
    seen
}
