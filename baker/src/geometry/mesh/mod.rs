//! Triangle meshes as [`Surfaces`]: a two-level BVH with a [BLAS](blas) of the triangles without instances, a BLAS per
//! [instanced mesh](crate::scene::InstancedMesh), and a [TLAS](tlas) over the instances.
//!
//! obvhs builds the binary BVHs, [`bvh8`](crate::geometry::bvh8) collapses the binary BVHs to eight children per node. Boxes are padded by
//! several rounding errors and the triangle test is watertight, so traversal finds the hits of brute force; a test
//! checks the equality.
//!
//! * [`geometry`]: the input; `glass`: transmission and alpha; `triangle`: watertight ray/triangle test;
//! * `blas`, `tlas`: acceleration structures; `packet`, `packet_traversal`: bundles of rays;
//! * `split`: subdivision of large triangles around the detail; `primitives`: triangles by number; `emitters`: those
//!   that shine.

mod blas;
mod emitters;
pub mod geometry;
pub(crate) mod glass;
mod mean_transmittance;
mod packet;
mod packet_traversal;
mod primitives;
mod split;
#[cfg(test)]
mod tests;
mod tlas;
mod triangle;

pub use geometry::Geometry;

use crate::geometry::{Emitters, Hit, HitEmitter, Primitives, Ray, Surfaces};
use crate::scene::detail::Exactness;
use crate::scene::{Scene, SceneError, union};
use blas::{Blas, LocalRay, TWO_SIDED};
use geometry::{Placed, Surface};
use glam::{Vec2, Vec3};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::motion::Motions;
use rebounce_shared::rbn::lightmap::ChartOffset;
use tlas::{Instance, Tlas};
use triangle::TriangleHit;

/// Two faces are back to back if the cosine between the normal of one face and the reversed normal of the other
/// exceeds this.
pub(super) const OPPOSITE: f32 = 0.9;
/// Minimum cosine between ray and normal, for distances along the ray.
pub(super) const FLATTEST: f32 = 1e-3;
/// Padding of boxes, as a fraction of the scene's diagonal, for the rounding of the box test.
pub(super) const PADDING: f32 = 5e-7;
/// Maximum number of primitives with [`Primitives`]: hit data is precomputed only if memory has room.
pub(crate) const MOST_PRIMITIVES: u64 = 1 << 25;

/// Triangles with textures and alpha.
pub struct TriangleSurfaces {
    /// BLAS of the triangles without instances.
    static_blas: Blas,
    /// Of triangles without instances, then by number of the copy; empty without a lightmap.
    chart_offsets: Vec<ChartOffset>,
    models: Vec<Blas>,
    instances: Tlas,
    surfaces: Vec<Surface>,
    /// Whether a surface transmits coloured light.
    has_glass: bool,
    low: Vec3,
    high: Vec3,
    /// Minimum and maximum corner of the part with the detail.
    main: (Vec3, Vec3),
    exactness: Exactness,
    /// Number of triangles, with every copy counted.
    primitives: u64,
    /// Numbers of the primitives that shine, ascending.
    shining: Vec<u32>,
}

/// Triangle, without instances or in an instance.
#[derive(Clone, Copy)]
struct LocatedTriangle<'a> {
    blas: &'a Blas,
    triangle: usize,
    /// The triangle's instance; `None` for a triangle without instances.
    copy: Option<&'a Instance>,
}

impl LocatedTriangle<'_> {
    /// Returns a normal vector on the triangle's front, local space; the length is twice the triangle's area.
    #[inline]
    fn front(&self) -> Vec3 {
        let spanned = self.blas.front(self.triangle);
        self.copy.map_or(spanned, |copy| copy.across(spanned))
    }

    /// Returns the unit shading normal at barycentric weights of the corners, local space; zero if the corners'
    /// normals cancel.
    #[inline]
    fn normal(&self, [u, v, w]: [f32; 3]) -> Vec3 {
        let mut normals = self.blas.attributes[self.triangle].normals;
        if let Some(copy) = self.copy {
            normals = normals.map(|normal| copy.across(normal).normalize_or_zero());
        }
        (normals[0] * u + normals[1] * v + normals[2] * w).normalize_or_zero()
    }

    /// Returns whether a ray in this direction hits a back without reflection.
    #[inline]
    fn is_dark(&self, direction: Vec3) -> bool {
        self.front().dot(direction) > 0.0 && self.blas.marks[self.triangle] & TWO_SIDED == 0
    }

    /// Transforms a position of the triangle to local space.
    #[inline]
    fn place(&self, position: Vec3) -> Vec3 {
        self.copy.map_or(position, |copy| copy.place(position))
    }
}

