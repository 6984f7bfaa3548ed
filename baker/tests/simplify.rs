//! Rays find equal hits on the simplified surfaces and on the scene's surfaces.

use glam::Vec3;
use rebounce::bake::{BakeSettings, Preset, bake};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::simplify::{TOGETHER, TOLERANCE, simplify};
use rebounce::geometry::{Hit, Ray, Surfaces};
use rebounce::random::Stream;
use rebounce::scene::Scene;
use split::split;
use std::path::Path;

use crate::common::soup;
use crate::common::split;

/// Whether two hits of a ray are on the same surface, within a distance of `allowed`.
fn is_same(a: &Hit, b: &Hit, direction: Vec3, allowed: f32) -> bool {
    // An offset across the surface becomes a larger offset along a grazing ray.
    let off = (a.distance - b.distance).abs() * direction.dot(a.geometric_normal).abs();
    off <= allowed
        && a.normal.distance(b.normal) < 0.02
        && a.geometric_normal.dot(b.geometric_normal) > 0.99
        && (a.albedo - b.albedo).abs().max_element() < 0.05
        && (a.emission - b.emission).abs().max_element() < 1e-6
}

/// Share of random rays with different hits.
fn different(scene: &Scene, rays: u64) -> f64 {
    let (whole, simple) = (TriangleSurfaces::from_scene(scene), TriangleSurfaces::simplified(scene));
    assert!(simple.triangle_count() <= whole.triangle_count());
    // Of two coincident triangles, the first counts.
    let mut turned = scene.clone();
    turned.triangles.reverse();
    turned.triangle_material.reverse();
    turned.corner_colors.reverse();
    let turned = TriangleSurfaces::from_scene(&turned);
    let (low, high) = whole.bounds();
    let size = (high - low).length();
    let mut different = 0;
    for i in 0..rays {
        let mut stream = Stream::new(17, i);
        let share = Vec3::new(stream.unit(), stream.unit(), stream.unit());
        let (origin, direction) = (low + (high - low) * share, stream.sphere());
        let ray = Ray { origin, direction, max_distance: f32::INFINITY, spread: 0.0 };
        let mut is_found = |found: &Hit| {
            // For coplanar surfaces, rounding decides the hit: rays beside this ray meet both surfaces.
            (0..24).any(|k| {
                let aside = if k < 2 { 0.0 } else { 1e-6 * size };
                let ray = Ray { origin: origin + aside * stream.sphere(), ..ray };
                [&whole, &turned][k % 2]
                    .cast(&ray, 1)
                    .is_some_and(|hit| is_same(&hit, found, direction, 1.5 * TOLERANCE * size + 2.0 * aside))
            })
        };
        different += !match simple.cast(&ray, 1) {
            None => whole.cast(&ray, 1).is_none(),
            Some(hit) => is_found(&hit),
        } as u64;
    }
    different as f64 / rays as f64
}

#[test]
fn rays_find_what_is_there() {
    for (name, n) in [("library", 1), ("apartment", 1), ("library", 5), ("two-rooms-door", 6)] {
        let mut scene = rebounce::io::load(&format!("builtin:{name}")).unwrap();
        if n > 1 {
            split(&mut scene, n);
        }
        if name == "two-rooms-door" {
            let color = |i: u32| (0.5 + 0.05 * scene.positions[i as usize]).clamp(Vec3::ZERO, Vec3::ONE);
            scene.corner_colors = scene.triangles.iter().map(|t| t.map(color)).collect();
            assert!(
                4 * simplify(&scene, |_| true, TOGETHER).len() < scene.triangles.len(),
                "colours that change evenly"
            );
        }
        let share = different(&scene, 100_000);
        println!("{name}, cut into {n} x {n}: {share}");
        // At the edge of an object in front of another object, the hit object may change.
        assert!(share < 2e-3, "{name}, cut into {n} x {n}: {share}");
    }
}

