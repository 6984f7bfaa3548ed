//! Camera and lamp of a scene that has none, so that there is something to see.

use crate::points::vantage::Vantage;
use crate::surface::{Ray, Surfaces};
use glam::{DVec3, Vec3};
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;

/// Where an open scene is looked at from, seen from its middle: from ahead of it (glTF's objects face +z) and a little
/// above.
const AHEAD: Vec3 = Vec3::new(0.45, 0.35, 1.0);
const YFOV_DEG: f64 = 60.0;
/// The way that an open scene's sun goes: over the left shoulder of who looks from there.
const SUN: [f64; 3] = [0.5, -1.0, -0.6];
/// How far up a room's lamp hangs, from the viewpoint to what is above it.
const UP: f32 = 0.75;
/// The same where nothing is above, over the scene's diagonal.
const UP_IN_OPEN: f32 = 0.1;

/// A camera for a scene that has none: of a room at its viewpoint, looking level towards the far side; of an open scene
/// outside, so that all of it is in the picture.
pub(super) fn camera_for(origin: [f64; 3], vantage: &Vantage, low: Vec3, high: Vec3) -> Camera {
    let (middle, diagonal) = (0.5 * (low + high), (high - low).length());
    let world = |local: Vec3| (DVec3::from(origin) + local.as_dvec3()).to_array();
    let inside = vantage.viewpoints.first().filter(|_| !vantage.is_open);
    let (position, target) = match inside {
        Some(&viewpoint) => {
            let mut towards = (middle - viewpoint).with_y(0.0);
            if towards.length() < 0.05 * diagonal {
                towards = if high.x - low.x > high.z - low.z { Vec3::X } else { Vec3::Z };
            }
            (viewpoint, viewpoint + towards.normalize() * 0.25 * diagonal)
        }
        None => {
            let distance = 0.5 * diagonal / (0.5 * YFOV_DEG as f32).to_radians().sin();
            (middle + AHEAD.normalize() * distance, middle)
        }
    };
    Camera { position: world(position), target: world(target), up: [0.0, 1.0, 0.0], yfov_deg: YFOV_DEG }
}

/// A light for a scene that has none: of a room a lamp above the viewpoint, of an open scene a sun. Its irradiance is about π,
/// so that white surfaces have a radiance of 1.
pub(super) fn light_for<S: Surfaces + ?Sized>(origin: [f64; 3], vantage: &Vantage, surfaces: &S) -> Light {
    let color = [1.0; 3];
    let Some(&viewpoint) = vantage.viewpoints.first().filter(|_| !vantage.is_open) else {
        return Light::Directional { direction: SUN, intensity: std::f64::consts::PI, color };
    };
    let (low, high) = surfaces.bounds();
    let diagonal = (high - low).length();
    let up = Ray { origin: viewpoint, direction: Vec3::Y, max_distance: f32::INFINITY, spread: Ray::BLIND };
    let above = surfaces.cast(&up, 0).map_or(UP_IN_OPEN * diagonal, |hit| UP * hit.distance);
    let place = DVec3::from(origin) + (viewpoint + above * Vec3::Y).as_dvec3();
    // What is lit is about an eighth of the diagonal away.
    let distance = 0.125 * diagonal as f64;
    Light::Point { position: place.to_array(), intensity: std::f64::consts::PI * distance * distance, color }
}
