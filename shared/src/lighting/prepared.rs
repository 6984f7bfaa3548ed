//! An environment prepared for lighting.

use crate::environment::bins::{BINS, project};
use crate::environment::packed::MAX_WIDTH;
#[cfg(feature = "radiosity")]
use crate::environment::reflection::Reflection;
use crate::environment::{Environment, Sun, extract_sun, world_from_environment};
use crate::light::{Light, LightSource};
use glam::Vec3;
use std::cell::OnceCell;
use std::sync::Arc;

/// Most pixels in a row from which bins are projected: as many as a file keeps, six in a bin's width.
const BINS_WIDTH: u32 = MAX_WIDTH;

/// An environment whose sun is taken out once, at the first use, and whose bins are projected once for a rotation.
#[derive(Clone, Debug)]
pub struct PreparedEnvironment {
    picture: Arc<Environment>,
    /// The picture without its sun, of at most [`BINS_WIDTH`] pixels in a row; and the sun.
    parts: OnceCell<(Environment, Option<Sun>)>,
    /// The bins of the last rotation, degrees.
    bins: Option<(f32, Box<[Vec3; BINS]>)>,
    /// What surfaces reflect of it.
    #[cfg(feature = "radiosity")]
    reflection: Arc<Reflection>,
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
        Self {
            #[cfg(feature = "radiosity")]
            reflection: Arc::new(Reflection::new(picture.clone())),
            picture,
            parts: OnceCell::new(),
            bins: None,
        }
    }

    /// The picture, with the sun.
    pub fn picture(&self) -> &Arc<Environment> {
        &self.picture
    }

    /// What surfaces reflect of it.
    #[cfg(feature = "radiosity")]
    pub fn reflection(&self) -> &Arc<Reflection> {
        &self.reflection
    }

    fn parts(&self) -> &(Environment, Option<Sun>) {
        self.parts.get_or_init(|| {
            let (rest, sun) = extract_sun(&self.picture);
            (rest.coarse(BINS_WIDTH), sun)
        })
    }

    /// Mean radiance of the [bins](crate::environment::bins) without the sun, world directions.
    pub fn bins(&mut self, rotation_deg: f32) -> &[Vec3; BINS] {
        let kept = self.bins.take().filter(|(of, _)| *of == rotation_deg);
        let bins = kept.unwrap_or_else(|| (rotation_deg, Box::new(project(&self.parts().0, rotation_deg))));
        &self.bins.insert(bins).1
    }

    /// The sun as a directional light; `None` without one.
    pub fn sun(&self, rotation_deg: f32, factor: Vec3) -> Option<LightSource> {
        let sun = self.parts().1.as_ref()?;
        let light = Light::Directional {
            direction: (-world_from_environment(sun.direction, rotation_deg)).as_dvec3().to_array(),
            intensity: 1.0,
            color: (factor * sun.irradiance).as_dvec3().to_array(),
            radius_deg: f64::from(sun.radius_deg),
        };
        Some(light.source([0.0; 3]))
    }
}
