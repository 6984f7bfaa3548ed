//! All light of a picture, prepared for evaluation on a baked scene: lamps, sky, and the strength of emissive surfaces.

mod prepared;

pub use prepared::PreparedEnvironment;

use crate::environment::bins::BINS;
#[cfg(feature = "radiosity")]
use crate::environment::reflection::{ReflectedSky, Reflection};
#[cfg(feature = "radiosity")]
use crate::environment::world_from_environment;
use crate::environment::{Environment, environment_from_world};
#[cfg(feature = "radiosity")]
use crate::harmonics::{COUNT, Coefficients, evaluate, rotation::Rotation};
#[cfg(feature = "radiosity")]
use crate::light::LightKind;
use crate::light::{Light, LightSource};
use crate::light_group::{MovedLight, group_strengths};
#[cfg(feature = "radiosity")]
use glam::Mat3;
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
    /// Factor of the emission of each [group](crate::rbn::sources::EmissiveGroup), linear RGB.
    pub emission: Vec<Vec3>,
    /// The sky behind the scene, one for each environment light.
    pub background: Vec<Background>,
    /// Strength of each [group of light](crate::rbn::light_groups), linear RGB; empty for files whose lights move.
    pub groups: Vec<Vec3>,
}

/// An environment as seen behind a scene.
#[derive(Clone, Debug)]
pub struct Background {
    /// Radiance, with the sun.
    pub environment: Arc<Environment>,
    /// Rotation about the y axis, degrees.
    pub rotation_deg: f32,
    /// Factor, linear RGB.
    pub factor: Vec3,
    /// What surfaces reflect of it.
    #[cfg(feature = "radiosity")]
    pub reflection: Arc<Reflection>,
}

#[cfg(feature = "radiosity")]
impl Background {
    /// As a sky that surfaces reflect.
    pub fn reflected(&self) -> ReflectedSky<'_> {
        let Self { rotation_deg, factor, reflection, .. } = self;
        ReflectedSky { mips: reflection.mips(), rotation_deg: *rotation_deg, factor: *factor }
    }
}

impl Background {
    /// Returns the radiance from a world direction, linear RGB.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        self.factor * self.environment.radiance(environment_from_world(direction, self.rotation_deg))
    }
}

impl Lighting {
    /// Prepares lights for a scene whose local space has its `origin` there in world space, with `groups` groups of
    /// emissive surfaces. `environment` is the picture of environment lights, white without. A group without a light is
    /// dark. The sun of an environment is [taken out](crate::environment::extract_sun) and becomes a lamp.
    pub fn new(
        lights: &[Light],
        environment: Option<&Arc<Environment>>,
        origin: [f64; 3],
        groups: usize,
    ) -> Self {
        let mut environment = environment.cloned().map(PreparedEnvironment::new).unwrap_or_default();
        Self::prepared(lights, &mut environment, origin, groups)
    }

    /// As [`Self::new`], with an environment that was prepared before.
    pub fn prepared(
        lights: &[Light],
        environment: &mut PreparedEnvironment,
        origin: [f64; 3],
        groups: usize,
    ) -> Self {
        let mut out = Self { emission: emission_factors(lights, groups), ..Self::default() };
        for light in lights {
            match light {
                Light::Environment { rotation_deg, .. } => {
                    out.add_environment(environment, *rotation_deg as f32, light.strength());
                }
                Light::Emissive { .. } => {}
                lamp => out.lamps.push(lamp.source(origin)),
            }
        }
        out
    }

    /// Adds the strengths of the groups of a fixed solution with the lights `solved`; nothing where there is none.
    ///
    /// # Errors
    /// [`MovedLight`] for one of the `lights` of the picture that is not in its place.
    pub fn with_groups(self, solved: Option<&[Light]>, lights: &[Light]) -> Result<Self, MovedLight> {
        let groups = solved.map(|solved| group_strengths(solved, lights)).transpose()?;
        Ok(Self { groups: groups.unwrap_or_default(), ..self })
    }

    fn add_environment(&mut self, environment: &mut PreparedEnvironment, rotation_deg: f32, factor: Vec3) {
        let sky = self.sky.get_or_insert_with(|| Box::new([Vec3::ZERO; BINS]));
        sky.iter_mut().zip(environment.bins(rotation_deg)).for_each(|(sum, bin)| *sum += factor * *bin);
        self.lamps.extend(environment.sun(rotation_deg, factor));
        self.background.push(Background {
            environment: environment.picture().clone(),
            rotation_deg,
            factor,
            #[cfg(feature = "radiosity")]
            reflection: environment.reflection().clone(),
        });
    }

