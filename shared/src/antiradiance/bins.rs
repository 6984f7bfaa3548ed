//! Bins of directions: rings of equal-area cells, after Leopardi, *A Partition of the Unit Sphere into Regions of Equal Area
//! and Small Diameter* (2006).
//!
//! Unlike Leopardi's, each ring has a multiple of four cells and no ring crosses the equator, so that the three planes of the
//! axes are borders of bins: at a wall along an axis no bin has directions of both sides. The bins are symmetric: the
//! opposite of a bin is a bin.

use crate::elementary::Elementary;
use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// Least and greatest number of bins.
pub const LEAST_BINS: usize = 64;
/// See [`LEAST_BINS`]; a bin is ten bits of a [transfer](super::transfer::Transfer).
pub const MOST_BINS: usize = 1024;
/// Numbers of bins are multiples of this.
pub const STEP: usize = 8;
/// Cells of a ring are a multiple of this.
const QUARTERS: usize = 4;

/// Bins of the sphere of directions; the pole is y.
#[derive(Clone, Debug, PartialEq)]
pub struct Bins {
    /// First bin of each ring from +y on, and the number of bins at the end.
    pub starts: Vec<u32>,
    /// Direction of the middle of each bin, unit length.
    pub directions: Vec<Vec3>,
    /// Ring of each bin.
    ring_of: Vec<u8>,
}

impl Bins {
    /// About so many bins: the next multiple of [`STEP`] between [`LEAST_BINS`] and [`MOST_BINS`].
    pub fn new(count: usize) -> Self {
        let count = count.next_multiple_of(STEP).clamp(LEAST_BINS, MOST_BINS);
        let half = count / 2;
        // Rings are as high as a square cell is at the equator.
        let side = (4.0 * PI / count as f32).sqrt();
        let rings = (FRAC_PI_2 / side).round().max(1.0) as usize;
        let mut ends: Vec<usize> = Vec::new();
        for ring in 1..=rings {
            let polar = FRAC_PI_2 * ring as f32 / rings as f32;
            let above = half as f32 * (1.0 - polar.cosine());
            let least = ends.last().map_or(0, |end| end + QUARTERS);
            ends.push(((above / QUARTERS as f32).round() as usize * QUARTERS).max(least).max(QUARTERS));
        }
        if let Some(last) = ends.last_mut() {
            *last = half;
        }
        let mut starts: Vec<u32> = vec![0];
        starts.extend(ends.iter().map(|end| *end as u32));
        starts.extend(ends[..rings - 1].iter().rev().map(|end| (count - end) as u32));
        starts.push(count as u32);
        let mut directions = Vec::with_capacity(count);
        let mut ring_of = Vec::with_capacity(count);
        for (number, ring) in (0..).zip(starts.windows(2)) {
            let y = 1.0 - (ring[0] + ring[1]) as f32 / count as f32;
            let across = (1.0 - y * y).max(0.0).sqrt();
            let cells = ring[1] - ring[0];
            ring_of.resize(ring[1] as usize, number);
            for cell in 0..cells {
                let (sine, cosine) = (TAU * (cell as f32 + 0.5) / cells as f32).sine_cosine();
                directions.push(Vec3::new(across * cosine, y, across * sine).normalize_or_zero());
            }
        }
        Self { starts, directions, ring_of }
    }

    /// Number of bins.
    pub fn count(&self) -> usize {
        self.directions.len()
    }

    /// Solid angle of each bin, sr.
    pub fn solid_angle(&self) -> f32 {
        4.0 * PI / self.count() as f32
    }

    /// Sine of the half angle of a cone of a bin's solid angle.
    pub fn sine(&self) -> f32 {
        let cosine = 1.0 - self.solid_angle() / TAU;
        (1.0 - cosine * cosine).max(0.0).sqrt()
    }

    /// The bin of a unit direction.
    pub fn bin_of(&self, direction: Vec3) -> usize {
        let count = self.count();
        // Areas above are numbers of bins, and rings begin at whole ones.
        let above = 0.5 * (1.0 - direction.y) * count as f32;
        let ring = self.ring_of[(above as usize).min(count - 1)] as usize;
        let (first, end) = (self.starts[ring] as usize, self.starts[ring + 1] as usize);
        let turn = turn(direction.x, direction.z);
        first + ((turn * (end - first) as f32) as usize).min(end - first - 1)
    }
}

/// Angle of a direction in the plane, in turns from x on, 0 to 1: a polynomial for an eighth of it (Abramowitz and Stegun 4.4.47,
/// within 1e-5 radians). It is exact along the axes, where bins of all rings begin.
fn turn(x: f32, z: f32) -> f32 {
    let (wide, narrow) = (x.abs().max(z.abs()), x.abs().min(z.abs()));
    let slope = narrow / wide.max(f32::MIN_POSITIVE);
    let square = slope * slope;
    let even = ((0.020_835_1 * square - 0.085_133) * square + 0.180_141) * square - 0.330_299_5;
    let eighth = slope * (even * square + 0.999_866) / TAU;
    let quarter = if z.abs() > x.abs() { 0.25 - eighth } else { eighth };
    let half = if x < 0.0 { 0.5 - quarter } else { quarter };
    if z < 0.0 { 1.0 - half } else { half }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn turns_are_those_of_the_arc_tangent() {
        let mut stream = Stream::new(1, 3);
        for _ in 0..10_000 {
            let way = stream.sphere();
            let exact = way.z.arc_tangent2(way.x) / TAU;
            let exact = if exact < 0.0 { exact + 1.0 } else { exact };
            let off = (turn(way.x, way.z) - exact).abs();
            assert!(off.min(1.0 - off) < 3e-6, "{way}: {off}");
        }
        let axes = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
        assert_eq!(axes.map(|(x, z)| turn(x, z)), [0.0, 0.25, 0.5, 0.75]);
    }

    #[test]
    fn bins_have_equal_areas_and_their_middles_within() {
        for count in [64, 128, 200, 1024] {
            let bins = Bins::new(count);
            assert_eq!(bins.count(), count);
            for (i, direction) in bins.directions.iter().enumerate() {
                assert_eq!(bins.bin_of(*direction), i, "{count}");
            }
            let samples = 1_000 * count;
            let mut found = vec![0u32; count];
            let mut stream = Stream::new(1, 2);
            (0..samples).for_each(|_| found[bins.bin_of(stream.sphere())] += 1);
            for hits in found {
                assert!((850..1_150).contains(&hits), "{hits} of {count}");
            }
        }
    }

    #[test]
    fn no_bin_crosses_a_plane_of_the_axes_and_each_has_an_opposite() {
        for count in [64, 128, 512, 968] {
            let bins = Bins::new(count);
            let mut stream = Stream::new(1, 3);
            for _ in 0..100_000 {
                let direction = stream.sphere();
                let middle = bins.directions[bins.bin_of(direction)];
                assert!((direction * middle).min_element() > -1e-6, "{direction} {middle}");
                // As wide as high: within twice the cone of the same solid angle.
                let sine = direction.cross(middle).length();
                assert!(sine < 2.2 * bins.sine() && direction.dot(middle) > 0.0, "{sine} of {count}");
            }
            for direction in &bins.directions {
                let opposite = bins.directions[bins.bin_of(-*direction)];
                assert!(opposite.distance(-*direction) < 1e-5);
            }
        }
    }
}