impl TriangleSurfaces {
    /// Subdivides large triangles and builds the acceleration structures.
    pub fn new(mut geometry: Geometry) -> Self {
        let main = geometry.main_part();
        if let Some((low, high)) = main {
            split::split(&mut geometry, (high - low).length());
        }
        let bounds = geometry.model_bounds();
        let Geometry { triangles, models, colors, lightmap, chart_offsets, surfaces } = geometry;
        let end = models.first().map_or(triangles.len(), |model| model.triangles.start);
        let alone = (end > 0).then(|| geometry::bounds(&triangles[..end]));
        let boxes = models.iter().zip(&bounds).flat_map(|(model, bounds)| model.boxes(*bounds));
        let (low, high) = alone.into_iter().chain(boxes).reduce(union).unwrap_or_default();
        let main = main.unwrap_or((low, high));
        let diagonal = (high - low).length();
        let padding = PADDING * diagonal;
        let blas = |range: std::ops::Range<usize>, padding: f32| {
            let colors = colors.get(range.clone()).unwrap_or_default();
            let lightmap = lightmap.get(range.clone()).unwrap_or_default();
            Blas::new(&triangles[range.clone()], (colors, lightmap), range.start as u32, &surfaces, padding)
        };
        let primitives = |model: &Placed| model.triangles.len() as u64 * model.local_from_model.len() as u64;
        let static_blas = blas(0..end, padding);
        let instances = Tlas::new(&models, &bounds, padding, end as u64);
        let primitives = end as u64 + models.iter().map(primitives).sum::<u64>();
        let models: Vec<Blas> = (models.iter())
            .map(|model| blas(model.triangles.clone(), Tlas::padding(model, padding)))
            .collect();
        Self {
            shining: emitters::shining(&static_blas, &models, &instances, &surfaces),
            static_blas,
            chart_offsets,
            instances,
            primitives,
            models,
            has_glass: surfaces.iter().any(|surface| surface.glass.is_some()),
            surfaces,
            low,
            high,
            main,
            exactness: Exactness::new(main, (low, high)),
        }
    }

    /// Builds the surfaces of a loaded scene.
    pub fn from_scene(scene: &Scene) -> Self {
        Self::new(Geometry::from(scene))
    }

    /// Builds the surfaces of a loaded scene, after simplification.
    pub fn simplified(scene: &Scene) -> Self {
        Self::new(Geometry::simplified(scene))
    }

    /// Builds the surfaces of a baked file.
    ///
    /// # Errors
    /// [`SceneError::Texture`] if a picture for light transport cannot be decoded.
    pub fn from_baked(scene: &BakedScene) -> Result<Self, SceneError> {
        Self::from_moved(scene, &Motions::default())
    }

    /// As [`Self::from_baked`], with groups where `motions` have them.
    ///
    /// # Errors
    /// [`SceneError::Texture`] if a picture for light transport cannot be decoded.
    pub fn from_moved(scene: &BakedScene, motions: &Motions) -> Result<Self, SceneError> {
        Ok(Self::new(Geometry::of_baked(scene, motions)?))
    }

    /// Returns the number of triangles, with a model counted once.
    pub fn triangle_count(&self) -> usize {
        self.static_blas.corners.len() + self.models.iter().map(|model| model.corners.len()).sum::<usize>()
    }

    /// Returns the number of triangles, with every copy of a model counted.
    pub fn piece_count(&self) -> u64 {
        self.primitives
    }

    /// Returns the materials.
    pub fn materials(&self) -> &[Surface] {
        &self.surfaces
    }

    /// Returns a material, by number.
    pub fn material(&self, number: u32) -> &Surface {
        &self.surfaces[number as usize]
    }

