use super::*;
use crate::random::{Stream, mix};
use rebounce_shared::rbn::meta::Alpha;
use std::collections::HashMap;
use std::iter::Sum;
use std::ops::Mul;

#[path = "../../../tests/common/triangle.rs"]
mod triangle;

/// Returns a sheet of n x n squares over the unit square, two triangles per square. `at` returns a position, `look`
/// normal and texture coordinates, `material` a square's material.
fn sheet(
    n: u32,
    at: impl Fn(f32, f32) -> Vec3,
    look: impl Fn(f32, f32) -> (Vec3, Vec2),
    material: impl Fn(u32, u32) -> u32,
) -> Scene {
    let mut scene = Scene { materials: vec![textured(); 2], ..Scene::default() };
    let share = |k: u32| k as f32 / n as f32;
    for j in 0..=n {
        for i in 0..=n {
            let (normal, uv) = look(share(i), share(j));
            scene.positions.push(at(share(i), share(j)));
            scene.normals.push(normal);
            scene.uvs.push(uv);
        }
    }
    for j in 0..n {
        for i in 0..n {
            let corner = |i, j| j * (n + 1) + i;
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            scene.triangles.extend([[a, b, c], [a, c, d]]);
            scene.triangle_material.extend([material(i, j); 2]);
        }
    }
    scene
}

/// Simplifies as a bake does.
fn simple(scene: &Scene) -> Vec<[u32; 3]> {
    simplify(scene, |i| scene.materials[i].alpha == Alpha::Opaque, TOGETHER)
}

fn textured() -> Material {
    Material { base_color_texture: Some(0), ..Material::default() }
}

fn flat(n: u32) -> Scene {
    sheet(n, |x, y| Vec3::new(x, 0.0, y), |x, y| (Vec3::Y, Vec2::new(x, y)), |_, _| 0)
}

/// Returns a ball of squares with smooth normals.
fn ball(n: u32, radius: f32) -> Scene {
    let mut scene = Scene { materials: vec![textured()], ..Scene::default() };
    for axis in 0..3 {
        for side in [-1.0f32, 1.0] {
            let on = |u: f32, v: f32| {
                let (u, v) = (2.0 * u - 1.0, (2.0 * v - 1.0) * side);
                let mut at = [0.0; 3];
                (at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]) = (side, u, v);
                Vec3::from(at).normalize()
            };
            let face = sheet(n, |u, v| radius * on(u, v), |u, v| (on(u, v), Vec2::ZERO), |_, _| 0);
            add(&mut scene, &face);
        }
    }
    scene
}

fn add(scene: &mut Scene, more: &Scene) {
    let first = scene.positions.len() as u32;
    scene.positions.extend(&more.positions);
    scene.normals.extend(&more.normals);
    scene.uvs.extend(&more.uvs);
    scene.triangles.extend(more.triangles.iter().map(|t| t.map(|i| first + i)));
    scene.triangle_material.extend(&more.triangle_material);
}

fn vertex(scene: &Scene, corner: u32) -> usize {
    scene.triangles[corner as usize / 3][corner as usize % 3] as usize
}

fn material(scene: &Scene, corners: [u32; 3]) -> u32 {
    let of = corners.map(|corner| scene.triangle_material[corner as usize / 3]);
    assert!(of.iter().all(|material| *material == of[0]), "one triangle, one material");
    of[0]
}

fn area(corners: [Vec3; 3]) -> f64 {
    triangle::area(corners.map(|p| p.as_dvec3()))
}

fn positions(scene: &Scene, corners: [u32; 3]) -> [Vec3; 3] {
    corners.map(|corner| scene.positions[vertex(scene, corner)])
}

/// Returns the barycentric weights of the triangle's position nearest to a point.
fn nearest(corners: [Vec3; 3], p: Vec3) -> [f32; 3] {
    triangle::nearest(corners.map(|p| p.as_dvec3()), p.as_dvec3()).1.map(|share| share as f32)
}