    /// Returns the coefficients of the sky's radiance without its suns, world directions.
    #[cfg(feature = "radiosity")]
    pub fn sky_coefficients(&self) -> Coefficients {
        let mut sum = [Vec3::ZERO; COUNT];
        for background in &self.background {
            let turn = |axis: Vec3| world_from_environment(axis, background.rotation_deg);
            let turn = Mat3::from_cols(turn(Vec3::X), turn(Vec3::Y), turn(Vec3::Z));
            let turned = Rotation::new(turn).apply(background.reflection.coefficients());
            sum.iter_mut().zip(turned).for_each(|(sum, c)| *sum += background.factor * c);
        }
        sum
    }

    /// As [`Self::sky_coefficients`], with the light of suns and other directional lamps.
    #[cfg(feature = "radiosity")]
    pub fn distant_coefficients(&self) -> Coefficients {
        self.with_directional_lamps(self.sky_coefficients())
    }

    /// Adds the light of suns and other directional lamps to coefficients.
    #[cfg(feature = "radiosity")]
    pub fn with_directional_lamps(&self, mut sum: Coefficients) -> Coefficients {
        for lamp in self.lamps.iter().filter(|lamp| lamp.kind == LightKind::Directional) {
            sum.iter_mut().zip(evaluate(-lamp.direction)).for_each(|(sum, y)| *sum += lamp.intensity * y);
        }
        sum
    }

    /// Returns the radiance of the sky behind a scene from a world direction, linear RGB.
    pub fn behind(&self, direction: Vec3) -> Vec3 {
        self.background.iter().map(|background| background.radiance(direction)).sum()
    }
}

/// Returns the factor of the emission of each of `groups` groups, linear RGB: zero without a light.
pub fn emission_factors(lights: &[Light], groups: usize) -> Vec<Vec3> {
    let mut out = vec![Vec3::ZERO; groups];
    for light in lights {
        if let Light::Emissive { group, .. } = light
            && let Some(factor) = out.get_mut(*group as usize)
        {
            *factor += light.strength();
        }
    }
    out
}

/// Adds a light for each of `groups` groups of emissive surfaces that has none, and multiplies all by `emission`.
pub fn with_emission(lights: &[Light], groups: usize, emission: f64) -> Vec<Light> {
    let mut is_lit = vec![false; groups];
    let mut out = lights.to_vec();
    for light in &mut out {
        if let Light::Emissive { group, intensity, .. } = light {
            *intensity *= emission;
            if let Some(is_lit) = is_lit.get_mut(*group as usize) {
                *is_lit = true;
            }
        }
    }
    let dark = (0u32..).zip(is_lit).filter(|(_, is_lit)| !is_lit);
    out.extend(dark.map(|(group, _)| Light::Emissive { group, intensity: emission, color: [1.0; 3] }));
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::bins::SOLID_ANGLE;

    #[test]
    fn an_even_environment_gives_every_bin_its_radiance() {
        let light =
            Light::Environment { file: None, rotation_deg: 30.0, intensity: 2.0, color: [1.0, 0.5, 0.0] };
        let lighting = Lighting::new(&[light], None, [0.0; 3], 0);
        let sky = lighting.sky.clone().unwrap();
        assert!(sky.iter().all(|bin| (*bin - Vec3::new(2.0, 1.0, 0.0)).length() < 1e-4));
        assert!((lighting.behind(Vec3::X) - Vec3::new(2.0, 1.0, 0.0)).length() < 1e-5);
        assert!(lighting.lamps.is_empty() && SOLID_ANGLE > 0.0);
    }

    #[test]
    fn groups_without_a_light_get_one_and_emission_multiplies_all() {
        let own = Light::Emissive { group: 1, intensity: 3.0, color: [1.0, 0.0, 0.0] };
        let lights = with_emission(&[own], 3, 0.5);
        let lighting = Lighting::new(&lights, None, [0.0; 3], 3);
        let expected = [Vec3::splat(0.5), Vec3::new(1.5, 0.0, 0.0), Vec3::splat(0.5)];
        assert_eq!(lighting.emission, expected);
        // A light of a group that is not there is passed over.
        assert_eq!(Lighting::new(&lights, None, [0.0; 3], 1).emission, expected[..1]);
    }
}
