//! Reflections of glossy surfaces: light that arrives at their points, and what pictures show of it.

use super::Renderer;
use super::target::Target;
use crate::passes::reflections::DistantLight;
use crate::scene::GpuScene;
use rebounce_shared::gloss::distant_light;
use rebounce_shared::lighting::Background;

impl Renderer {
    /// Applies the glossy transfer after a change of the lights.
    pub(super) fn update_gloss(&mut self, encoder: &mut wgpu::CommandEncoder, scene: &GpuScene) {
        if let Some((gloss, kernels)) = scene.reflecting().zip(self.pipelines.gloss.get()) {
            let lighting = &self.lit.lighting;
            let light = distant_light(&gloss.layout, lighting);
            gloss.light(&self.gpu, encoder, kernels, &light, &lighting.emission);
        }
    }

    /// Draws the reflections of a picture; no effect without glossy transfer.
    pub(super) fn draw_reflections(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &GpuScene,
        target: &Target,
    ) {
        let Some((gloss, to)) = scene.reflecting().zip(target.reflections.as_ref()) else { return };
        let scale = self.lit.sky.as_ref().map_or(0.0, |sky| sky.reflected().scale);
        let sky = |of: &Background| (of.factor * scale).extend(of.rotation_deg.to_radians()).to_array();
        let skies: Vec<[f32; 4]> = self.lit.lighting.background.iter().map(sky).collect();
        let coefficients = match gloss.layout.has_direct {
            true => self.lit.lighting.sky_coefficients(),
            false => Default::default(),
        };
        let light = DistantLight { skies: &skies, coefficients: &coefficients, conductors: self.conductors };
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
