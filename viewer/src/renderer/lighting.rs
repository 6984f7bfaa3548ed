//! The lights of the renderer: lamps, the sky with its sun, and the strength of emissive surfaces.

use super::Renderer;
use crate::error::ViewerError;
use crate::gpu::MAX_LAYERS;
use crate::passes::shadow::fit::most_layers;
use crate::scene::GpuScene;
use crate::scene::sky::Sky;
#[cfg(feature = "radiosity")]
use rebounce_shared::diffuse_transfer::DistantLight;
use rebounce_shared::environment::PackedEnvironment;
use rebounce_shared::glam::Vec3;
use rebounce_shared::light::{Light, LightKind, LightSource};
use rebounce_shared::light_group::group_strengths;
use rebounce_shared::lighting::{Lighting, PreparedEnvironment};
use rebounce_shared::mix::{Channel, mixed};

/// Lights, as evaluated.
#[derive(Default)]
pub(super) struct Lit {
    /// World space.
    lights: Vec<Light>,
    /// Channels of the mixer, by the lights' places.
    mix: Vec<Channel>,
    /// The lights as the mix has them, prepared; lamps are in [parts](LightSource::parts).
    pub(super) lighting: Lighting,
    /// The environment of environment lights; made for the first of them.
    pub(super) sky: Option<Sky>,
    /// Whether the environment was [set](Renderer::set_environment): otherwise it is the file's.
    is_own: bool,
    /// Blur of the background, 0 to 1.
    pub(super) blur: f32,
    /// Factors of emission on the GPU.
    emission: Vec<Vec3>,
}

impl Lit {
    /// Lamps and area lights, with the sun of the environment.
    pub(super) fn lamps(&self) -> &[LightSource] {
        &self.lighting.lamps
    }
}

impl Renderer {
    /// The lights, world space.
    pub fn lights(&self) -> &[Light] {
        &self.lit.lights
    }

    /// Replaces the lights.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`] for numbers that are not finite, negative intensities, too many lights for the
    /// shadow maps, or a light that is not in its place in a fixed solution.
    pub fn set_lights(&mut self, lights: Vec<Light>) -> Result<(), ViewerError> {
        // By their numbers, of which absent ones are not equal to themselves.
        let is_same = |(a, b): (&Light, &Light)| {
            let (a, b) = (a.numbers(), b.numbers());
            bytemuck::bytes_of(&a) == bytemuck::bytes_of(&b)
        };
        if self.lit.lights.len() == lights.len() && self.lit.lights.iter().zip(&lights).all(is_same) {
            return Ok(());
        }
        self.light(lights)
    }

    /// Sets the mix: a channel a light, in the lights' order; a light without one is as it is.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`] for a channel that SHOT.json may not have; the mix stays then.
    pub fn set_mix(&mut self, mix: Vec<Channel>) -> Result<(), ViewerError> {
        if !mix.iter().all(Channel::is_usable) {
            return Err(ViewerError::BadArgument("mix: stops or colours are out of range".into()));
        }
        self.lit.mix = mix;
        self.light(self.lit.lights.clone())
    }

    /// Sets the picture of environment lights; `None` for the file's own.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`] if its sun is one light too many for the shadow maps, or for a fixed solution, which
    /// has its own; nothing changes then.
    pub fn set_environment(&mut self, picture: Option<PackedEnvironment>) -> Result<(), ViewerError> {
        let is_own = picture.is_some();
        if is_own && self.scene.as_ref().is_some_and(|scene| scene.relight.is_solved()) {
            return Err(ViewerError::BadArgument("environment: the file was solved for its own sky".into()));
        }
        let sky = picture.map(|picture| Sky::new(&self.gpu, picture));
        let before = (std::mem::replace(&mut self.lit.sky, sky), self.lit.is_own);
        self.lit.is_own = is_own;
        let lit = self.light(self.lit.lights.clone());
        if lit.is_err() {
            (self.lit.sky, self.lit.is_own) = before;
        }
        self.target = None;
        lit
    }

    /// Sets the blur of the background, 0 to 1.
    pub fn set_background_blur(&mut self, blur: f32) {
        let blur = if blur > 0.0 { blur.min(1.0) } else { 0.0 };
        self.dirty.shade |= self.lit.blur != blur;
        self.lit.blur = blur;
    }

