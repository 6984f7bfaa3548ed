//! Reflections of glossy surfaces: light that arrives at their points, and what pictures show of it.

use super::Renderer;
use super::target::Target;
use crate::passes::reflections::DistantLight;
use crate::scene::cube_maps::CubeMapLight;
use crate::scene::sky::Sky;
use crate::scene::{GpuScene, blended_fit};
use rebounce_shared::glam::Vec3;
use rebounce_shared::gloss::distant_light;

/// Most that emissive surfaces have in 16-bit floats, whose greatest is 65504: metals before them add to it.
const BRIGHT: f32 = 8192.0;

impl Renderer {
    /// Applies the glossy transfer after a change of the lights.
    pub(super) fn update_gloss(&mut self, encoder: &mut wgpu::CommandEncoder, scene: &GpuScene) {
        if let Some((gloss, kernels)) = scene.reflecting().zip(self.pipelines.gloss.get()) {
            let lighting = &self.lit.lighting;
            let light = distant_light(&gloss.layout, lighting);
            gloss.light(&self.gpu, encoder, kernels, &light, &lighting.emission);
            if let Some((maps, kernels)) = scene.cube_maps.as_ref().zip(kernels.cube_maps.get()) {
                let (skies, unit) = (self.reflected_skies(), self.map_unit(scene));
                let sky = self.lit.sky.as_ref().map(Sky::reflected);
                let buffers = [&scene.relight.display, &gloss.emission, &gloss.places, &gloss.arriving];
                let light = CubeMapLight { skies: &skies, sky, buffers, unit };
                maps.light(&self.gpu, encoder, kernels, &light);
            }
        }
    }

    /// Evaluates the lamps at what cube maps see, as at the points; `None` where no lamp is on.
    pub(super) fn light_cube_maps(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &GpuScene,
        lights: Option<&wgpu::BindGroup>,
    ) {
        match (&scene.cube_maps, lights) {
            (Some(maps), Some(lights)) => {
                let mut pass = encoder.begin_compute_pass(&Default::default());
                maps.direct.encode(&mut pass, &self.pipelines.relight, lights);
            }
            (Some(maps), None) => maps.direct.clear(encoder),
            _ => {}
        }
    }

    /// Factor of radiance in cube maps: that of blended surfaces, or less where emissive surfaces are far brighter, or the only
    /// light.
    fn map_unit(&self, scene: &GpuScene) -> f32 {
        let lighting = &self.lit.lighting;
        let emission = scene.gloss.iter().flat_map(|gloss| &gloss.layout.emission).zip(&lighting.emission);
        let brightest = emission
            .map(|(mean, factor)| (Vec3::from(*mean) * *factor).max_element())
            .fold(f32::MIN_POSITIVE, f32::max);
        let of_brightest = (BRIGHT / brightest).min(f32::MAX);
        match lighting.lamps.is_empty() && lighting.background.is_empty() {
            true => of_brightest,
            false => blended_fit::unit(&scene.meta, lighting, scene.extent.all).min(of_brightest),
        }
    }

    /// Factor of each reflected sky, and its rotation in radians.
    fn reflected_skies(&self) -> Vec<[f32; 4]> {
        self.skies(self.lit.sky.as_ref().map_or(0.0, |sky| sky.reflected().scale))
    }

    /// Draws the reflections of a picture; no effect without glossy transfer.
    pub(super) fn draw_reflections(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &GpuScene,
        target: &Target,
    ) {
        let Some((gloss, to)) = scene.reflecting().zip(target.reflections.as_ref()) else { return };
        let skies = self.reflected_skies();
        let coefficients = match gloss.layout.has_direct {
            true => self.lit.lighting.sky_coefficients(),
            false => Default::default(),
        };
        let light = DistantLight {
            skies: &skies,
            coefficients: &coefficients,
            conductors: self.conductors,
            map_unit: self.map_unit(scene),
        };
        self.pipelines.reflections.draw(&self.gpu, encoder, to, scene, gloss, &light);
    }

    /// Whether metals are GGX conductors of constant reflectance.
    pub fn conductors(&self) -> bool {
        self.conductors
    }

    /// Sets whether metals are GGX conductors of constant reflectance and nothing else shines, as SHOT.json's `gloss` has it.
    pub fn set_conductors(&mut self, on: bool) {
        self.dirty.display |= self.conductors != on;
        self.conductors = on;
    }
}
