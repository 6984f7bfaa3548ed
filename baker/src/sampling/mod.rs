//! Points: positions of the basis functions (paper, section 2.3).
//!
//! * [`candidates`] – candidates on surfaces from which light reaches a viewpoint;
//! * [`viewpoint`] – search for viewpoints; [`locate`] – search for an [`emitter`]: viewpoints, and whether the scene
//!   is open;
//! * [`focus`] – local disk radii;
//! * `objects` – points on objects that may move, but for their `interior`;
//! * [`mod@place`] – points of all levels; [`poisson_disk`] – dart throwing of candidates into one level's Poisson-disk
//!   distribution; [`fill`] – filling of the remaining gaps;
//! * [`round`] – rounding to the file's precision;
//! * `around` – surfaces around a point; `clip_planes` – planes that end supports at walls;
//! * [`mod@cube_maps`] – what is seen from places near metals;
//! * [`mod@footprint`] – samples of direct light; [`mod@openness`] – share of the hemisphere free of near surfaces.

mod around;
pub(crate) mod candidates;
mod clip_planes;
pub mod cube_maps;
pub mod emitter;
mod fill;
mod focus;
mod footprint;
mod interior;
mod locate;
mod object_side;
mod objects;
mod openness;
mod particle;
mod patience;
pub mod place;
mod place_settings;
mod poisson_disk;
mod round;
mod viewpoint;

use crate::geometry::{Hit, Surfaces};
use crate::scene::steps::least_step;
pub use clip_planes::cut;
pub use footprint::footprint;
use glam::Vec3;
pub use openness::{open_share, openness};
pub use place::{PlaceError, PlacedMark, Placer, expected_counts, place};
pub use place_settings::{GroupPlacement, PlaceSettings};
use rebounce_shared::octahedral::pack_snorm16;
use rebounce_shared::rbn::bulk::{Cut, Point};
use rebounce_shared::rbn::meta::Level;

/// A point on a surface, local space, with unit normals on the side that light reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Position.
    pub position: Vec3,
    /// Shading normal, used by the basis.
    pub normal: Vec3,
    /// Normal of the true surface, along which ray origins are moved off.
    pub geometric_normal: Vec3,
    /// [Reconstruction group](rebounce_shared::rbn::groups) of the surface.
    pub group: u32,
}

impl SurfacePoint {
    /// Creates the point at a hit, rounded to the file's precision.
    pub fn at<S: Surfaces + ?Sized>(hit: &Hit, surfaces: &S) -> Self {
        let (low, high) = surfaces.bounds();
        let least = least_step(low, high);
        let (position, normal) = round::rounded(hit, surfaces.epsilon_at(hit.position), least);
        Self { position, normal, geometric_normal: hit.geometric_normal, group: hit.group }
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
    /// Indices of the level's points.
    pub fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.count
    }
}

/// Points of all levels, coarsest level first; within a level along a space-filling curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// Levels.
    pub levels: Vec<PointLevel>,
    /// Points of all levels.
    pub points: Vec<SurfacePoint>,
    /// Clip planes of each point's support, at most four per point; empty before [`cut`].
    pub cuts: Vec<Vec<Cut>>,
    /// Samples of each point's direct light, one bit per sample; empty before [`footprint()`].
    pub samples: Vec<u8>,
    /// [Openness](rebounce_shared::openness) of each point, in the file's encoding; empty before [`openness()`].
    pub openness: Vec<u8>,
    /// Radii in each reconstruction group, relative to the level's; empty where all are 1.
    pub scales: Vec<f32>,
}

impl Points {
    /// Clip planes of a point's support.
    pub fn cuts_of(&self, point: usize) -> &[Cut] {
        self.cuts.get(point).map_or(&[], Vec::as_slice)
    }

    /// Samples of a point's direct light, one bit per sample.
    pub fn samples_of(&self, point: usize) -> u8 {
        self.samples.get(point).copied().unwrap_or(0)
    }

    /// Disk and support radii of a reconstruction group, relative to those of the levels.
    #[inline]
    pub fn scale(&self, group: u32) -> f32 {
        self.scales.get(group as usize).copied().unwrap_or(1.0)
    }

    /// Reconstruction group of each point.
    pub fn groups(&self) -> Vec<u32> {
        self.points.iter().map(|point| point.group).collect()
    }

    /// Support radius of point `i` of a level, scene units.
    #[inline]
    pub fn support_radius(&self, level: &PointLevel, i: usize) -> f32 {
        level.support_radius * self.scale(self.points[i].group)
    }

    /// Support radius of each point, scene units.
    fn support_radii(&self) -> Vec<f32> {
        let radii = |level| PointLevel::range(level).map(move |i| self.support_radius(level, i));
        self.levels.iter().flat_map(radii).collect()
    }

    /// Records of the file: points without tints, cuts, and levels.
    pub fn records(&self) -> (Vec<Point>, Vec<Cut>, Vec<Level>) {
        let mut records = Vec::with_capacity(self.points.len());
        let mut cuts = Vec::new();
        for level in &self.levels {
            for i in level.range() {
                let (p, own) = (&self.points[i], self.cuts_of(i));
                records.push(Point {
                    position: p.position.to_array(),
                    radius: self.support_radius(level, i),
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

    /// Number of points on the `levels` coarsest levels.
    pub fn count_on(&self, levels: usize) -> usize {
        self.levels[..levels].last().map_or(0, |level| level.range().end)
    }
}
