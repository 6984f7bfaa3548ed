//! An environment prepared for lighting.

use crate::environment::bins::{BINS, Projection};
use crate::environment::{Environment, Sun, extract_sun, world_from_environment};
use crate::light::{Light, LightSource};
use glam::Vec3;
use std::cell::OnceCell;
use std::sync::Arc;

/// An environment whose sun is taken out once, at the first use, and whose pixels' bins are found once, for any rotation.
#[derive(Clone, Debug)]
pub struct PreparedEnvironment {
    picture: Arc<Environment>,
    /// The picture without its sun, and the sun; `None` for a picture without.
    parts: OnceCell<Option<(Environment, Sun)>>,
    /// From the picture's pixels to bins.
    projection: OnceCell<Projection>,
    /// The bins of the last rotation, degrees.
    bins: Option<(f32, Box<[Vec3; BINS]>)>,
}

impl Default for PreparedEnvironment {
    /// An even white.
    fn default() -> Self {
        Self::new(Arc::new(Environment::constant(Vec3::ONE)))
    }
}

impl PreparedEnvironment {
    /// Keeps the picture; nothing is computed yet.
    pub fn new(picture: Arc<Environment>) -> Self {
        Self { picture, parts: OnceCell::new(), projection: OnceCell::new(), bins: None }
    }

    /// The picture, with the sun.
    pub fn picture(&self) -> &Arc<Environment> {
        &self.picture
    }

    fn parts(&self) -> Option<&(Environment, Sun)> {
        let take = || match extract_sun(&self.picture) {
            (rest, Some(sun)) => Some((rest, sun)),
            _ => None,
        };
        self.parts.get_or_init(take).as_ref()
    }

    /// Mean radiance of the [bins](crate::environment::bins) without the sun, world directions.
    pub fn bins(&mut self, rotation_deg: f32) -> &[Vec3; BINS] {
        let kept = self.bins.take().filter(|(of, _)| *of == rotation_deg);
        let project = || {
            let rest = self.parts().map_or(&*self.picture, |(rest, _)| rest);
            let projection = self.projection.get_or_init(|| Projection::new(rest.width, rest.height));
            (rotation_deg, Box::new(projection.project(rest, rotation_deg)))
        };
        let bins = kept.unwrap_or_else(project);
        &self.bins.insert(bins).1
    }

    /// The sun as a directional light; `None` without one.
    pub fn sun(&self, rotation_deg: f32, factor: Vec3) -> Option<LightSource> {
        let (_, sun) = self.parts()?;
        let light = Light::Directional {
            direction: (-world_from_environment(sun.direction, rotation_deg)).as_dvec3().to_array(),
            intensity: 1.0,
            color: (factor * sun.irradiance).as_dvec3().to_array(),
            radius_deg: f64::from(sun.radius_deg),
        };
        Some(light.source([0.0; 3]))
    }
}
