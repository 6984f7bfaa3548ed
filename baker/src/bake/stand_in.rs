//! Camera and lamp of a scene that has none, so that there is something to see.

use crate::points::vantage::Vantage;
use crate::random::Stream;
use crate::scene::Scene;
use crate::surface::{Ray, Surfaces};
use crate::triangles::TriangleSurfaces;
use glam::{DVec3, Vec3};
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use std::collections::HashMap;

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

/// How far to its sides a room's lamp wants to be free, over the scene's diagonal.
const ASIDE: f32 = 0.1;

/// Level views from each viewpoint, the rays of each, and how many must end on a material for it to be seen.
const VIEWS: u32 = 8;
const LOOKS: u64 = 128;
const NOTICED: usize = 2;

/// The scene's lights and cameras, or what takes their place, world space: never none.
pub(super) fn lights_and_cameras(
    scene: &Scene,
    vantage: &Vantage,
    surfaces: &TriangleSurfaces,
) -> (Vec<Light>, Vec<Camera>) {
    let (mut lights, mut cameras) = (scene.lights.clone(), scene.cameras.clone());
    if lights.is_empty() || cameras.is_empty() {
        let seat = Seat::new(vantage, surfaces);
        if lights.is_empty() {
            lights.push(seat.light(scene.origin, surfaces));
        }
        if cameras.is_empty() {
            let (low, high) = scene.main_part();
            cameras.push(seat.camera(scene.origin, low, high));
        }
    }
    (lights, cameras)
}

/// Where an open scene is seen from and lit, or where in a room.
pub(super) enum Seat {
    Outside,
    /// A viewpoint, local space, and the unit direction that it is best to look in.
    Inside(Vec3, Vec3),
}

impl Seat {
    /// In a room where most materials are in view and least of the sky; of such views the widest.
    pub fn new<S: Surfaces + ?Sized>(vantage: &Vantage, surfaces: &S) -> Self {
        let viewpoints = vantage.viewpoints.iter().filter(|_| !vantage.is_open);
        let views = viewpoints.flat_map(|viewpoint| {
            (0..VIEWS).map(|view| {
                let (z, x) = (std::f32::consts::TAU * view as f32 / VIEWS as f32).sin_cos();
                (*viewpoint, Vec3::new(x, 0.0, z))
            })
        });
        let mut best = (Self::Outside, None);
        for (viewpoint, towards) in views {
            let view = Some(look(surfaces, viewpoint, towards));
            if view > best.1 {
                best = (Self::Inside(viewpoint, towards), view);
            }
        }
        best.0
    }

    /// A camera for a scene that has none: in a room looking level; outside, so that all of what has the detail is in the
    /// picture. `low` and `high` are the corners of that, local space.
    pub fn camera(&self, origin: [f64; 3], low: Vec3, high: Vec3) -> Camera {
        let (middle, diagonal) = (0.5 * (low + high), (high - low).length());
        let world = |local: Vec3| (DVec3::from(origin) + local.as_dvec3()).to_array();
        let (position, target) = match *self {
            Self::Inside(viewpoint, towards) => (viewpoint, viewpoint + towards * 0.25 * diagonal),
            Self::Outside => {
                let distance = 0.5 * diagonal / (0.5 * YFOV_DEG as f32).to_radians().sin();
                (middle + AHEAD.normalize() * distance, middle)
            }
        };
        Camera { position: world(position), target: world(target), up: [0.0, 1.0, 0.0], yfov_deg: YFOV_DEG }
    }

    /// A light for a scene that has none: in a room a lamp above, outside a sun. Its irradiance is about π, so that white surfaces
    /// have a radiance of 1.
    pub fn light<S: Surfaces + ?Sized>(&self, origin: [f64; 3], surfaces: &S) -> Light {
        let color = [1.0; 3];
        let Self::Inside(viewpoint, _) = *self else {
            return Light::Directional { direction: SUN, intensity: std::f64::consts::PI, color };
        };
        let (low, high) = surfaces.main_part();
        let diagonal = (high - low).length();
        let up = Ray::blind(viewpoint, Vec3::Y);
        let above = surfaces.cast(&up, 0).map_or(UP_IN_OPEN * diagonal, |hit| UP * hit.distance);
        let mut local = viewpoint + above * Vec3::Y;
        // Not beside a wall.
        for axis in [Vec3::X, Vec3::Z] {
            let free = |way: Vec3| {
                surfaces
                    .cast(&Ray::blind(local, way), 0)
                    .map_or(ASIDE, |hit| hit.distance / diagonal)
                    .min(ASIDE)
            };
            local += 0.5 * (free(axis) - free(-axis)) * diagonal * axis;
        }
        let place = DVec3::from(origin) + local.as_dvec3();
        // What is lit is about an eighth of the diagonal away.
        let distance = 0.125 * diagonal as f64;
        Light::Point {
            position: place.to_array(),
            intensity: std::f64::consts::PI * distance * distance,
            color,
        }
    }
}

/// How many materials are seen from a viewpoint in a level direction, times the rays that end on a surface; and how far away
/// these are, a sum over rays.
fn look<S: Surfaces + ?Sized>(surfaces: &S, viewpoint: Vec3, towards: Vec3) -> (usize, f32) {
    let mut far = 0.0;
    let mut rays: HashMap<u32, usize> = HashMap::new();
    let right = towards.cross(Vec3::Y);
    let half = (0.5 * YFOV_DEG as f32).to_radians().tan();
    for i in 0..LOOKS {
        let mut stream = Stream::new(0x7365_6174, i);
        let [x, y] = (2.0 * stream.square() - 1.0).to_array();
        let direction = (towards + half * (1.5 * x * right + y * Vec3::Y)).normalize();
        let ray = Ray::blind(viewpoint, direction);
        if let Some(pieces) = surfaces.pieces()
            && let Some((place, distance)) = pieces.find(&ray, stream.bits() as u32)
        {
            far += distance;
            *rays.entry(pieces.piece(place.piece).kind).or_default() += 1;
        }
    }
    let materials = rays.values().filter(|rays| **rays >= NOTICED).count();
    (materials * rays.values().sum::<usize>(), far)
}
