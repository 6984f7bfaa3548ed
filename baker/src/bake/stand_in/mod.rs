//! Camera and lamp for scenes without, so that a picture is not empty; and the ground under an object.
//!
//! * `room` – view of a room; `object` – view of an object or a landscape;
//! * `lamp` – lamp in the picture; `ground` – ground under an object.

mod ground;
mod lamp;
mod object;
mod room;

use super::Purpose;
use crate::geometry::Surfaces;
use crate::sampling::emitter::ParticleEmitter;
use crate::scene::Scene;
use glam::Vec3;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::{Light, LightKind};
use rebounce_shared::rbn::shown::Shown;

/// Vertical field of view of added cameras, degrees.
const YFOV_DEG: f64 = 60.0;
/// Aspect ratio (width / height) used to choose a view.
const ASPECT: f32 = 16.0 / 9.0;
/// Names of the added lamp, environment and camera.
const LAMP: &str = "Lamp";
const SKY: &str = "Environment";
const VIEW: &str = "First view";

/// Lights and cameras, world space, both non-empty; names, and the ground.
#[derive(Clone, Debug, Default)]
pub(super) struct Staged {
    pub lights: Vec<Light>,
    pub cameras: Vec<Camera>,
    pub shown: Shown,
}

impl Staged {
    /// Returns the scene's own lights and cameras, or added ones; for an environment with an even white one, where the scene has
    /// none.
    pub fn new<S: Surfaces + ?Sized>(
        scene: &Scene,
        emitter: &ParticleEmitter,
        surfaces: &S,
        purpose: Purpose,
    ) -> Self {
        let ((mut lights, mut light_names), mut cameras) = (scene.all_lights(), scene.cameras.clone());
        let named = |names: &[String], count| {
            (0..count).map(|i| names.get(i).cloned().unwrap_or_default()).collect::<Vec<_>>()
        };
        let mut camera_names = named(&scene.camera_names, cameras.len());
        if cameras.is_empty() {
            let lamps = lights.iter().filter(|light| light.kind().is_lamp());
            let sources: Vec<_> = lamps.map(|light| light.source(scene.origin)).collect();
            let inside = if emitter.is_open { None } else { room::view(surfaces, emitter, &sources) };
            cameras.push(inside.map_or_else(
                || outside(scene),
                |view| camera(scene.origin, view.eye, view.eye + view.towards * view.far),
            ));
            camera_names.push(VIEW.to_owned());
        }
        let is_sky = |light: &Light| light.kind() == LightKind::Environment;
        if purpose == Purpose::Environment && !lights.iter().any(is_sky) {
            light_names.resize(lights.len(), String::new());
            lights.push(Light::Environment {
                file: None,
                rotation_deg: 0.0,
                intensity: 1.0,
                color: [1.0; 3],
            });
            light_names.push(SKY.to_owned());
        }
        if lights.is_empty() {
            let frame = cameras[0].frame(scene.origin);
            lights.push(lamp::lamp(surfaces, &frame, emitter.is_open, scene.origin));
            light_names.push(LAMP.to_owned());
        }
        let names = light_names.iter().chain(&camera_names).map(String::as_str);
        let shown = Shown::new(names, ground::ground(surfaces, emitter.is_open).as_ref());
        Self { lights, cameras, shown }
    }
}

/// Returns a camera that sees the scene from outside.
pub(super) fn outside(scene: &Scene) -> Camera {
    let (low, high) = scene.main_part();
    // Triangles of models are not in local space; a landscape is framed by its detailed part.
    let is_object = scene.models.is_empty() && (low, high) == scene.bounds();
    let corners = scene.triangles.iter().map(|t| t.map(|i| scene.positions[i as usize]));
    let (low, high) = if is_object { object::shown(corners, low, high) } else { (low, high) };
    let (eye, target) = object::view(low, high);
    camera(scene.origin, eye, target)
}

/// Returns a camera with vertical up direction; inputs in local space.
fn camera(origin: [f64; 3], eye: Vec3, target: Vec3) -> Camera {
    let world = |local: Vec3| std::array::from_fn(|i| origin[i] + f64::from(local[i]));
    Camera { position: world(eye), target: world(target), up: [0.0, 1.0, 0.0], yfov_deg: YFOV_DEG }
}

/// Returns evenly spread positions in the picture: x and y from -1 to 1, right and up.
fn spread_over_picture(count: u32) -> impl Iterator<Item = [f32; 2]> {
    (0..count).map(move |i| {
        let across = (i as f32 + 0.5) / count as f32;
        // Golden ratio.
        let up = (i as f32 * 0.618_034).fract();
        [2.0 * across - 1.0, 2.0 * up - 1.0]
    })
}
