//! Points: where the basis functions sit (paper, section 2.3).
//!
//! [`candidates`] finds surfaces that light reaches from a viewpoint, [`viewpoint`] finds the
//! viewpoint when none is given, [`locate`] also whether the scene is open; an [`emitter`] is what they find. [`focus`] says where points must be fine,
//! [`poisson_disk`] throws the
//! candidates as darts into one level's Poisson-disk distribution, [`fill`] closes the gaps left, [`place`] makes all levels,
//! [`round`] rounds them to what the file keeps, `clip_planes` ends supports at walls, [`footprint`] finds
//! where direct light is sampled, [`openness`] how much near surfaces hide.

pub mod candidates;
mod clip_planes;
pub mod emitter;
mod fill;
pub mod focus;
mod footprint;
pub mod locate;
mod openness;
mod particle;
pub mod place;
pub mod poisson_disk;
pub mod round;
pub mod viewpoint;

use crate::geometry::{Hit, Surfaces};
use crate::scene::steps::least_step;
pub use clip_planes::cut;
pub use footprint::footprint;
use glam::Vec3;
pub use openness::{open_share, openness};
pub use place::{PlaceError, PlaceSettings, PlacedMark, Placer, expected_counts, place};
use rebounce_shared::octahedral::pack_snorm16;
use rebounce_shared::rbn::bulk::{Cut, Point};
use rebounce_shared::rbn::meta::Level;

/// A point on a surface, local space, with its unit normals on the side that light reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Where it is.
    pub position: Vec3,
    /// Shading normal: the one the basis works with.
    pub normal: Vec3,
    /// Normal of the true surface: the one rays are moved off along.
    pub geometric_normal: Vec3,
}

impl SurfacePoint {
    /// The point at a hit, rounded to what the file keeps.
    pub fn at<S: Surfaces + ?Sized>(hit: &Hit, surfaces: &S) -> Self {
        let (low, high) = surfaces.bounds();
        let least = least_step(low, high);
        let (position, normal) = round::rounded(hit, surfaces.epsilon_at(hit.position), least);
        Self { position, normal, geometric_normal: hit.geometric_normal }
    }
}

/// One level of points.
#[derive(Clone, Debug, PartialEq)]
pub struct PointLevel {
    /// Index of the level's first point in [`Points::points`].
    pub first: usize,
    /// Number of points.
    pub count: usize,
    /// Poisson-disk radius `R`, scene units.
    pub disk_radius: f32,
    /// Support radius `C·R` of the level's basis functions, scene units.
    pub support_radius: f32,
}

impl PointLevel {
    /// The indices of the level's points.
    pub fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.count
    }
}

/// All points, level after level, coarsest first; within a level along a space-filling curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// The levels.
    pub levels: Vec<PointLevel>,
    /// The points of all levels.
    pub points: Vec<SurfacePoint>,
    /// The planes that end each point's support, at most four a point; none before [`cut`].
    pub cuts: Vec<Vec<Cut>>,
    /// Each point's samples of direct light, one bit a sample; none before [`footprint`].
    pub samples: Vec<u8>,
    /// Each point's [openness](rebounce_shared::openness), as a file keeps it; none before [`openness`].
    pub openness: Vec<u8>,
}

impl Points {
    /// The planes that end a point's support.
    pub fn cuts_of(&self, point: usize) -> &[Cut] {
        self.cuts.get(point).map_or(&[], Vec::as_slice)
    }

    /// The samples of a point's direct light, one bit a sample.
    pub fn samples_of(&self, point: usize) -> u8 {
        self.samples.get(point).copied().unwrap_or(0)
    }

    /// The radius of each point's support, scene units.
    fn support_radii(&self) -> Vec<f32> {
        self.levels.iter().flat_map(|level| level.range().map(|_| level.support_radius)).collect()
    }

    /// The points as the file has them, tints left out; their cuts; the levels.
    pub fn records(&self) -> (Vec<Point>, Vec<Cut>, Vec<Level>) {
        let mut records = Vec::with_capacity(self.points.len());
        let mut cuts = Vec::new();
        for level in &self.levels {
            for i in level.range() {
                let (p, own) = (&self.points[i], self.cuts_of(i));
                records.push(Point {
                    position: p.position.to_array(),
                    radius: level.support_radius,
                    normal: pack_snorm16(p.normal),
                    cuts: Point::pack_cuts(cuts.len(), own.len(), self.samples_of(i)),
                    tint: 0,
                });
                cuts.extend_from_slice(own);
            }
        }
        let level = |level: &PointLevel| Level {
            first: level.first as u32,
            count: level.count as u32,
            disk_radius: level.disk_radius,
            support_radius: level.support_radius,
        };
        (records, cuts, self.levels.iter().map(level).collect())
    }

    /// Number of points on this many coarsest levels.
    pub fn count_on(&self, levels: usize) -> usize {
        self.levels[..levels].last().map_or(0, |level| level.range().end)
    }
}