    /// The hit of a ray; `is_seen`: of an eye's ray, which meets fronts alone, also at a silhouette, where the shading normal
    /// may point away.
    fn shade(&self, found: LocatedTriangle, m: TriangleHit, ray: &Ray, is_seen: bool) -> Hit {
        let direction = ray.direction;
        let LocatedTriangle { blas, triangle, .. } = found;
        let (look, corners) = (&blas.attributes[triangle], &blas.corners[triangle]);
        let [a, b, c] = corners.positions();
        let spanned = found.front();
        let geometric_normal = match spanned.normalize_or_zero() {
            Vec3::ZERO => -direction,
            outwards if outwards.dot(direction) > 0.0 => -outwards,
            outwards => outwards,
        };
        let surface = &self.surfaces[look.material as usize];
        let mut normal = match found.normal(m.shares()) {
            Vec3::ZERO => geometric_normal,
            normal => normal,
        };
        let mut faces = normal.dot(direction) < 0.0;
        if !faces && surface.double_sided {
            normal = -normal;
            faces = true;
        }
        faces |= is_seen;
        let (albedo, emission) = if faces {
            let share = look.share(spanned) * (ray.spread * m.distance).powi(2);
            let color = blas.color(&self.surfaces, triangle, m.shares());
            let albedo = surface.albedo(color, look.uv(m.shares()), share);
            let shine = || surface.shine(look.uv(m.shares()), share);
            (albedo, if surface.is_unlit { albedo } else { shine() })
        } else {
            (Vec3::ZERO, Vec3::ZERO)
        };
        let position = found.place(a + (b - a) * m.v + (c - a) * m.w);
        let is_unlit = surface.is_unlit;
        let emitter = match emission == Vec3::ZERO || is_unlit {
            true => None,
            false => self.emitter_at(&found).map(HitEmitter::Surface),
        };
        Hit {
            distance: m.distance,
            position,
            geometric_normal,
            normal,
            albedo,
            emission,
            emitter,
            is_unlit,
            group: surface.group,
            lightmap: self.lightmap_at(&found, m, direction),
            gloss: surface.gloss(look.uv(m.shares())),
        }
    }

    /// Returns the place of a hit in the lightmap, texels.
    #[inline]
    fn lightmap_at(&self, found: &LocatedTriangle, m: TriangleHit, direction: Vec3) -> Option<Vec2> {
        let within = found.blas.lightmap(found.triangle, m.shares())?;
        let offset = self.chart_offsets.get(found.copy.map_or(0, Instance::charts))?;
        Some(within + offset.of_side(found.front().dot(direction) > 0.0).as_vec2())
    }

    /// Returns the distance of the nearest hit: the traversal of [`Surfaces::cast`] without shading.
    #[inline]
    pub fn distance(&self, ray: &Ray, seed: u32) -> Option<f32> {
        self.nearest(ray, seed).map(|(_, meeting)| meeting.distance)
    }

    /// Returns the nearest triangle stopping the ray, and the hit.
    #[inline]
    fn nearest(&self, ray: &Ray, seed: u32) -> Option<(LocatedTriangle<'_>, TriangleHit)> {
        let line = LocalRay { origin: ray.origin, direction: ray.direction };
        let alone = self.static_blas.nearest(&self.surfaces, &line, ray.max_distance, false, seed);
        self.with_all(ray, seed, alone)
    }

    /// As [`Self::nearest`], with the hit `alone` of the triangles without instances as input.
    #[inline]
    fn with_all(
        &self,
        ray: &Ray,
        seed: u32,
        alone: Option<(usize, TriangleHit)>,
    ) -> Option<(LocatedTriangle<'_>, TriangleHit)> {
        let (found, meeting) = self.with_copies(ray, seed, alone, Blas::nearest)?;
        if found.is_dark(ray.direction)
            && let Some(front) = self.front_at(ray, seed, found, meeting)
        {
            return Some(front);
        }
        Some((found, meeting))
    }

    /// Returns the front face back to back with a hit back face: at an equal position up to rounding, two one-sided
    /// surfaces represent the two sides of a surface. A ray hits the face towards its origin, whichever face is nearer
    /// by rounding or first in order. `None` without a front face.
    #[cold]
    #[inline(never)]
    fn front_at(
        &self,
        ray: &Ray,
        seed: u32,
        back: LocatedTriangle<'_>,
        meeting: TriangleHit,
    ) -> Option<(LocatedTriangle<'_>, TriangleHit)> {
        let normal = back.front().try_normalize()?;
        let there = ray.origin + ray.direction * meeting.distance;
        let beyond = self.exactness.at(there) / normal.dot(ray.direction).max(FLATTEST);
        let max_distance = (meeting.distance + beyond).min(ray.max_distance);
        let (front, meeting) = self.nearest_seen(&Ray { max_distance, ..*ray }, seed)?;
        let is_opposite = front.front().try_normalize()?.dot(normal) < -OPPOSITE;
        is_opposite.then_some((front, meeting))
    }

    /// Returns the nearest triangle seen by a camera along the ray, and the hit.
    #[inline]
    fn nearest_seen(&self, ray: &Ray, seed: u32) -> Option<(LocatedTriangle<'_>, TriangleHit)> {
        let line = LocalRay { origin: ray.origin, direction: ray.direction };
        let alone = self.static_blas.nearest_seen(&self.surfaces, &line, ray.max_distance, false, seed);
        self.with_copies(ray, seed, alone, Blas::nearest_seen)
    }

