//! Light from infinitely far, given on the command line: an environment's picture, or a daylight sky.

use crate::error::ArgsError;
use crate::number;
use clap::Args;
use glam::Vec3;
use rebounce::io::{Files, environment};
use rebounce::scene::Scene;
use rebounce_shared::environment::daylight::{sky, sun_direction};
use rebounce_shared::light::{Light, LightKind};
use std::path::PathBuf;
use std::sync::Arc;

/// Heading of the options in the help.
const SKY: &str = "Light from the sky";
/// Haze of the daylight sky: a clear day.
const TURBIDITY: f32 = 3.0;
/// Reflectance of the ground below the horizon.
const GROUND: Vec3 = Vec3::splat(0.2);

/// Arguments about the sky.
#[derive(Args, Debug)]
pub struct SkyArgs {
    /// Light from all around: an equirectangular picture, .hdr, .exr or an Ultra HDR .jpg
    ///
    /// The picture's middle is towards +x and a quarter to its right +z, as three.js has it. The bake holds which directions
    /// each place sees: the picture can be turned and replaced by a shot.
    #[arg(long, help_heading = SKY, hide_short_help = true, value_name = "FILE", conflicts_with = "sky")]
    environment: Option<PathBuf>,
    /// Turns the environment about the vertical, degrees, counterclockwise seen from above
    #[arg(long, help_heading = SKY, hide_short_help = true, value_name = "DEGREES", default_value_t = 0.0, requires = "environment", value_parser = number::finite, allow_hyphen_values = true)]
    environment_rotation: f64,
    /// Factor of the environment's light
    #[arg(long, help_heading = SKY, hide_short_help = true, value_name = "FACTOR", default_value_t = 1.0, requires = "environment", value_parser = number::at_least_zero)]
    environment_intensity: f64,
    /// A clear sky with its sun: latitude in degrees, day of the year, solar hour, as in 48,172,15.5; -z is north
    #[arg(long, help_heading = SKY, hide_short_help = true, value_name = "LATITUDE,DAY,HOUR", value_parser = number::daylight, allow_hyphen_values = true)]
    sky: Option<[f64; 3]>,
}

impl SkyArgs {
    /// Adds the light to a scene; in place of an environment of the scene's own. `note` receives sentences about the
    /// picture.
    ///
    /// # Errors
    /// The problem in the picture.
    pub fn add_to(
        &self,
        scene: &mut Scene,
        files: &dyn Files,
        note: &mut dyn FnMut(&str),
    ) -> Result<(), ArgsError> {
        let color = [1.0; 3];
        let (environment, intensity, rotation_deg, sun) = match (&self.environment, self.sky) {
            (Some(file), _) => {
                let (environment, notes) = environment::read_from(files, file)?;
                notes.iter().for_each(|sentence| note(sentence));
                (environment, self.environment_intensity, self.environment_rotation, None)
            }
            (None, Some([latitude, day, hour])) => {
                let direction = sun_direction(latitude, day, hour);
                let (environment, sun) = sky(direction, TURBIDITY, GROUND);
                let sun = sun.map(|sun| Light::Directional {
                    direction: (-sun.direction).as_dvec3().to_array(),
                    intensity: f64::from(sun.irradiance.max_element()),
                    color: (sun.irradiance / sun.irradiance.max_element()).as_dvec3().to_array(),
                    radius_deg: f64::from(sun.radius_deg),
                });
                (environment, 1.0, 0.0, sun)
            }
            (None, None) => return Ok(()),
        };
        if environment.pixels.iter().all(|pixel| *pixel == Vec3::ZERO) {
            return Err(ArgsError::Black);
        }
        scene.light_names.resize(scene.lights.len(), String::new());
        let lights =
            std::mem::take(&mut scene.lights).into_iter().zip(std::mem::take(&mut scene.light_names));
        (scene.lights, scene.light_names) =
            lights.filter(|(light, _)| light.kind() != LightKind::Environment).unzip();
        let sky = Light::Environment { file: None, rotation_deg, intensity, color };
        scene.lights.push(sky);
        scene.light_names.push("Sky".to_owned());
        if let Some(sun) = sun {
            scene.lights.push(sun);
            scene.light_names.push("Sun".to_owned());
        }
        scene.environment = Some(Arc::new(environment));
        Ok(())
    }
}
