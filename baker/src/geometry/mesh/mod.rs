//! Triangle meshes as [`Surfaces`]: a two-level BVH, one [BLAS](blas) for what is not instanced, one for each [instanced
//! mesh](crate::scene::Model), and a [TLAS](tlas) over the instances.
//!
//! obvhs builds the binary BVHs, [`bvh8`] collapses them. Boxes are padded by some rounding errors and the triangle test is
//! watertight, so traversal finds what brute force finds; a test holds that.
//!
//! * [`geometry`]: the input; `glass`: transmission and alpha; `triangle`: watertight ray/triangle test;
//! * `bvh8`, `blas`, `tlas`: acceleration structures; `packet`, `packet_traversal`: bundles of rays;
//! * `split`: large triangles cut up around the detail; `primitives`: triangles by number.

mod blas;
mod bvh8;
pub mod geometry;
pub(crate) mod glass;
#[cfg(target_arch = "x86_64")]
mod packet;
#[cfg(target_arch = "x86_64")]
mod packet_traversal;
mod primitives;
mod split;
#[cfg(test)]
mod tests;
mod tlas;
mod triangle;

pub use geometry::Geometry;

use crate::geometry::{Hit, Primitives, Ray, Surfaces};
use crate::scene::detail::Exactness;
use crate::scene::{Scene, SceneError, union};
use blas::{Blas, Line, TWO_SIDED};
use geometry::{Placed, Surface};
use glam::Vec3;
use rebounce_shared::baked::BakedScene;
use tlas::{Instance, Tlas};
use triangle::TriangleHit;

/// Faces whose normals are turned from each other by less than the angle of this cosine from opposite ones lie back to back.
const OPPOSITE: f32 = 0.9;
/// A ray counts as this steep at least (cosine of the angle to the normal) where distances along it are worked out.
const FLATTEST: f32 = 1e-3;
/// Boxes grow by this share of the diagonal, for the rounding of the box test.
const PADDING: f32 = 5e-7;
/// Primitives at most: what rays find is worked out beforehand only where there is room for it.
pub(crate) const MOST_PRIMITIVES: u64 = 1 << 25;

/// Triangles with textures and alpha.
pub struct TriangleSurfaces {
    /// What stands in the scene once.
    static_blas: Blas,
    models: Vec<Blas>,
    instances: Tlas,
    surfaces: Vec<Surface>,
    /// Whether some of them let light through in a colour.
    has_glass: bool,
    low: Vec3,
    high: Vec3,
    /// Corners of the part that has the detail.
    main: (Vec3, Vec3),
    exactness: Exactness,
    /// Triangles, each copy's counted.
    primitives: u64,
}

/// A triangle somewhere in the scene.
#[derive(Clone, Copy)]
struct Found<'a> {
    blas: &'a Blas,
    triangle: usize,
    /// The copy whose it is.
    copy: Option<&'a Instance>,
}

impl Found<'_> {
    /// A vector across it, on the side of its front, as long as twice its area, local space.
    #[inline]
    fn front(&self) -> Vec3 {
        let spanned = self.blas.front(self.triangle);
        self.copy.map_or(spanned, |copy| copy.across(spanned))
    }

    /// The shading normal at a place, by the shares of the corners, local space; zero where they cancel out.
    #[inline]
    fn normal(&self, [u, v, w]: [f32; 3]) -> Vec3 {
        let mut normals = self.blas.attributes[self.triangle].normals;
        if let Some(copy) = self.copy {
            normals = normals.map(|normal| copy.across(normal).normalize_or_zero());
        }
        (normals[0] * u + normals[1] * v + normals[2] * w).normalize_or_zero()
    }

    /// Whether a direction meets a back that does not reflect.
    #[inline]
    fn is_dark(&self, direction: Vec3) -> bool {
        self.front().dot(direction) > 0.0 && self.blas.marks[self.triangle] & TWO_SIDED == 0
    }

    /// A place of its model, local space.
    #[inline]
    fn place(&self, position: Vec3) -> Vec3 {
        self.copy.map_or(position, |copy| copy.place(position))
    }
}

