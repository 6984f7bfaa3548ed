//! Bidirectional scattering distribution function (BSDF) of a hit: how much light a surface reflects from each direction to
//! the eye, and samples of the directions.
//!
//! It is a colour times a function of the light's direction, [`Bsdf::over_lambertian`], which is 1 for a Lambertian surface.
//! Metals are GGX conductors where a picture has gloss ([`ggx`]). Their reflectance is the hit's albedo at every angle, and
//! what they scatter more than once is given back. All other surfaces are Lambertian.

use crate::geometry::Hit;
use crate::random::Stream;
use glam::{Mat3, Vec2, Vec3};
use rebounce_shared::footprint::tangents;
use rebounce_shared::ggx;
use std::f32::consts::{FRAC_1_PI, PI};

/// Least cosine between the shading normal and the eye: interpolated normals may point away from an eye that sees the
/// surface.
const LEAST_COSINE: f32 = 1e-3;

/// How a hit reflects light to an eye.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    /// Linear RGB factor of all directions: the hit's albedo, and of a conductor the light that it scatters more than once.
    pub albedo: Vec3,
    normal: Vec3,
    /// `None` for a Lambertian surface.
    conductor: Option<Conductor>,
}

/// The lobe of a metal.
#[derive(Clone, Copy, Debug)]
struct Conductor {
    alpha: f32,
    /// Local space from the surface's frame, whose z is the shading normal.
    local_from_frame: Mat3,
    /// The surface's frame, above its horizon.
    to_eye: Vec3,
    /// On the eye's side. Light from below does not pass.
    geometric_normal: Vec3,
}

/// A direction that light comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Unit vector, local space.
    pub to_light: Vec3,
    /// Reflectance times cosine over the density, without [`Bsdf::albedo`].
    pub weight: f32,
    /// Density of the direction, per steradian.
    pub density: f32,
}

impl Bsdf {
    /// Returns the BSDF of a hit for the unit vector to the eye; with `gloss`, metals are conductors.
    pub fn new(hit: &Hit, to_eye: Vec3, gloss: bool) -> Self {
        let (albedo, normal) = (hit.albedo, hit.normal);
        if !(gloss && hit.gloss.is_metal()) {
            return Self { albedo, normal, conductor: None };
        }
        let (right, up) = tangents(normal);
        let local_from_frame = Mat3::from_cols(right, up, normal);
        let to_eye = above_horizon(local_from_frame.transpose() * to_eye);
        let single = ggx::single_scattering(hit.gloss.roughness, to_eye.z);
        let (alpha, geometric_normal) = (ggx::alpha(hit.gloss.roughness), hit.geometric_normal);
        Self {
            albedo: albedo * ggx::multiple_scattering(albedo, single),
            normal,
            conductor: Some(Conductor { alpha, local_from_frame, to_eye, geometric_normal }),
        }
    }

    /// Returns the reflectance for light from a unit direction, linear RGB, per steradian and without the cosine.
    pub fn reflectance(&self, to_light: Vec3) -> Vec3 {
        self.albedo * (FRAC_1_PI * self.over_lambertian(to_light))
    }

    /// Returns the reflectance over that of a Lambertian surface of the colour [`Self::albedo`]: 1 for a Lambertian surface,
    /// which leaves the cosine to the caller; 0 for a conductor lit from below.
    #[inline]
    pub fn over_lambertian(&self, to_light: Vec3) -> f32 {
        let Some(conductor) = &self.conductor else { return 1.0 };
        let in_frame = |to_light| PI * ggx::reflectance(conductor.alpha, conductor.to_eye, to_light);
        conductor.lit_from(to_light).map_or(0.0, in_frame)
    }

    /// Returns the density of [`Self::sample`] at a unit direction, per steradian.
    #[inline]
    pub fn density(&self, to_light: Vec3) -> f32 {
        let Some(conductor) = &self.conductor else {
            return self.normal.dot(to_light).max(0.0) * FRAC_1_PI;
        };
        let in_frame = |to_light| ggx::sample_density(conductor.alpha, conductor.to_eye, to_light);
        conductor.lit_from(to_light).map_or(0.0, in_frame)
    }

    /// Samples the directions that light comes from, about as they count; `None` for a direction below a conductor.
    #[inline]
    pub fn sample(&self, stream: &mut Stream) -> Option<BsdfSample> {
        let Some(conductor) = &self.conductor else {
            let to_light = stream.cosine_hemisphere(self.normal);
            return Some(BsdfSample { to_light, weight: 1.0, density: self.density(to_light) });
        };
        let ggx::LobeSample { to_light, weight, density, .. } =
            ggx::sample(conductor.alpha, conductor.to_eye, stream.square());
        let to_light = (conductor.local_from_frame * to_light).normalize();
        let is_above = weight > 0.0 && conductor.geometric_normal.dot(to_light) > 0.0;
        is_above.then_some(BsdfSample { to_light, weight, density })
    }
}

impl Conductor {
    /// Returns a direction in the surface's frame; `None` below the surface or the horizon of the shading normal.
    #[inline]
    fn lit_from(&self, to_light: Vec3) -> Option<Vec3> {
        let in_frame = self.local_from_frame.transpose() * to_light;
        (in_frame.z > 0.0 && self.geometric_normal.dot(to_light) > 0.0).then_some(in_frame)
    }
}

/// Returns the unit vector to the eye, raised to [`LEAST_COSINE`]; surface frame.
fn above_horizon(to_eye: Vec3) -> Vec3 {
    if to_eye.z >= LEAST_COSINE {
        return to_eye;
    }
    let across = to_eye.truncate().normalize_or(Vec2::X);
    (across * (1.0 - LEAST_COSINE * LEAST_COSINE).sqrt()).extend(LEAST_COSINE)
}

#[cfg(test)]
mod tests;