fn mean<T: Sum<T> + Mul<f32, Output = T>>(shares: [f32; 3], of: impl Fn(usize) -> T) -> T {
    (0..3).map(|k| of(k) * shares[k]).sum()
}

/// Returns the maximum deviations of the surface `from` to the surface `to`: distance in units of the tolerance, and
/// differences of normals and of texture coordinates.
fn farthest(scene: &Scene, from: &[[u32; 3]], to: &[[u32; 3]]) -> (f32, f32, f32) {
    let (low, high) = scene.bounds();
    let allowed = TOLERANCE * (high - low).length();
    let mut stream = Stream::new(3, 0);
    let mut far = (0f32, 0f32, 0f32);
    // 100 to 200 triangles, evenly spread.
    for &corners in from.iter().step_by(1 + from.len() / 100) {
        for k in 0..4 {
            let (mut u, mut v) = (stream.unit(), stream.unit());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let shares = [[1.0 - u - v, u, v], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.5, 0.5]][k];
            let place = |corners: [u32; 3], shares| mean(shares, |k| positions(scene, corners)[k]);
            let p: Vec3 = place(corners, shares);
            let normal = |corners: [u32; 3], shares| -> Vec3 {
                mean(shares, |k| scene.normals[vertex(scene, corners[k])])
            };
            let uv = |corners: [u32; 3], shares| -> Vec2 {
                mean(shares, |k| scene.uvs[vertex(scene, corners[k])])
            };
            let difference = |other: &[u32; 3]| {
                let there = nearest(positions(scene, *other), p);
                (
                    place(*other, there).distance(p) / allowed,
                    normal(*other, there).distance(normal(corners, shares)),
                    uv(*other, there).distance(uv(corners, shares)),
                )
            };
            let same = |other: &&[u32; 3]| material(scene, **other) == material(scene, corners);
            // Of the triangles at the position, the triangle with the most similar look: at a seam there are two.
            let found: Vec<_> = to.iter().filter(same).map(difference).collect();
            let least = found.iter().map(|d| d.0).fold(f32::INFINITY, f32::min);
            let best = found
                .iter()
                .filter(|d| d.0 <= least.max(1.0))
                .min_by(|a, b| (a.1 + a.2).total_cmp(&(b.1 + b.2)))
                .unwrap();
            far = (far.0.max(least), far.1.max(best.1), far.2.max(best.2));
        }
    }
    far
}

/// Asserts that the triangles are unchanged and in the same order.
fn assert_unchanged(scene: &Scene, left: &[[u32; 3]]) {
    let corner = |corner: u32| {
        let vertex = vertex(scene, corner);
        (scene.positions[vertex], scene.normals[vertex], scene.uvs[vertex])
    };
    assert_eq!(left.len(), scene.triangles.len());
    for (ours, theirs) in left.iter().zip(all(scene)) {
        assert_eq!(ours.map(corner), theirs.map(corner));
        assert_eq!(material(scene, *ours), material(scene, theirs));
    }
}

fn all(scene: &Scene) -> Vec<[u32; 3]> {
    (0..scene.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()
}

/// Returns, by positions of an edge's ends, the number of the edge's triangles, and the number with forward minus
/// backward direction.
fn edges(scene: &Scene, triangles: &[[u32; 3]]) -> HashMap<[[u32; 3]; 2], (i32, i32)> {
    let mut edges = HashMap::new();
    for corners in triangles {
        let [a, b, c] = positions(scene, *corners).map(|p| (p + 0.0).to_array().map(f32::to_bits));
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let entry: &mut (i32, i32) = edges.entry([from.min(to), from.max(to)]).or_default();
            entry.0 += 1;
            entry.1 += if from < to { 1 } else { -1 };
        }
    }
    edges
}

#[test]
fn a_flat_sheet_becomes_two_triangles() {
    for n in [2, 9, 40] {
        let scene = flat(n);
        let left = simple(&scene);
        assert_eq!(left.len(), 2, "of {}", scene.triangles.len());
        let (far, normals, uvs) = farthest(&scene, &all(&scene), &left);
        assert!(far < 0.5 && normals < 1e-5 && uvs < 1e-5, "{far} {normals} {uvs}");
    }
}

