//! Exact CAD faces as [`Surfaces`](super::Surfaces): one [BVH8](super::bvh8) over the pieces of all faces of all instances
//! ([`rebounce_cad::cast`]). Rays are met in double precision, in the part's space.

#[cfg(test)]
mod tests;

use super::bvh8::{Bvh8, PaddedBox, Visit, build};
use super::mesh::geometry::Surface;
use super::{Hit, Ray};
use crate::scene::brep::{Brep, BrepFace, BrepInstance};
use crate::scene::model::bounds_of_placed;
use glam::{DAffine3, DVec2, DVec3, Vec3};
use rebounce_cad::surface::{LineMeetings, Ray as CadRay, SurfaceHit};
use std::ops::ControlFlow;
use std::sync::Arc;

/// Greatest number of pieces in a leaf: meeting a piece costs many times as much as a box.
const LARGEST_LEAF: u32 = 1;
/// Number of faces whose meetings with a ray are kept.
const KNOWN_FACES: usize = 4;

/// Exact faces, ready for rays.
pub struct BrepSurfaces {
    brep: Arc<Brep>,
    instances: Vec<PlacedPart>,
    bvh: Bvh8,
    /// Pieces in leaf order.
    pieces: Vec<PlacedPiece>,
}

/// Placement of a part.
struct PlacedPart {
    local_from_part: DAffine3,
    part_from_local: DAffine3,
}

/// A piece of an instance's face, by index.
#[derive(Clone, Copy)]
struct PlacedPiece {
    instance: u32,
    face: u32,
    piece: u32,
}

/// A place on a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrepLocation {
    /// Index of the instance.
    pub instance: u32,
    /// Index of the face.
    pub face: u32,
    /// Parameters of its surface.
    pub at: DVec2,
    /// Whether it is on the face's back.
    pub is_back: bool,
}

/// Nearest hit of a ray so far.
#[derive(Clone, Copy)]
struct BrepHit {
    distance: f32,
    at: DVec2,
    instance: u32,
    face: u32,
}

impl BrepSurfaces {
    /// Builds the hierarchy (never `None`) over the faces for which `is_exact` by material; boxes grow by `padding` scene units.
    pub fn new(brep: &Arc<Brep>, is_exact: &[bool], padding: f32) -> Option<Self> {
        let mut pieces = Vec::new();
        let mut boxes = Vec::new();
        for (instance, placed) in (0..).zip(&brep.instances) {
            for face in placed.faces.clone() {
                let of = &brep.faces[face as usize];
                if !is_exact[of.material as usize] {
                    continue;
                }
                for (number, piece) in (0..).zip(&of.pieces) {
                    pieces.push(PlacedPiece { instance, face, piece: number });
                    boxes.push(PaddedBox::new(bounds_of(&placed.local_from_part, piece.bounds), padding));
                }
            }
        }
        let (bvh, order) = build(&boxes, LARGEST_LEAF);
        let instance = |placed: &BrepInstance| PlacedPart {
            local_from_part: placed.local_from_part,
            part_from_local: placed.local_from_part.inverse(),
        };
        Some(Self {
            brep: Arc::clone(brep),
            instances: brep.instances.iter().map(instance).collect(),
            bvh,
            pieces: order.into_iter().map(|i| pieces[i as usize]).collect(),
        })
    }

    /// Number of pieces of all instances.
    pub fn piece_count(&self) -> usize {
        self.pieces.len()
    }

    /// Returns the nearest hit; `seen`: backs of one-sided faces are culled.
    pub fn nearest(&self, materials: &[Surface], ray: &Ray, is_seen: bool) -> Option<Hit> {
        let mut known = KnownMeetings::default();
        let query = Query::new(self, ray, is_seen.then_some(materials), &mut known);
        let visit = NearestFace { query, best: None };
        let best = self.bvh.walk(ray.origin, ray.direction, ray.max_distance, visit)?;
        Some(self.shade(materials, ray, best))
    }

    /// Returns whether a face is met before `limit`.
    pub fn is_hidden(&self, origin: Vec3, direction: Vec3, limit: f32) -> bool {
        let ray = Ray { origin, direction, max_distance: limit, spread: Ray::VISIBILITY };
        let mut known = KnownMeetings::default();
        let visit = AnyFace { query: Query::new(self, &ray, None, &mut known), is_found: false };
        self.bvh.walk(origin, direction, limit, visit)
    }

    /// Returns the nearest face from `origin` in a unit direction, at distances up to `limit`; backs of one-sided faces are culled.
    pub fn locate(
        &self,
        materials: &[Surface],
        origin: Vec3,
        direction: Vec3,
        limit: f32,
    ) -> Option<BrepLocation> {
        let ray = Ray { origin, direction, max_distance: limit, spread: Ray::VISIBILITY };
        let mut known = KnownMeetings::default();
        let visit = NearestFace { query: Query::new(self, &ray, Some(materials), &mut known), best: None };
        let BrepHit { at, instance, face, .. } = self.bvh.walk(origin, direction, limit, visit)?;
        let matrix = self.instances[instance as usize].local_from_part.matrix3;
        let front = matrix * self.brep.faces[face as usize].cast.normal(at);
        Some(BrepLocation { instance, face, at, is_back: front.dot(direction.as_dvec3()) > 0.0 })
    }

