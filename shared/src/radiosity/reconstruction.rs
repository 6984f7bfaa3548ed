//! Unshot light at a hit, from the points of the sender level. Twin of `reconstruct.wgsl`.

use crate::basis::Lookup;
use crate::kernel::{LEAST_COSINE, LEAST_WEIGHT, weight};
use crate::rbn::bulk::{Cut, Point};
use glam::{Affine3A, Vec3};

/// How light at a hit is taken from the points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reconstruction {
    /// The basis is evaluated: the mean over the functions that cover the hit.
    Exact,
    /// The value of the nearest centre whose normal agrees (the 2011 paper, 5.1, after Christensen 1999), on this side of its
    /// clip planes.
    #[default]
    Nearest,
}

/// A place of a surface.
#[derive(Clone, Copy, Debug)]
pub struct HitPoint {
    /// Where it is, local space.
    pub position: Vec3,
    /// Unit normal there.
    pub normal: Vec3,
    /// Reconstruction group.
    pub group: u32,
    /// From there to where the file has the group.
    pub rest_from_local: Affine3A,
}

/// Points that send light.
#[derive(Clone, Copy, Debug)]
pub struct Senders<'a> {
    /// Functions by place, where the file has them.
    pub lookup: &'a Lookup,
    /// Points where their groups are.
    pub points: &'a [Point],
    /// Clip planes, in the directions that the file has.
    pub cuts: &'a [Cut],
    /// Sender level.
    pub level: usize,
    /// Number of levels.
    pub levels: usize,
}

impl Senders<'_> {
    /// Returns the light that a place sends: a mean of `light`, the light of each point. Where no point of the sender level
    /// has a part in it, those of finer levels count, then those of coarser ones.
    pub fn light(&self, place: &HitPoint, reconstruction: Reconstruction, light: &[Vec3]) -> Vec3 {
        let rest = place.rest_from_local.transform_point3(place.position);
        for level in (self.level..self.levels).chain((0..self.level).rev()) {
            let found = match reconstruction {
                Reconstruction::Exact => self.mean(level, rest, place, light),
                Reconstruction::Nearest => self.nearest(level, rest, place).map(|j| light[j as usize]),
            };
            if let Some(light) = found {
                return light;
            }
        }
        Vec3::ZERO
    }

    /// Whether a clip plane ends the support of a point before a place.
    #[inline]
    fn is_cut(&self, point: &Point, place: &HitPoint) -> bool {
        let offset = place.rest_from_local.transform_vector3(place.position - point.position());
        self.cuts[point.cuts()].iter().any(|cut| cut.ends(offset))
    }

    /// The point of a level with the nearest centre, among those that may cover the place, whose normals agree, and whose
    /// supports no clip plane ends before it.
    fn nearest(&self, level: usize, rest: Vec3, place: &HitPoint) -> Option<u32> {
        let mut best = (f32::MAX, None);
        let entries = self.lookup.entries(level, rest, place.group);
        for entry in entries.iter().filter(|entry| entry.group() == place.group) {
            let point = &self.points[entry.function() as usize];
            let distance = point.position().distance_squared(place.position);
            if distance < best.0.min(point.radius * point.radius)
                && point.normal().dot(place.normal) > LEAST_COSINE
                && !self.is_cut(point, place)
            {
                best = (distance, Some(entry.function()));
            }
        }
        best.1
    }

    /// The mean over the functions of a level that cover the place.
    fn mean(&self, level: usize, rest: Vec3, place: &HitPoint, light: &[Vec3]) -> Option<Vec3> {
        let (mut sum, mut total) = (Vec3::ZERO, 0.0);
        let entries = self.lookup.entries(level, rest, place.group);
        for entry in entries.iter().filter(|entry| entry.group() == place.group) {
            let point = &self.points[entry.function() as usize];
            let w = weight(place.position - point.position(), place.normal, point.normal(), point.radius);
            if w > 0.0 && !self.is_cut(point, place) {
                sum += w * light[entry.function() as usize];
                total += w;
            }
        }
        (total > LEAST_WEIGHT).then(|| sum / total)
    }
}