#[test]
fn what_cannot_be_simpler_comes_out_as_it_went_in() {
    let cube = crate::io::load("builtin:cornell-box").unwrap();
    assert_unchanged(&cube, &simple(&cube));
    assert_eq!(simple(&Scene::default()), Vec::<[u32; 3]>::new());
    let rough = sheet(
        20,
        |x, y| Vec3::new(x, 0.05 * (40.0 * x + 3.0).sin() * (37.0 * y + 1.0).cos(), y),
        |_, _| (Vec3::Y, Vec2::ZERO),
        |_, _| 0,
    );
    assert_unchanged(&rough, &simple(&rough));
}

#[test]
fn the_surface_stays_where_it_is_and_looks_alike() {
    // Finely divided: a ball as in a room, a wave low enough to become flat, a texture that bends.
    let mut small = ball(40, 0.0005);
    small.materials.push(textured());
    let rough = |x: f32, y: f32| 0.05 * (40.0 * x + 3.0).sin() * (37.0 * y + 1.0).cos() - 1.0;
    add(&mut small, &sheet(40, |x, y| Vec3::new(x, rough(x, y), y), |_, _| (Vec3::Y, Vec2::ZERO), |_, _| 1));
    let height = |x: f32, y: f32| 2e-6 * (9.0 * x).sin() * (7.0 * y).cos();
    let wave = sheet(40, |x, y| Vec3::new(x, height(x, y), y), |x, y| (Vec3::Y, Vec2::new(x, y)), |_, _| 0);
    let bent = sheet(
        40,
        |x, y| Vec3::new(x, 0.0, y),
        |x, y| ((Vec3::Y + 0.2 * Vec3::X * x * x).normalize(), Vec2::new(x + 0.02 * (6.0 * y).sin(), y)),
        |_, _| 0,
    );
    for (name, scene) in [("ball", small), ("wave", wave), ("bent", bent)] {
        let left = simple(&scene);
        let count = |triangles: &[[u32; 3]]| triangles.iter().filter(|t| material(&scene, **t) == 0).count();
        let share = count(&left) as f32 / count(&all(&scene)) as f32;
        for (from, to) in [(&all(&scene), &left), (&left, &all(&scene))] {
            let (far, normals, uvs) = farthest(&scene, from, to);
            println!("{name}: {share} of the triangles, {far} {normals} {uvs}");
            assert!(share < 0.7, "{name}: {share} of the triangles are left");
            // Rounding of f32 adds to the tolerance.
            assert!(far <= 1.2 && normals <= 0.02 && uvs <= 1e-3, "{name}: {far} {normals} {uvs}");
        }
    }
}

#[test]
fn what_is_closed_stays_closed() {
    let (low, high) = (Vec3::splat(-1.0), Vec3::splat(1.0));
    for n in [3, 17, 100] {
        // Six sheets without common vertices, but with common positions.
        let mut cube = Scene { materials: vec![textured(); 2], ..Scene::default() };
        for axis in 0..3 {
            for side in [false, true] {
                let at = |x: f32, y: f32| {
                    let (u, v) = (axis + 1, axis + 2);
                    let mut p = if side { high } else { low };
                    let (x, y) = if side { (x, y) } else { (y, x) };
                    (p[u % 3], p[v % 3]) = (2.0 * x - 1.0, 2.0 * y - 1.0);
                    p
                };
                let normal = Vec3::AXES[axis] * if side { 1.0 } else { -1.0 };
                add(&mut cube, &sheet(n, at, |x, y| (normal, Vec2::new(x, y)), |i, j| (i + j < n) as u32));
            }
        }
        assert!(edges(&cube, &all(&cube)).values().all(|edge| *edge == (2, 0)));
        let left = simple(&cube);
        // A seam of n steps crosses each side, and stays.
        println!("{} -> {}", cube.triangles.len(), left.len());
        assert!(left.len() < cube.triangles.len() / n as usize * 8, "{}", left.len());
        assert!(edges(&cube, &left).values().all(|edge| *edge == (2, 0)), "{n}: an edge is open");
        for which in 0..2 {
            let of = |triangles: &[[u32; 3]]| -> f64 {
                let some = triangles.iter().filter(|t| material(&cube, **t) == which);
                some.map(|t| area(positions(&cube, *t))).sum()
            };
            assert!((of(&left) / of(&all(&cube)) - 1.0).abs() < 1e-5, "materials stay where they are");
        }
    }
}