impl TriangleSurfaces {
    /// Builds the hierarchy.
    pub fn new(mut geometry: Geometry) -> Self {
        let main = geometry.main_part();
        if let Some((low, high)) = main {
            split::split(&mut geometry, (high - low).length());
        }
        let bounds = geometry.model_bounds();
        let Geometry { triangles, models, colors, surfaces } = geometry;
        let end = models.first().map_or(triangles.len(), |model| model.triangles.start);
        let alone = (end > 0).then(|| geometry::bounds(&triangles[..end]));
        let boxes = models.iter().zip(&bounds).flat_map(|(model, bounds)| model.boxes(*bounds));
        let (low, high) = alone.into_iter().chain(boxes).reduce(union).unwrap_or_default();
        let main = main.unwrap_or((low, high));
        let diagonal = (high - low).length();
        let padding = PADDING * diagonal;
        let blas = |range: std::ops::Range<usize>, padding: f32| {
            let colors = colors.get(range.clone()).unwrap_or_default();
            Blas::new(&triangles[range.clone()], colors, range.start as u32, &surfaces, padding)
        };
        let primitives = |model: &Placed| model.triangles.len() as u64 * model.local_from_model.len() as u64;
        Self {
            static_blas: blas(0..end, padding),
            instances: Tlas::new(&models, &bounds, padding, end as u64),
            primitives: end as u64 + models.iter().map(primitives).sum::<u64>(),
            models: (models.iter())
                .map(|model| blas(model.triangles.clone(), Tlas::padding(model, padding)))
                .collect(),
            has_glass: surfaces.iter().any(|surface| surface.glass.is_some()),
            surfaces,
            low,
            high,
            main,
            exactness: Exactness::new(main, (low, high)),
        }
    }

    /// The surfaces of a loaded scene.
    pub fn from_scene(scene: &Scene) -> Self {
        Self::new(Geometry::from(scene))
    }

    /// The surfaces of a loaded scene, of as few triangles as they need.
    pub fn simplified(scene: &Scene) -> Self {
        Self::new(Geometry::simplified(scene))
    }

    /// The surfaces of a baked file.
    ///
    /// # Errors
    /// [`SceneError::Texture`] where a picture cannot be decoded.
    pub fn from_baked(scene: &BakedScene) -> Result<Self, SceneError> {
        Ok(Self::new(Geometry::try_from(scene)?))
    }

    /// Number of triangles, those of a model counted once.
    pub fn triangle_count(&self) -> usize {
        self.static_blas.corners.len() + self.models.iter().map(|model| model.corners.len()).sum::<usize>()
    }

    /// Number of triangles, those of each copy of a model counted.
    pub fn piece_count(&self) -> u64 {
        self.primitives
    }

    /// Whether pictures show some of them as they are.
    pub fn has_unlit(&self) -> bool {
        self.surfaces.iter().any(|surface| surface.is_unlit)
    }

    fn shade(&self, found: Found, m: TriangleHit, ray: &Ray) -> Hit {
        let direction = ray.direction;
        let Found { blas, triangle, .. } = found;
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
        Hit { distance: m.distance, position, geometric_normal, normal, albedo, emission, is_unlit }
    }

    /// Where a ray meets the nearest surface, and nothing about it: what of [`Surfaces::cast`] is the walk through the
    /// hierarchy.
    #[inline]
    pub fn distance(&self, ray: &Ray, seed: u32) -> Option<f32> {
        self.nearest(ray, seed).map(|(_, meeting)| meeting.distance)
    }

    /// The nearest triangle that stops the ray.
    #[inline]
    fn nearest(&self, ray: &Ray, seed: u32) -> Option<(Found<'_>, TriangleHit)> {
        let line = Line { origin: ray.origin, direction: ray.direction };
        let alone = self.static_blas.nearest(&self.surfaces, &line, ray.max_distance, false, seed);
        self.with_all(ray, seed, alone)
    }

    /// The same, where of the triangles that stand alone it is known.
    #[inline]
    fn with_all(
        &self,
        ray: &Ray,
        seed: u32,
        alone: Option<(usize, TriangleHit)>,
    ) -> Option<(Found<'_>, TriangleHit)> {
        let (found, meeting) = self.with_copies(ray, seed, alone, Blas::nearest)?;
        if found.is_dark(ray.direction)
            && let Some(front) = self.front_at(ray, seed, found, meeting)
        {
            return Some(front);
        }
        Some((found, meeting))
    }