/// Gives every triangle its own vertices with the geometric normal, as in files without normals.
fn facet(scene: &mut Scene) {
    let (mut positions, mut normals, mut uvs) = (Vec::new(), Vec::new(), Vec::new());
    for triangle in &mut scene.triangles {
        let corners = triangle.map(|i| scene.positions[i as usize]);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or(Vec3::Y);
        uvs.extend(triangle.map(|i| scene.uvs[i as usize]));
        *triangle = [0, 1, 2].map(|k| positions.len() as u32 + k);
        positions.extend(corners);
        normals.extend([normal; 3]);
    }
    (scene.positions, scene.normals, scene.uvs) = (positions, normals, uvs);
}

#[test]
fn normals_worked_out_triangle_by_triangle_are_no_seams() {
    let mut scene = rebounce::io::load("builtin:library").unwrap();
    let before = scene.triangles.len();
    split(&mut scene, 6);
    let smooth = simplify(&scene, |_| true, TOGETHER).len();
    facet(&mut scene);
    let distinct = scene.normals.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert!(distinct > 5 * before, "rounding shows in {distinct} normals only");
    let faceted = simplify(&scene, |_| true, TOGETHER).len();
    println!("{before} triangles; cut up {}, of them {smooth} and {faceted} for rays", scene.triangles.len());
    assert!(10 * faceted < 11 * smooth && faceted < 2 * before, "{faceted}, not {smooth}");
    assert!(different(&scene, 20_000) < 2e-3);
}

#[test]
fn rays_find_what_is_there_in_given_scenes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/scenes");
    for name in ["sponza-dabrovic", "living-room", "kitchen"] {
        let path = folder.join(name).join(format!("{name}.glb"));
        let Some(path) = path.to_str().filter(|_| path.exists()) else { continue };
        let share = different(&rebounce::io::load(path).unwrap(), 100_000);
        println!("{name}: {share}");
        assert!(share < 2e-3, "{name}: {share}");
    }
}

#[test]
fn a_bake_does_not_see_how_its_surfaces_are_cut_up() {
    let mut scene = rebounce::io::load("builtin:two-rooms-door").unwrap();
    let mut settings = BakeSettings::new(Preset::Draft);
    settings.place.functions = 2_000;
    settings.operator.rays = vec![256];
    let (whole, report) = bake(&scene, &settings, &()).unwrap();
    assert_eq!(report.ray_triangles, report.triangles, "nothing in it can be simpler");
    split(&mut scene, 16);
    let (many, report) = bake(&scene, &settings, &()).unwrap();
    assert_eq!(report.triangles, 256 * whole.indices.len() as u64 / 3);
    println!("{} triangles, {} for rays", report.triangles, report.ray_triangles);
    assert!(20 * report.ray_triangles < report.triangles, "{}", report.ray_triangles);
    assert_eq!(many.indices.len(), 256 * whole.indices.len(), "what is shown stays as it was");
    // Equal numbers of functions and links, up to random variation.
    let close = |a: usize, b: usize| (a as f64 / b as f64 - 1.0).abs() < 0.05;
    assert!(close(many.points.len(), whole.points.len()), "{} {}", many.points.len(), whole.points.len());
    assert!(close(many.link_count(), whole.link_count()), "{} {}", many.link_count(), whole.link_count());
}

#[test]
fn any_triangles_keep_their_place_and_area() {
    let mut fewer = 0;
    for i in 0..1_000 {
        let mut stream = Stream::new(23, i);
        let length = (200.0 * stream.unit()) as usize;
        let bytes: Vec<u8> = (0..length).map(|_| (256.0 * stream.unit()) as u8).collect();
        let scene = soup::soup(&bytes);
        // At once, or in small groups.
        let together = [TOGETHER, 16][i as usize % 2];
        fewer += (soup::keeps_promises(&scene, together) < scene.triangles.len()) as u32;
    }
    assert!(fewer > 600, "{fewer} became simpler");
}

#[test]
fn what_fuzzing_found() {
    // A triangle in the plane of a sheet, with corners of the sheet, but no common edge.
    for bytes in [[0u8, 40, 64, 0, 0, 0, 5, 4, 5, 4, 77, 32]] {
        for together in [TOGETHER, 16] {
            soup::keeps_promises(&soup::soup(&bytes), together);
        }
    }
}
