//! The rig of a file: vertices by their numbers in the file, and points on the triangles that deform.

use crate::geometry::nearest::TriangleTree;
use crate::sampling::{Points, SurfacePoint};
use crate::scene::Scene;
use crate::scene::rig::{UNUSED, renumber};
use glam::DVec3;
use rayon::prelude::*;
use rebounce_shared::rig::{Rig, RigPoint};

/// Distance of a point from its triangle, as a share of its support radius; and of the scene's diagonal, which is more than
/// simplification and rounding move surfaces by.
const OF_RADIUS: f64 = 1e-2;
const OF_SCENE: f64 = 1e-5;

/// The rig of the file; `places` has the number of each of the scene's vertices in the file.
pub(super) fn of_file(scene: &Scene, places: &[u32], points: &Points) -> Rig {
    if scene.rig.is_empty() {
        return Rig::default();
    }
    let mut rig = Rig { points: riding(scene, points), ..scene.rig.clone() };
    renumber(&mut rig, |vertex| Some(places[vertex as usize]).filter(|place| *place != UNUSED));
    rig
}

/// A triangle that deforms.
struct RigTriangle {
    /// Vertices of the rig.
    corners: [u32; 3],
    /// Unit normal of the front at rest; zero without area.
    normal: DVec3,
    /// Reconstruction group.
    group: u32,
}

/// Returns the points on triangles that deform. A point is on the nearest triangle of its group, rather on one that faces its
/// side; where it is on the back, the corners are in the other order.
fn riding(scene: &Scene, points: &Points) -> Vec<RigPoint> {
    let numbers = scene.rig.numbers(scene.positions.len());
    let (mut triangles, mut places) = (Vec::new(), Vec::new());
    for (triangle, material) in scene.triangles.iter().zip(&scene.triangle_material) {
        let [Some(a), Some(b), Some(c)] = triangle.map(|i| numbers[i as usize]) else { continue };
        let corners = [a, b, c];
        let [a, b, c] = triangle.map(|i| scene.positions[i as usize].as_dvec3());
        let normal = (b - a).cross(c - a).normalize_or_zero();
        triangles.push(RigTriangle { corners, normal, group: scene.groups.of_material(*material) });
        places.push([a, b, c]);
    }
    let tree = TriangleTree::new(places);
    let (low, high) = scene.main_part();
    let least = OF_SCENE * f64::from((high - low).length());
    let radii: Vec<f32> = (points.levels.iter())
        .flat_map(|level| level.range().map(|i| points.support_radius(level, i)))
        .collect();
    let of_point = |(i, (point, radius)): (usize, (&SurfacePoint, &f32))| {
        let most = least.max(OF_RADIUS * f64::from(*radius));
        let facing = point.geometric_normal.as_dvec3();
        // What faces away counts as farther by as much as a point can be away.
        let score = |triangle: u32, distance: f64| {
            let RigTriangle { normal, group, .. } = &triangles[triangle as usize];
            let is_own = *group == point.group && distance <= most;
            is_own.then(|| distance + 0.5 * most * (1.0 - normal.dot(facing)).max(0.0))
        };
        let found = tree.nearest(point.position.as_dvec3(), 2.0 * most, score)?;
        let RigTriangle { corners: [a, b, c], normal, .. } = triangles[found.triangle as usize];
        let [v, w] = found.barycentric.map(|share| share.clamp(0.0, 1.0) as f32);
        let (point, barycentric) = (i as u32, [v, w.min(1.0 - v)]);
        Some(match normal.dot(facing) < 0.0 {
            false => RigPoint { point, corners: [a, b, c], barycentric },
            true => RigPoint { point, corners: [a, c, b], barycentric: [barycentric[1], barycentric[0]] },
        })
    };
    points.points.par_iter().zip(&radii).enumerate().filter_map(of_point).collect()
}