#[test]
fn seams_of_textures_and_borders_are_straightened_and_stay() {
    // Two textures meet in the middle.
    let side = |x: f32| Vec2::new(if x <= 0.5 { x } else { x + 3.0 }, 0.0);
    let mut scene = sheet(32, |x, y| Vec3::new(0.5 * x, 0.0, y), |x, _| (Vec3::Y, side(0.5 * x)), |_, _| 0);
    let right = sheet(
        32,
        |x, y| Vec3::new(0.5 + 0.5 * x, 0.0, y),
        |x, _| (Vec3::Y, side(0.501 + 0.499 * x)),
        |_, _| 0,
    );
    add(&mut scene, &right);
    let left = simple(&scene);
    assert_eq!(left.len(), 4, "two triangles on each side of the seam");
    let (far, _, uvs) = farthest(&scene, &all(&scene), &left);
    assert!(far < 0.5 && uvs < 1e-5, "{far} {uvs}");
    // A round hole keeps its shape.
    let mut pierced = flat(64);
    let middle = |t: &[u32; 3]| t.iter().map(|i| pierced.positions[*i as usize]).sum::<Vec3>() / 3.0;
    let is_in = |t: &[u32; 3]| middle(t).distance(Vec3::new(0.5, 0.0, 0.5)) > 0.3;
    pierced.triangles = pierced.triangles.iter().copied().filter(is_in).collect();
    pierced.triangle_material.truncate(pierced.triangles.len());
    let left = simple(&pierced);
    let of =
        |triangles: &[[u32; 3]]| -> f64 { triangles.iter().map(|t| area(positions(&pierced, *t))).sum() };
    let whole = all(&pierced);
    assert!(left.len() < whole.len() / 8, "{} of {}", left.len(), whole.len());
    assert!((of(&left) / of(&whole) - 1.0).abs() < 1e-5, "{} of {}", of(&left), of(&whole));
}

#[test]
fn colours_stay() {
    let mut scene = flat(40);
    let of = |p: Vec3| Vec3::new(0.5 + 0.1 * (3.0 * p.x).sin(), p.z, if p.x < 0.5 { 0.1 } else { 0.9 });
    // The step of the colour is one strip of triangles wide.
    let color = |t: &[u32; 3]| t.map(|i| of(scene.positions[i as usize]));
    scene.corner_colors = scene.triangles.iter().map(color).collect();
    let left = simple(&scene);
    assert!(left.len() < scene.triangles.len() / 2 && left.len() > 8, "{}", left.len());
    let color = |corner: u32| scene.corner_colors[corner as usize / 3][corner as usize % 3];
    for (t, corners) in all(&scene).into_iter().enumerate() {
        let p = positions(&scene, corners).into_iter().sum::<Vec3>() / 3.0;
        let before = mean([1.0 / 3.0; 3], |k| color(corners[k]));
        let at = |other: &[u32; 3]| {
            let shares = nearest(positions(&scene, *other), p);
            (mean(shares, |k| positions(&scene, *other)[k]).distance(p), mean(shares, |k| color(other[k])))
        };
        let (off, after) = left.iter().map(at).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        let apart = (before - after).abs().max_element();
        assert!(off < 1e-6 && apart < 1.5 / 256.0, "{t}: {before} became {after}, {off} away");
    }
}

