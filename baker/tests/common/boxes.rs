//! Boxes as parts of scenes.

use glam::{Vec2, Vec3};
use rebounce::scene::Scene;

/// Adds a box between two corners, local space, whose sides face in or out.
pub fn add_box(scene: &mut Scene, [low, high]: [Vec3; 2], faces_in: bool, material: u32) {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    for (axis, sign) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
        let normal = Vec3::AXES[axis] * sign;
        let (across, up) = (Vec3::AXES[(axis + 1) % 3] * sign, Vec3::AXES[(axis + 2) % 3]);
        let first = scene.positions.len() as u32;
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            scene.positions.push(middle + half * (normal + across * x + up * y));
            scene.normals.push(if faces_in { -normal } else { normal });
            scene.uvs.push(Vec2::ZERO);
        }
        for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
            let [b, c] = if faces_in { [c, b] } else { [b, c] };
            scene.triangles.push([first + a, first + b, first + c]);
            scene.triangle_material.push(material);
        }
    }
}