    /// Returns the nearest triangle, with the hit `alone` of the triangles without instances as input; `by` finds the
    /// nearest triangle of a model.
    #[inline]
    fn with_copies(
        &self,
        ray: &Ray,
        seed: u32,
        alone: Option<(usize, TriangleHit)>,
        by: impl Fn(&Blas, &[Surface], &LocalRay, f32, bool, u32) -> Option<(usize, TriangleHit)>,
    ) -> Option<(LocatedTriangle<'_>, TriangleHit)> {
        let line = LocalRay { origin: ray.origin, direction: ray.direction };
        if !self.instances.all.is_empty() {
            let limit = alone.map_or(ray.max_distance, |(_, meeting)| meeting.distance);
            let find = |copy: &Instance, line: &LocalRay, limit: f32, strictly: bool| {
                let model = &self.models[copy.model as usize];
                by(model, &self.surfaces, line, limit, strictly, copy.seed(seed))
            };
            if let Some((copy, triangle, meeting)) =
                self.instances.nearest(&line, limit, alone.is_some(), find)
            {
                return Some((self.of_copy(copy, triangle), meeting));
            }
        }
        alone.map(|(triangle, meeting)| {
            (LocatedTriangle { blas: &self.static_blas, triangle, copy: None }, meeting)
        })
    }

    #[inline]
    fn of_copy(&self, index: usize, triangle: usize) -> LocatedTriangle<'_> {
        let copy = &self.instances.all[index];
        LocatedTriangle { blas: &self.models[copy.model as usize], triangle, copy: Some(copy) }
    }

    /// Returns a primitive by number: first the triangles without instances, then copy after copy.
    #[inline]
    fn found(&self, primitive: u32) -> LocatedTriangle<'_> {
        if (primitive as usize) < self.static_blas.corners.len() {
            return LocatedTriangle { blas: &self.static_blas, triangle: primitive as usize, copy: None };
        }
        // The last copy with a first primitive at or before the number: a copy without triangles shares the first
        // primitive of the next copy.
        let index = self.instances.all.partition_point(|copy| copy.first_primitive <= primitive) - 1;
        self.of_copy(index, (primitive - self.instances.all[index].first_primitive) as usize)
    }
}

impl Surfaces for TriangleSurfaces {
    fn cast(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        let (found, meeting) = self.nearest(ray, seed)?;
        Some(self.shade(found, meeting, ray, false))
    }

    fn see(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        let (found, meeting) = self.nearest_seen(ray, seed)?;
        Some(self.shade(found, meeting, ray, true))
    }

    fn transmittance(&self, from: Vec3, to: Vec3) -> Vec3 {
        let offset = to - from;
        let length = offset.length();
        // A light may touch a surface: a surface at the light's position does not hide the light.
        let limit = length - self.exactness.near;
        if limit <= 0.0 {
            return Vec3::ONE;
        }
        let line = LocalRay { origin: from, direction: offset / length };
        let through =
            |blas: &Blas, line: &LocalRay, limit: f32| blas.transmittance(&self.surfaces, line, limit);
        let left = through(&self.static_blas, &line, limit);
        if left == Vec3::ZERO || self.instances.all.is_empty() {
            return left;
        }
        left * self.instances.product(&self.models, &line, limit, through)
    }

    fn tint(&self, ray: &Ray, distance: f32, from_eye: bool) -> Vec3 {
        if !self.has_glass {
            return Vec3::ONE;
        }
        let line = LocalRay { origin: ray.origin, direction: ray.direction };
        let tint =
            |blas: &Blas, line: &LocalRay, limit: f32| blas.tint(&self.surfaces, line, limit, from_eye);
        let alone = tint(&self.static_blas, &line, distance);
        alone * self.instances.product(&self.models, &line, distance, tint)
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        (self.low, self.high)
    }

    fn main_part(&self) -> (Vec3, Vec3) {
        self.main
    }

    fn epsilon(&self) -> f32 {
        self.exactness.near
    }

    #[inline]
    fn epsilon_at(&self, position: Vec3) -> f32 {
        self.exactness.at(position)
    }

    fn has_unlit(&self) -> bool {
        self.surfaces.iter().any(|surface| surface.is_unlit)
    }

    fn primitives(&self) -> Option<&dyn Primitives> {
        (self.primitives <= MOST_PRIMITIVES).then_some(self as &dyn Primitives)
    }

    fn emitters(&self) -> Option<&dyn Emitters> {
        // Beyond, numbers of primitives repeat.
        (self.primitives <= u64::from(u32::MAX)).then_some(self as &dyn Emitters)
    }
}