#[test]
fn straight_creases_go_as_flat_places_do() {
    // A column of eight flat sides with smooth normals; a side is 10 x 10 squares.
    let at = |side: f32| Vec3::new((side * 0.5).cos(), 0.0, (side * 0.5).sin());
    let around = |x: f32| {
        let (side, share) = ((8.0 * x).floor().min(7.0), 8.0 * x - (8.0 * x).floor().min(7.0));
        at(side).lerp(at(side + 1.0), share)
    };
    let scene = sheet(80, |x, y| around(x) + Vec3::Y * y, |x, y| (around(x), Vec2::new(x, y)), |_, _| 0);
    let left = simple(&scene);
    assert!(left.len() <= 24, "{} triangles are left of eight flat sides", left.len());
    let (far, normals, uvs) = farthest(&scene, &all(&scene), &left);
    assert!(far <= 1.2 && normals <= 0.02 && uvs <= 1e-3, "{far} {normals} {uvs}");
}

#[test]
fn what_one_vertex_looks_like_spreads_no_further() {
    let mut scene = flat(12);
    let black = 6 * 13 + 6;
    let color = |t: &[u32; 3]| t.map(|i| if i == black { Vec3::ZERO } else { Vec3::ONE });
    scene.corner_colors = scene.triangles.iter().map(color).collect();
    let left = simple(&scene);
    let color = |corner: u32| scene.corner_colors[corner as usize / 3][corner as usize % 3].x as f64;
    let darkness = |triangles: &[[u32; 3]]| -> f64 {
        let one = |t: &[u32; 3]| area(positions(&scene, *t)) * (1.0 - t.map(color).iter().sum::<f64>() / 3.0);
        triangles.iter().map(one).sum()
    };
    let (before, after) = (darkness(&all(&scene)), darkness(&left));
    assert!(
        left.len() < 100 && (after / before - 1.0).abs() < 0.02,
        "{before} became {after}, {}",
        left.len()
    );
}

#[test]
fn patches_join() {
    // More triangles than in a patch.
    let scene = flat(300);
    assert!(scene.triangles.len() > 8 * TOGETHER);
    let left = simple(&scene);
    assert_eq!(left.len(), 2);
    let open = edges(&scene, &left).values().filter(|edge| edge.0 == 1).count();
    assert_eq!(open, 4, "the sheet's own edges");
    // In random order.
    let mut mixed = scene.clone();
    mixed.triangles.sort_by_key(|t| mix(u64::from(t[0] ^ t[1] << 10 ^ t[2] << 20)));
    assert_eq!(simple(&mixed).len(), 2);
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(alone.install(|| simple(&scene)), left, "whoever works at it");
}

#[test]
fn transparent_triangles_and_odd_ones_stay() {
    let mut curtain = flat(8);
    curtain.materials[0].alpha = Alpha::Mask { cutoff: 0.5 };
    assert_unchanged(&curtain, &simple(&curtain));
    // Three sheets on one edge, two cones at one tip, a triangle without area, a duplicate triangle, a NaN.
    let mut odd = flat(8);
    add(&mut odd, &sheet(8, |x, y| Vec3::new(x, y, 0.0), |_, _| (Vec3::Z, Vec2::ZERO), |_, _| 0));
    add(&mut odd, &sheet(8, |x, y| Vec3::new(x, -y, 0.0), |_, _| (Vec3::Z, Vec2::ZERO), |_, _| 0));
    let hub = odd.positions.len() as u32;
    for i in 0..200 {
        let turn = i as f32 * 0.3;
        odd.positions.push(Vec3::new(turn.cos(), if i % 2 == 0 { 3.0 } else { 5.0 }, turn.sin()));
        odd.normals.push(if i == 7 { Vec3::NAN } else { Vec3::Y });
        odd.uvs.push(Vec2::ZERO);
        odd.triangles.push([hub, hub + i, hub + (i + 2) % 200]);
    }
    odd.triangles.extend([[3, 3, 3], [3, 4, 3], [0, 1, 10], [0, 1, 10], [0, 10, 1]]);
    odd.triangle_material.resize(odd.triangles.len(), 0);
    let left = simple(&odd);
    assert!(left.len() < odd.triangles.len());
    let (far, _, _) = farthest(&odd, &all(&flat(8)), &left);
    assert!(far <= 1.0, "{far}");
}
