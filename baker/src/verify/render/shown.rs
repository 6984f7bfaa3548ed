//! Display pictures: exposed, tone-mapped, with unlit surfaces and the backdrop, as on the viewer's page.

use super::backdrop::backdrop;
use super::unlit::{developed, lit, unlit};
use crate::geometry::{Ray, Surfaces};
use crate::io::picture::{Only, Picture, png};
use crate::light::level::level;
use crate::verify::expose::Exposure;
use rebounce_shared::camera::CameraFrame;
use rebounce_shared::exposure::most;
use rebounce_shared::light::{LightKind, LightSource};
use rebounce_shared::rbn::shown::Ground;

/// Source and settings of a picture.
pub struct Shown<'a, S> {
    /// The surfaces.
    pub surfaces: &'a S,
    /// The camera.
    pub camera: &'a CameraFrame,
    /// Lights; they limit the exposure.
    pub lights: &'a [LightSource],
    /// Size, samples and seed.
    pub exposure: Exposure,
    /// Components of light shown.
    pub only: Only,
    /// The ground of an object that is shown before a backdrop.
    pub ground: Option<&'a Ground>,
}

impl<S: Surfaces> Shown<'_, S> {
    /// Converts a picture's radiance to display values, linear RGB from 0 to 1.
    pub fn picture(&self, radiance: &Picture) -> Picture {
        let exposed = |lit: &Picture| self.exposed(lit);
        let is_all = self.only == Only::All;
        let shown = if is_all && self.surfaces.has_unlit() {
            developed(radiance, &unlit(self.surfaces, self.camera, self.exposure), exposed)
        } else {
            png::developed(radiance, exposed(radiance))
        };
        match self.ground.filter(|_| is_all) {
            Some(ground) => shown.plus(&backdrop(self.surfaces, self.camera, self.exposure, ground)),
            None => shown,
        }
    }

    /// Returns the factor of a picture's radiance, as [`Self::picture`] takes it.
    pub fn exposure_factor(&self, radiance: &Picture) -> f32 {
        if self.only == Only::All && self.surfaces.has_unlit() {
            self.exposed(&lit(radiance, &unlit(self.surfaces, self.camera, self.exposure)))
        } else {
            self.exposed(radiance)
        }
    }

    /// Returns the automatic exposure of radiance without unlit surfaces.
    fn exposed(&self, lit: &Picture) -> f32 {
        // Measuring the light level casts shadow rays.
        let most = most(level(self.surfaces, self.lights));
        png::automatic_exposure(lit, most, |pixel| self.is_lit(pixel))
    }

    /// Whether the centre of a pixel shows a surface affected by light, or a sky: the page's exposure counts both.
    fn is_lit(&self, [x, y]: [u32; 2]) -> bool {
        let [width, height] = self.exposure.size;
        let direction = self.camera.direction(x as f32 + 0.5, y as f32 + 0.5, width, height);
        let ray = Ray::visibility(self.camera.eye, direction);
        let has_sky = self.lights.iter().any(|light| light.kind == LightKind::Environment);
        self.surfaces.see(&ray, 0).map_or(has_sky, |hit| !hit.is_unlit)
    }
}
