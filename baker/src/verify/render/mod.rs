//! CPU reference renderer of a baked file: the expected output of the viewer.
//!
//! Direct light is sampled, of lamps as points, at the file's points with ray-cast visibility, the operator is
//! applied ([`rebounce_shared::relight`]), and at every visible point the display basis is
//! evaluated exactly: `E(x, n) = max(0, n · Σ w_j V_j / Σ w_j)` (paper, Eq. 6 and 8), reflected
//! with albedo / π.

pub mod backdrop;
pub mod shown;
pub mod unlit;

use crate::basis::{Evaluator, Leveled, Support};
use crate::geometry::with_lights::WithLights;
use crate::geometry::{Hit, Ray, Surfaces};
use crate::io::picture::{Only, Picture};
use crate::light::direct;
use crate::random::Stream;
use crate::sampling::open_share;
use crate::verify::expose::{Exposure, expose};
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::{Light, LightSource};
use rebounce_shared::openness::{REACH, gain, received};
use rebounce_shared::relight;
use std::f32::consts::FRAC_1_PI;

/// Contents of a rendering.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Content {
    /// Components of light.
    pub only: Only,
    /// Whether bounced light is modulated by the openness of the visible surface.
    pub detail: bool,
}

impl From<Only> for Content {
    /// With detail.
    fn from(only: Only) -> Self {
        Self { only, detail: true }
    }
}

/// A baked scene, relit by given lights.
pub struct Relit {
    lights: Vec<LightSource>,
    /// Bounced irradiance of every point along the point's normal.
    irradiance: Vec<Vec3>,
    basis: Leveled,
    /// Radius of a pixel's openness, scene units; `None` without detail.
    reach: Option<f32>,
}

/// Rows and columns of the openness rays of a sample.
const OPENNESS_SIDE: u32 = 2;

impl Relit {
    /// Relights `scene`. `surfaces` must be the surfaces of the same file, with the area lights among them: here and in
    /// every query ([`WithLights`]). With `detail`, light between the points
    /// follows the [openness](rebounce_shared::openness) of visible surfaces, if the file has the openness of the
    /// points.
    pub fn new(scene: &BakedScene, surfaces: &impl Surfaces, lights: &[Light], detail: bool) -> Self {
        let lights: Vec<LightSource> = lights.iter().map(|l| l.source(scene.meta.origin)).collect();
        let irradiance: Vec<Vec3> = scene.points[..scene.direct_count()]
            .par_iter()
            .map(|point| direct::at_footprint(surfaces, &lights, point))
            .collect();
        let mut irradiance = relight::relight(scene, irradiance);
        let finest = scene.meta.levels.last().map_or(0.0, |level| level.support_radius);
        let reach = (detail && !scene.openness.is_empty()).then_some(REACH * finest);
        if reach.is_some() {
            irradiance.iter_mut().zip(&scene.openness).for_each(|(e, open)| *e *= gain(*open));
        }
        let level = |l: usize| {
            let range = scene.level(l);
            let support = |i: usize| {
                let p = &scene.points[i];
                Support {
                    position: p.position(),
                    normal: p.normal(),
                    radius: p.radius,
                    cuts: scene.cuts_of(i),
                }
            };
            Evaluator::new(range.clone().map(support), range.start as u32)
        };
        let basis = Leveled::new((0..scene.meta.levels.len()).map(level).collect());
        Self { lights, irradiance, basis, reach }
    }

    /// Interpolates the points' light at a surface element, RGB, local space: without detail, the irradiance of the
    /// bounced light. Zero where no function of any level covers the position.
    pub fn interpolated(&self, position: Vec3, normal: Vec3) -> Vec3 {
        let mut weights = Vec::with_capacity(64);
        self.basis.interpolate(position, normal, &mut weights);
        let sum: Vec3 =
            weights.iter().map(|(index, weight)| self.irradiance[*index as usize] * *weight).sum();
        sum.max(Vec3::ZERO)
    }

    /// RGB irradiance of the bounced light at a ray hit.
    pub fn indirect(&self, surfaces: &impl Surfaces, hit: &Hit, stream: &mut Stream) -> Vec3 {
        let open = |reach| {
            let normals = [hit.normal, hit.geometric_normal];
            received(open_share(surfaces, hit.position, normals, reach, OPENNESS_SIDE, stream))
        };
        self.interpolated(hit.position, hit.normal) * self.reach.map_or(1.0, open)
    }

    /// Linear RGB radiance along `ray`, toward its origin.
    pub fn radiance(&self, surfaces: &impl Surfaces, ray: &Ray, only: Only, stream: &mut Stream) -> Vec3 {
        let Some(hit) = surfaces.see(ray, stream.bits() as u32) else {
            return Vec3::ZERO;
        };
        let tint = surfaces.tint(ray, hit.distance, true);
        if hit.is_unlit {
            return if only == Only::All { tint * hit.emission } else { Vec3::ZERO };
        }
        let mut irradiance = Vec3::ZERO;
        if hit.albedo != Vec3::ZERO {
            if only != Only::Indirect {
                irradiance += direct::toward_hit(surfaces, &self.lights, &hit, stream);
            }
            if only != Only::Direct {
                irradiance += self.indirect(surfaces, &hit, stream);
            }
        }
        let emission = if only == Only::Indirect { Vec3::ZERO } else { hit.emission };
        tint * (hit.albedo * FRAC_1_PI * irradiance + emission)
    }
}

/// Renders a baked scene, and the area lights among its surfaces. `row_done` is called after each row, from any thread.
pub fn render(
    scene: &BakedScene,
    surfaces: &impl Surfaces,
    camera: &Camera,
    lights: &[Light],
    exposure: Exposure,
    content: impl Into<Content>,
    row_done: impl Fn() + Sync,
) -> Picture {
    let Content { only, detail } = content.into();
    let sources: Vec<LightSource> = lights.iter().map(|light| light.source(scene.meta.origin)).collect();
    let surfaces = &WithLights::new(surfaces, &sources);
    let relit = Relit::new(scene, surfaces, lights, detail);
    let radiance = |ray: &Ray, stream: &mut Stream| relit.radiance(surfaces, ray, only, stream);
    expose(&camera.frame(scene.meta.origin), exposure, radiance, row_done)
}
