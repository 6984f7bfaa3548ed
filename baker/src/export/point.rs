//! Light at a place of a surface, as [`render`](mod@crate::verify::render) has it.

use super::meshes::SurfaceTriangle;
use crate::geometry::mesh::TriangleSurfaces;
use crate::geometry::{Gloss, Hit, Ray, Surfaces};
use crate::io::picture::Only;
use crate::random::Stream;
use crate::verify::render::Relit;
use glam::{Vec2, Vec3, Vec4};
use std::f32::consts::FRAC_1_PI;

/// Rays that look whether a place is inside of something.
const PROBES: u32 = 4;
/// Number of the rays that meet a back, from which on the place is hidden.
const HIDDEN: u32 = 3;

/// What is taken of the light at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shading {
    /// Irradiance.
    Irradiance,
    /// Radiance: the base colour's share of the irradiance / π, and emission.
    Radiance,
    /// Radiance with the mean of the base-colour texture.
    MeanRadiance,
}

/// A place of a surface, local space.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceElement {
    position: Vec3,
    /// Unit shading normal, on the front.
    normal: Vec3,
    /// Unit normal of the front.
    geometric_normal: Vec3,
    uv: Vec2,
    /// Share of the texture that the place stands for.
    share: f32,
    material: u32,
    /// Reconstruction group.
    group: u32,
    /// Place in the file's lightmap, texels.
    lightmap: Option<Vec2>,
}

impl SurfaceElement {
    /// Returns the place at barycentric weights of a triangle, which stands for an `area` around it, square scene units;
    /// `None` on a triangle without an area.
    pub fn new(triangle: &SurfaceTriangle, weights: [f32; 3], area: f32) -> Option<Self> {
        let geometric_normal = triangle.front().try_normalize()?;
        let [a, b, c] = triangle.normals;
        let normal = (a * weights[0] + b * weights[1] + c * weights[2]).normalize_or(geometric_normal);
        let [p, q, r] = triangle.positions;
        let [s, t, u] = triangle.uvs;
        Some(Self {
            position: p * weights[0] + q * weights[1] + r * weights[2],
            normal: if normal.dot(geometric_normal) < 0.0 { -normal } else { normal },
            geometric_normal,
            uv: s * weights[0] + t * weights[1] + u * weights[2],
            share: triangle.share(area),
            material: triangle.material,
            group: triangle.group,
            lightmap: triangle.lightmap.map(|[p, q, r]| p * weights[0] + q * weights[1] + r * weights[2]),
        })
    }

    /// The place as a ray would meet it from the front.
    fn hit(&self) -> Hit {
        Hit {
            distance: 0.0,
            position: self.position,
            geometric_normal: self.geometric_normal,
            normal: self.normal,
            albedo: Vec3::ONE,
            emission: Vec3::ZERO,
            emitter: None,
            is_unlit: false,
            group: self.group,
            lightmap: self.lightmap,
            gloss: Gloss::MATT,
        }
    }
}

/// Surfaces under a light.
pub struct Lit<'a, S> {
    /// The surfaces.
    pub surfaces: &'a TriangleSurfaces,
    /// The surfaces with area lights among them.
    pub with_lights: &'a S,
    /// The light.
    pub relit: &'a Relit,
    /// Components of the light.
    pub only: Only,
    /// What is taken of it.
    pub shading: Shading,
}

impl<S: Surfaces> Lit<'_, S> {
    /// Returns the light at a place, linear RGB, and the surface's opacity; `None` at a place that nobody sees, inside
    /// of something. A single estimate.
    pub fn at(&self, point: &SurfaceElement, stream: &mut Stream) -> Option<Vec4> {
        let hit = point.hit();
        if self.is_hidden(&hit, stream) {
            return None;
        }
        let irradiance = self.relit.irradiance(self.with_lights, &hit, self.only, stream);
        let surface = self.surfaces.material(point.material);
        let share = match self.shading {
            Shading::Irradiance => return Some(irradiance.extend(1.0)),
            Shading::Radiance => point.share,
            // All of the texture.
            Shading::MeanRadiance => 1.0,
        };
        let albedo = surface.albedo(surface.color, point.uv, share);
        let emission = match self.only {
            Only::Indirect => Vec3::ZERO,
            _ => surface.shine(point.uv, share) * self.relit.emission_strength(point.material),
        };
        let radiance = albedo * FRAC_1_PI * irradiance + emission;
        Some(radiance.extend(surface.opacity(surface.color, point.uv)))
    }

    /// Returns whether most of the rays from a place meet backs that reflect nothing: of a floor, what stands under a
    /// block.
    fn is_hidden(&self, hit: &Hit, stream: &mut Stream) -> bool {
        let epsilon = self.surfaces.epsilon_at(hit.position);
        let (mut backs, mut others) = (0, 0);
        for _ in 0..PROBES {
            let direction = stream.cosine_hemisphere(hit.normal);
            let ray = Ray::visibility(hit.offset_origin(hit.geometric_normal, epsilon), direction);
            let met = self.surfaces.cast(&ray, stream.bits() as u32);
            let is_back = met.is_some_and(|met| !met.faces(direction));
            if is_back {
                backs += 1
            } else {
                others += 1
            }
            if backs == HIDDEN {
                return true;
            }
            if others > PROBES - HIDDEN {
                return false;
            }
        }
        false
    }
}