    /// Starts with the lights of a scene.
    pub(super) fn light_scene(&mut self) {
        // A fixed solution shows its own sky.
        self.lit.is_own &= self.scene.as_ref().is_none_or(|scene| !scene.relight.is_solved());
        if !self.lit.is_own {
            self.lit.sky = None;
        }
        self.lit.emission.clear();
        self.lit.mix.clear();
        // A file may hold more lights than shadow maps are possible; the first lamps are on.
        let mut lights = self.scene.as_ref().map_or(Vec::new(), |scene| scene.meta.lights.clone());
        let mut lamps = 0;
        lights.retain(|light| {
            lamps += light.kind().is_lamp() as u32;
            !light.kind().is_lamp() || lamps <= MAX_LAYERS
        });
        while self.light(lights.clone()).is_err() {
            let last = lights.iter().rposition(|light| light.kind().is_lamp());
            lights.remove(last.unwrap_or(lights.len() - 1));
        }
    }

    /// Prepares lights and takes them over, if they can be drawn.
    fn light(&mut self, lights: Vec<Light>) -> Result<(), ViewerError> {
        for (i, light) in lights.iter().enumerate() {
            let intensity = light.source([0.0; 3]).intensity;
            if !light.is_usable() || intensity.min_element() < 0.0 || light.size() < 0.0 {
                return Err(ViewerError::BadArgument(format!(
                    "light {i}: all numbers must be finite, intensity, colour and radius not negative"
                )));
            }
        }
        let (origin, groups) =
            self.scene.as_ref().map_or(([0.0; 3], 0), |s| (s.meta.origin, s.sources.groups.len()));
        let has_sky = lights.iter().any(|light| light.kind() == LightKind::Environment);
        if has_sky && self.lit.sky.is_none() {
            let file = self.scene.as_ref().map_or(&[][..], |scene| &scene.sources.environment);
            self.lit.sky = Some(Sky::of_file(&self.gpu, file));
            self.target = None;
        }
        let mut none = PreparedEnvironment::default();
        let environment = self.lit.sky.as_mut().map_or(&mut none, |sky| &mut sky.prepared);
        let heard = mixed(&lights, &self.lit.mix);
        let mut lighting = Lighting::prepared(&heard, environment, origin, groups);
        if let Some(solved) = self.scene.as_ref().and_then(|scene| scene.solved_lights()) {
            lighting.groups = group_strengths(solved, &heard)?;
        }
        lighting.lamps = lighting.lamps.into_iter().flat_map(LightSource::parts).collect();
        let layers: u32 = lighting.lamps.iter().map(most_layers).sum();
        if layers > MAX_LAYERS {
            return Err(ViewerError::BadArgument(format!(
                "{} lights need {layers} shadow maps, there can be {}: a point, sphere, disk or spot wider than 60° needs six, a rectangle six to 24, a sun up to five, others one",
                lights.len(),
                MAX_LAYERS
            )));
        }
        self.dirty.lights = true;
        self.dirty.key = true;
        (self.lit.lights, self.lit.lighting) = (lights, lighting);
        Ok(())
    }

    /// Strengths of the scene's sources: of the sky and of emissive surfaces.
    #[cfg(feature = "guest")]
    pub fn source_strengths(&self) -> Vec<Vec3> {
        let lighting = &self.lit.lighting;
        self.scene
            .as_ref()
            .map_or(Vec::new(), |scene| scene.sources.strengths(lighting.sky.as_deref(), &lighting.emission))
    }

    /// Sets strengths of sources and emission on the GPU; returns whether anything shines.
    pub(super) fn light_sources(&mut self, scene: &GpuScene) -> bool {
        let lighting = &self.lit.lighting;
        if self.lit.emission != lighting.emission {
            scene.materials.set_emission(&self.gpu, &lighting.emission);
            self.lit.emission = lighting.emission.clone();
        }
        if !scene.relight.has_sources() {
            return false;
        }
        #[cfg(feature = "radiosity")]
        if scene.relight.is_for_environment() {
            let light = DistantLight::new(lighting);
            let shines = !light.is_dark();
            scene.relight.set_distant(&self.gpu, light);
            return shines;
        }
        let strengths = match scene.relight.is_solved() {
            true => lighting.groups.clone(),
            false => scene.sources.strengths(lighting.sky.as_deref(), &lighting.emission),
        };
        scene.relight.set_strengths(&self.gpu, &strengths);
        #[cfg(feature = "radiosity")]
        if let Some(lightmap) = &scene.lightmap {
            lightmap.set_strengths(&self.gpu, &strengths, self.parts);
        }
        strengths.iter().any(|strength| *strength != Vec3::ZERO)
    }
}