    /// The face that lies back to back with one whose back was found: at the same place but for rounding, where two
    /// one-sided surfaces stand for the two sides of one. Whichever of the two is nearer by rounding, or comes first, a ray
    /// finds the one that faces it.
    #[cold]
    #[inline(never)]
    fn front_at(
        &self,
        ray: &Ray,
        seed: u32,
        back: Found<'_>,
        meeting: TriangleHit,
    ) -> Option<(Found<'_>, TriangleHit)> {
        let normal = back.front().try_normalize()?;
        let there = ray.origin + ray.direction * meeting.distance;
        let beyond = self.exactness.at(there) / normal.dot(ray.direction).max(FLATTEST);
        let max_distance = (meeting.distance + beyond).min(ray.max_distance);
        let (front, meeting) = self.nearest_seen(&Ray { max_distance, ..*ray }, seed)?;
        let is_opposite = front.front().try_normalize()?.dot(normal) < -OPPOSITE;
        is_opposite.then_some((front, meeting))
    }

    /// The nearest triangle that a camera sees along the ray.
    #[inline]
    fn nearest_seen(&self, ray: &Ray, seed: u32) -> Option<(Found<'_>, TriangleHit)> {
        let line = Line { origin: ray.origin, direction: ray.direction };
        let alone = self.static_blas.nearest_seen(&self.surfaces, &line, ray.max_distance, false, seed);
        self.with_copies(ray, seed, alone, Blas::nearest_seen)
    }

    /// The nearest triangle, where of those that stand alone it is known; in a model it is found `by` this.
    #[inline]
    fn with_copies(
        &self,
        ray: &Ray,
        seed: u32,
        alone: Option<(usize, TriangleHit)>,
        by: impl Fn(&Blas, &[Surface], &Line, f32, bool, u32) -> Option<(usize, TriangleHit)>,
    ) -> Option<(Found<'_>, TriangleHit)> {
        let line = Line { origin: ray.origin, direction: ray.direction };
        if !self.instances.all.is_empty() {
            let limit = alone.map_or(ray.max_distance, |(_, meeting)| meeting.distance);
            let find = |copy: &Instance, line: &Line, limit: f32, strictly: bool| {
                let model = &self.models[copy.model as usize];
                by(model, &self.surfaces, line, limit, strictly, copy.seed(seed))
            };
            if let Some((copy, triangle, meeting)) =
                self.instances.nearest(&line, limit, alone.is_some(), find)
            {
                return Some((self.of_copy(copy, triangle), meeting));
            }
        }
        alone.map(|(triangle, meeting)| (Found { blas: &self.static_blas, triangle, copy: None }, meeting))
    }

    #[inline]
    fn of_copy(&self, index: usize, triangle: usize) -> Found<'_> {
        let copy = &self.instances.all[index];
        Found { blas: &self.models[copy.model as usize], triangle, copy: Some(copy) }
    }

    /// A primitive by number: those that stand alone first, then copy after copy.
    #[inline]
    fn found(&self, primitive: u32) -> Found<'_> {
        if (primitive as usize) < self.static_blas.corners.len() {
            return Found { blas: &self.static_blas, triangle: primitive as usize, copy: None };
        }
        // The last one that begins there or before: one without triangles begins where the next does.
        let index = self.instances.all.partition_point(|copy| copy.first_primitive <= primitive) - 1;
        self.of_copy(index, (primitive - self.instances.all[index].first_primitive) as usize)
    }
}

impl Surfaces for TriangleSurfaces {
    fn cast(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        let (found, meeting) = self.nearest(ray, seed)?;
        Some(self.shade(found, meeting, ray))
    }

    fn see(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        let (found, meeting) = self.nearest_seen(ray, seed)?;
        Some(self.shade(found, meeting, ray))
    }

    fn transmittance(&self, from: Vec3, to: Vec3) -> Vec3 {
        let offset = to - from;
        let length = offset.length();
        // A light may touch a surface: what is there does not hide it.
        let limit = length - self.exactness.near;
        if limit <= 0.0 {
            return Vec3::ONE;
        }
        let line = Line { origin: from, direction: offset / length };
        let through = |blas: &Blas, line: &Line, limit: f32| blas.transmittance(&self.surfaces, line, limit);
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
        let line = Line { origin: ray.origin, direction: ray.direction };
        let tint = |blas: &Blas, line: &Line, limit: f32| blas.tint(&self.surfaces, line, limit, from_eye);
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

    fn primitives(&self) -> Option<&dyn Primitives> {
        (self.primitives <= MOST_PRIMITIVES).then_some(self as &dyn Primitives)
    }
}
