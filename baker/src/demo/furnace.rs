//! A closed cube with walls that reflect half the light: bounced light can be computed by hand.

use super::matt;
use crate::scene::Scene;
use crate::scene::world_mesh::WorldMesh;
use glam::DVec3;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;

/// A cube of edge 2 around the origin, seen from within; a point light in the middle.
pub(super) fn scene() -> Scene {
    let mut mesh = WorldMesh::default();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let corner = |u: f64, v: f64| {
                let mut p = [0.0; 3];
                p[axis] = side;
                p[(axis + 1) % 3] = u;
                p[(axis + 2) % 3] = -side * v;
                DVec3::from(p)
            };
            mesh.quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)], 0);
        }
    }
    let mut scene = Scene {
        name: "furnace".into(),
        materials: vec![matt("half", [0.5; 3])],
        lights: vec![Light::Point { position: [0.0; 3], intensity: 1.0, color: [1.0; 3], radius: 0.0 }],
        cameras: vec![Camera {
            position: [0.0, 0.0, 0.9],
            target: [0.0; 3],
            up: [0.0, 1.0, 0.0],
            yfov_deg: 60.0,
        }],
        ..Scene::default()
    };
    mesh.finish(&mut scene);
    scene
}
