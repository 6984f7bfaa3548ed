//! Rectangles as parts of scenes.

use glam::{Vec2, Vec3};
use rebounce::scene::Scene;

/// Adds a rectangle around a place, world space, with its front on the side of `across` x `up`; `turned` selects the
/// second diagonal.
pub fn panel(scene: &mut Scene, place: Vec3, [across, up]: [Vec3; 2], material: u32, turned: bool) {
    let place = (place.as_dvec3() - glam::DVec3::from(scene.origin)).as_vec3();
    let first = scene.positions.len() as u32;
    for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        scene.positions.push(place + across * x + up * y);
        scene.normals.push(across.cross(up).normalize());
        scene.uvs.push(Vec2::ZERO);
    }
    let triangles = if turned { [[1, 2, 3], [1, 3, 0]] } else { [[0, 1, 2], [0, 2, 3]] };
    scene.triangles.extend(triangles.map(|t| t.map(|i| first + i)));
    scene.triangle_material.extend([material; 2]);
}
