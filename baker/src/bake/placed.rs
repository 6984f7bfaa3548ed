//! Placed points as partial results: the points of a level, and the cuts and samples of consecutive points.

use crate::job::bytes::{Reader, lengths, put};
use crate::job::partial_results::PartialResults;
use crate::sampling::{PlacedMark, SurfacePoint};
use glam::Vec3;
use rebounce_shared::interpolation::MAX_POINTS;
use rebounce_shared::rbn::bulk::{Cut, MAX_CUTS};
use rebounce_shared::rbn::groups::MAX_GROUPS;

/// Kinds of the records in the partial results; the solver's kinds are greater.
const PLACED: u32 = 1;
const CLIPPED: u32 = 2;

/// Points of one level, and the state of the placement after the level.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PlacedLevel {
    pub mark: PlacedMark,
    pub points: Vec<SurfacePoint>,
}

impl PlacedLevel {
    /// Takes a level from the partial results.
    pub fn take(partial_results: &dyn PartialResults, level: usize) -> Option<Self> {
        Self::decode(&partial_results.take(PLACED, level as u64)?)
    }

    /// Stores a level.
    pub fn keep(&self, partial_results: &dyn PartialResults, level: usize) {
        partial_results.keep(PLACED, level as u64, &self.encode());
    }

    fn encode(&self) -> Vec<u8> {
        let mut out = Vec::new();
        put(&mut out, &[self.mark.next_particle]);
        put(&mut out, &[self.mark.coarse_radius]);
        for point in &self.points {
            put(&mut out, &[point.position, point.normal, point.geometric_normal]);
        }
        let groups: Vec<u32> = self.points.iter().map(|point| point.group).collect();
        put(&mut out, &groups);
        out
    }

    fn decode(bytes: &[u8]) -> Option<Self> {
        let mut from = Reader(bytes);
        let mark = PlacedMark { next_particle: from.one()?, coarse_radius: from.one()? };
        let count = from.rest::<[u32; 10]>();
        let points = from.take::<[Vec3; 3]>(count)?;
        let groups = from.take::<u32>(count)?;
        // Limit far above the number of particles of any bake.
        let is_mark = (1e-30..1e30).contains(&mark.coarse_radius) && mark.next_particle < 1 << 48;
        let is_valid = from.is_empty()
            && is_mark
            && points.len() <= MAX_POINTS
            && groups.iter().all(|group| *group as usize <= MAX_GROUPS);
        if !is_valid || !points.iter().flatten().all(|v| v.is_finite()) {
            return None;
        }
        let point = |([position, normal, geometric_normal], group): ([Vec3; 3], u32)| SurfacePoint {
            position,
            normal,
            geometric_normal,
            group,
        };
        Some(Self { mark, points: points.into_iter().zip(groups).map(point).collect() })
    }
}

/// Cuts and samples of consecutive points.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ClippedPoints {
    pub cuts: Vec<Vec<Cut>>,
    pub samples: Vec<u8>,
}

impl ClippedPoints {
    /// Takes the cuts and samples of points from `first` on from the partial results.
    pub fn take(partial_results: &dyn PartialResults, first: usize) -> Option<Self> {
        Self::decode(&partial_results.take(CLIPPED, first as u64)?)
    }

    /// Stores the cuts and samples of points from `first` on.
    pub fn keep(&self, partial_results: &dyn PartialResults, first: usize) {
        partial_results.keep(CLIPPED, first as u64, &self.encode());
    }

    fn encode(&self) -> Vec<u8> {
        let mut out = Vec::new();
        put(&mut out, &[self.cuts.len() as u64]);
        put(&mut out, &lengths(self.cuts.iter()));
        self.cuts.iter().for_each(|row| put(&mut out, row));
        put(&mut out, &self.samples);
        out
    }

    fn decode(bytes: &[u8]) -> Option<Self> {
        let mut from = Reader(bytes);
        let count = from.one::<u64>()? as usize;
        let lengths = from.take::<u32>(count)?;
        let cuts: Vec<Vec<Cut>> = from.rows(&lengths)?;
        let samples = from.take(count)?;
        let is_finite = cuts.iter().flatten().flat_map(|cut| cut.towards).all(f32::is_finite);
        let is_valid = from.is_empty() && is_finite && cuts.iter().all(|cuts| cuts.len() <= MAX_CUTS);
        is_valid.then_some(Self { cuts, samples })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_come_back_as_they_were_and_no_beginning_is_taken_for_them() {
        let mark = PlacedMark { coarse_radius: 0.3, next_particle: 1 << 40 };
        let point = SurfacePoint {
            position: Vec3::ONE,
            normal: Vec3::Y,
            geometric_normal: Vec3::new(0.0, 0.8, 0.6),
            group: 7,
        };
        let placed = PlacedLevel { mark, points: vec![point; 3] };
        let bytes = placed.encode();
        assert_eq!(PlacedLevel::decode(&bytes), Some(placed));
        assert_eq!(PlacedLevel::decode(&bytes[..bytes.len() - 1]), None);
        let cuts = vec![vec![], vec![Cut { towards: [1.0, 2.0, 3.0] }]];
        let clipped = ClippedPoints { cuts, samples: vec![1, 255] };
        let bytes = clipped.encode();
        assert_eq!(ClippedPoints::decode(&bytes), Some(clipped));
        for end in 0..bytes.len() {
            assert_eq!(ClippedPoints::decode(&bytes[..end]), None);
        }
    }
}