    fn shade(&self, materials: &[Surface], ray: &Ray, best: BrepHit) -> Hit {
        let BrepHit { distance, at, instance, face } = best;
        let instance = &self.instances[instance as usize];
        let BrepFace { cast, material, .. } = &self.brep.faces[face as usize];
        let [point, normal] = cast.point_and_normal(at);
        let position = instance.local_from_part.transform_point3(point).as_vec3();
        let front = (instance.local_from_part.matrix3 * normal).normalize_or_zero().as_vec3();
        let surface = &materials[*material as usize];
        let is_front = front.dot(ray.direction) < 0.0;
        let towards = if is_front { front } else { -front };
        let reflects = is_front || surface.double_sided;
        let albedo = if reflects { surface.color } else { Vec3::ZERO };
        Hit {
            distance,
            position,
            geometric_normal: towards,
            normal: if reflects { towards } else { front },
            albedo,
            emission: Vec3::ZERO,
            emitter: None,
            is_unlit: false,
            group: surface.group,
            lightmap: None,
            gloss: surface.gloss,
        }
    }
}

/// Least and greatest corner, local space, of an instance of a box. Rounding must not cut the box: a step of single precision
/// more.
fn bounds_of(local_from_part: &DAffine3, bounds: [DVec3; 2]) -> (Vec3, Vec3) {
    let [low, high] = bounds_of_placed(local_from_part, bounds);
    let step = f64::from(f32::EPSILON) * low.abs().max(high.abs());
    ((low - step).as_vec3(), (high + step).as_vec3())
}

/// A ray among the pieces, in the space of the last instance.
struct Query<'a> {
    surfaces: &'a BrepSurfaces,
    origin: DVec3,
    direction: DVec3,
    /// Materials, if backs of one-sided faces are culled.
    culled_by: Option<&'a [Surface]>,
    instance: u32,
    ray: CadRay,
    known: &'a mut KnownMeetings,
}

/// Where the ray meets the surfaces of the faces that it came to last. A ray comes to several pieces of most faces that it
/// comes to.
#[derive(Default)]
struct KnownMeetings {
    /// Instance and face.
    faces: [(u32, u32); KNOWN_FACES],
    meetings: [Option<LineMeetings>; KNOWN_FACES],
    /// The next one to be forgotten.
    oldest: usize,
}

impl KnownMeetings {
    /// What is known of the face of a piece: nothing at first.
    #[inline]
    fn of(&mut self, placed: &PlacedPiece) -> &mut Option<LineMeetings> {
        let face = (placed.instance, placed.face);
        let known = (0..KNOWN_FACES).find(|i| self.faces[*i] == face && self.meetings[*i].is_some());
        let place = known.unwrap_or_else(|| {
            let oldest = self.oldest;
            self.oldest = (oldest + 1) % KNOWN_FACES;
            self.faces[oldest] = face;
            self.meetings[oldest] = None;
            oldest
        });
        &mut self.meetings[place]
    }
}

impl<'a> Query<'a> {
    fn new(
        surfaces: &'a BrepSurfaces,
        ray: &Ray,
        culled_by: Option<&'a [Surface]>,
        known: &'a mut KnownMeetings,
    ) -> Self {
        let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let ray = CadRay { origin, direction };
        Self { surfaces, origin, direction, culled_by, instance: u32::MAX, ray, known }
    }

    /// Returns the nearest hit with a piece, in leaf order, within `limit`.
    #[inline]
    fn meet(&mut self, place: usize, limit: f32) -> Option<(SurfaceHit, PlacedPiece)> {
        let placed = self.surfaces.pieces[place];
        if placed.instance != self.instance {
            let part_from_local = &self.surfaces.instances[placed.instance as usize].part_from_local;
            self.instance = placed.instance;
            // Not normalised: distances are those of local space.
            self.ray = CadRay {
                origin: part_from_local.transform_point3(self.origin),
                direction: part_from_local.transform_vector3(self.direction),
            };
        }
        let BrepFace { cast, pieces, material, .. } = &self.surfaces.brep.faces[placed.face as usize];
        let culled = self.culled_by.is_some_and(|materials| !materials[*material as usize].double_sided);
        let is_seen = |hit: &SurfaceHit| !culled || cast.normal(hit.at).dot(self.ray.direction) < 0.0;
        let piece = &pieces[placed.piece as usize];
        let distances = [0.0, f64::from(limit)];
        let is_kept = pieces.len() > 1 && cast.has_line_meetings();
        let mut alone = None;
        let known = if is_kept { self.known.of(&placed) } else { &mut alone };
        let hit = cast.nearest(piece, &self.ray, known, distances, is_seen)?;
        Some((hit, placed))
    }
}

/// Visitor for the nearest hit.
struct NearestFace<'a> {
    query: Query<'a>,
    best: Option<BrepHit>,
}

impl Visit for NearestFace<'_> {
    type Found = Option<BrepHit>;

    #[inline]
    fn visit(&mut self, place: usize, limit: f32) -> ControlFlow<(), f32> {
        let Some((hit, placed)) = self.query.meet(place, limit) else {
            return ControlFlow::Continue(limit);
        };
        let distance = hit.distance as f32;
        // Of two faces at equal distance the first one counts, in any order of traversal.
        let order = (placed.instance, placed.face);
        let is_nearer =
            self.best.is_none_or(|best| distance < best.distance || order < (best.instance, best.face));
        if is_nearer {
            self.best = Some(BrepHit { distance, at: hit.at, instance: placed.instance, face: placed.face });
        }
        ControlFlow::Continue(distance.min(limit))
    }

    #[inline]
    fn found(self) -> Self::Found {
        self.best
    }
}

/// Visitor for any hit.
struct AnyFace<'a> {
    query: Query<'a>,
    is_found: bool,
}

impl Visit for AnyFace<'_> {
    type Found = bool;

    #[inline]
    fn visit(&mut self, place: usize, limit: f32) -> ControlFlow<(), f32> {
        self.is_found = self.query.meet(place, limit).is_some();
        if self.is_found { ControlFlow::Break(()) } else { ControlFlow::Continue(limit) }
    }

    #[inline]
    fn found(self) -> bool {
        self.is_found
    }
}
