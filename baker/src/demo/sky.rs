//! A clear sky for the windows of the generated scenes.

use crate::scene::Scene;
use glam::{DVec3, Vec3};
use rebounce_shared::environment::daylight;
use rebounce_shared::light::Light;
use std::sync::Arc;

/// Haze of a clear day.
const TURBIDITY: f32 = 3.0;
/// Reflectance of the ground below the horizon.
const GROUND: Vec3 = Vec3::splat(0.2);

/// Puts the sky of a clear day into a scene, as its last light: [`daylight::sky`] with the sun where `sun` comes from
/// (the way its light travels), and its radiance times `intensity`.
pub(super) fn add_clear_sky(scene: &mut Scene, sun: [f64; 3], intensity: f64) {
    let (sky, _) = daylight::sky(-DVec3::from(sun).as_vec3(), TURBIDITY, GROUND);
    scene.environment = Some(Arc::new(sky));
    scene.light_names.resize(scene.lights.len(), String::new());
    scene.lights.push(Light::Environment { file: None, rotation_deg: 0.0, intensity, color: [1.0; 3] });
    scene.light_names.push("Sky".to_owned());
}
