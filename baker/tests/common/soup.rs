//! Small scenes from arbitrary bytes: a sheet with steps, holes, folds, seams, edges of several triangles,
//! duplicate triangles and triangles without area.

use glam::{DVec2, DVec3, Vec2, Vec3};
use rebounce::geometry::simplify::{TOLERANCE, simplify};
use rebounce::scene::Scene;
use rebounce_shared::rbn::meta::{Alpha, Material};
use triangle::{area, nearest};

#[path = "triangle.rs"]
mod triangle;

/// Squares of the sheet along each axis.
const SIDE: u32 = 8;

/// Decodes a scene: four bytes for each change of the sheet.
pub fn soup(bytes: &[u8]) -> Scene {
    let textured = Material { base_color_texture: Some(0), ..Material::default() };
    let curtain = Material { alpha: Alpha::Blend, ..Material::default() };
    let mut scene = Scene { materials: vec![Material::default(), textured, curtain], ..Scene::default() };
    let corner = |i: u32, j: u32| j * (SIDE + 1) + i;
    for (i, j) in (0..=SIDE).flat_map(|j| (0..=SIDE).map(move |i| (i, j))) {
        scene.positions.push(Vec3::new(i as f32, 0.0, j as f32));
        scene.normals.push(Vec3::Y);
        scene.uvs.push(Vec2::new(i as f32, j as f32) / SIDE as f32);
    }
    for (i, j) in (0..SIDE).flat_map(|j| (0..SIDE).map(move |i| (i, j))) {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        scene.triangles.extend([[a, c, b], [a, d, c]]);
    }
    scene.triangle_material = vec![1; scene.triangles.len()];
    for change in bytes.as_chunks::<4>().0.iter().take(100) {
        let [what, a, b, c] = change.map(usize::from);
        let (vertex, triangle) = (a % scene.positions.len(), a % scene.triangles.len());
        match what % 8 {
            0 => scene.positions[vertex].y = b as f32 / 64.0,
            1 => (scene.positions[vertex].x, scene.positions[vertex].z) = ((b % 9) as f32, (c % 9) as f32),
            2 => scene.normals[vertex] = [Vec3::X, Vec3::Y, Vec3::ZERO][b % 3],
            3 => scene.uvs[vertex] = Vec2::new(b as f32, c as f32) / 16.0,
            4 => scene.triangle_material[triangle] = (b % 3) as u32,
            5 => {
                scene.triangles.push([a, b, c].map(|i| (i % scene.positions.len()) as u32));
                scene.triangle_material.push((a % 3) as u32);
            }
            6 => {
                let twin = scene.positions[vertex];
                scene.triangles[b % SIDE as usize * 3] = [c, c + 1, a].map(|i| i as u32 % (SIDE + 1).pow(2));
                scene.positions.push(twin);
                scene.normals.push(scene.normals[vertex]);
                scene.uvs.push(Vec2::ZERO);
            }
            _ if scene.triangles.len() > 1 => {
                scene.triangles.swap_remove(triangle);
                scene.triangle_material.swap_remove(triangle);
            }
            _ => {}
        }
    }
    scene
}

/// Checks a simplified scene: corners from the scene, one material per triangle, and per material equal area,
/// position and appearance within tolerance. Returns the number of triangles.
pub fn keeps_promises(scene: &Scene, together: usize) -> usize {
    let simple = simplify(scene, |i| scene.materials[i].alpha == Alpha::Opaque, together);
    let vertex = |corner: u32| scene.triangles[corner as usize / 3][corner as usize % 3] as usize;
    let material = |corners: [u32; 3]| {
        let of = corners.map(|corner| scene.triangle_material[corner as usize / 3]);
        assert!(of[0] == of[1] && of[1] == of[2], "one material a triangle");
        of[0]
    };
    let positions = |corners: [u32; 3]| corners.map(|corner| scene.positions[vertex(corner)].as_dvec3());
    let whole: Vec<[u32; 3]> =
        (0..scene.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    assert!(simple.len() <= whole.len());
    for which in 0..scene.materials.len() as u32 {
        let area = |triangles: &[[u32; 3]]| -> f64 {
            let some = triangles.iter().filter(|corners| material(**corners) == which);
            some.map(|corners| area(positions(*corners))).sum()
        };
        let (before, after) = (area(&whole), area(&simple));
        assert!((before - after).abs() <= 1e-3 * before.max(1.0), "{before} became {after}");
    }
    let (low, high) = scene.bounds();
    let allowed = 1.5 * (TOLERANCE * (high - low).length()) as f64;
    // Normal and texture coordinates, scaled to an allowed change of 1.
    let look = |corners: [u32; 3], shares: [f64; 3]| {
        let of = |k: usize| {
            let (normal, uv) = (scene.normals[vertex(corners[k])], scene.uvs[vertex(corners[k])]);
            let is_textured = scene.materials[material(corners) as usize].base_color_texture.is_some();
            let uv = if is_textured { uv.as_dvec2() * 2048.0 } else { DVec2::ZERO };
            (normal.as_dvec3() * 100.0, uv)
        };
        (0..3).fold((DVec3::ZERO, DVec2::ZERO), |sum, k| {
            (sum.0 + of(k).0 * shares[k], sum.1 + of(k).1 * shares[k])
        })
    };
    for corners in whole.iter().filter(|corners| area(positions(**corners)) > 0.0) {
        for shares in [[1.0, 0.0, 0.0], [0.0, 0.5, 0.5], [0.6, 0.3, 0.1], [0.1, 0.2, 0.7], [1.0 / 3.0; 3]] {
            let [a, b, c] = positions(*corners);
            let p = a * shares[0] + b * shares[1] + c * shares[2];
            let before = look(*corners, shares);
            let mut far = f64::INFINITY;
            let mut apart = f64::INFINITY;
            for other in simple.iter().filter(|other| material(**other) == material(*corners)) {
                let (distance, shares) = nearest(positions(*other), p);
                far = far.min(distance);
                if distance <= allowed {
                    let after = look(*other, shares);
                    apart = apart.min(before.0.distance(after.0).max(before.1.distance(after.1)));
                }
            }
            assert!(far <= allowed, "{p} is {far} off");
            assert!(apart <= 2.0, "{p} looks other by {apart}");
        }
    }
    simple.len()
}
