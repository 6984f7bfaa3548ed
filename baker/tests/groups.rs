//! Reconstruction groups: a function of one gives nothing to another that it touches; bodies that may move have points on
//! all that can be seen of them.

use glam::{DAffine3, DVec3, Vec3, dvec3};
use rebounce::bake::{BakeSettings, BakeSolver, Preset, bake};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Ray, Surfaces};
use rebounce::random::Stream;
use rebounce::scene::Scene;
use rebounce::scene::groups::{MaterialGroup, NodeGroups, assign};
use rebounce::scene::world_mesh::{WorldInstancedMesh, WorldMesh};
use rebounce::verify::render::Relit;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::groups::{Group, Node};
use rebounce_shared::rbn::meta::Material;

/// Folds of the curtain, and its middle's greatest distance from x = 0.
const FOLDS: usize = 10;
const DEEP: f64 = 0.15;
/// Between the two sides of the curtain.
const HALF_GAP: f64 = 0.005;
const HEIGHT: f64 = 2.2;
const LENGTH: f64 = 3.0;

/// Adds a flat quadrilateral that faces `front`.
fn quad(mesh: &mut WorldMesh, [a, b, c, d]: [DVec3; 4], front: DVec3, material: u32) {
    let corners = if (b - a).cross(c - a).dot(front) > 0.0 { [a, b, c, d] } else { [d, c, b, a] };
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize().as_vec3();
    mesh.normals.extend([normal; 4]);
    mesh.uvs.extend([glam::Vec2::ZERO; 4]);
    mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t: [u32; 3]| t.map(|i| first + i)));
    mesh.triangle_material.extend([material; 2]);
}

/// Half a room up to a curtain in zigzag folds; `side` is -1 or 1.
fn half(mesh: &mut WorldMesh, side: f64, material: u32) {
    let end = 2.0 * side;
    let edge = |k: usize| {
        let x = if k.is_multiple_of(2) { DEEP } else { -DEEP };
        dvec3(x + side * HALF_GAP, 0.0, LENGTH * k as f64 / (2 * FOLDS) as f64)
    };
    let up = DVec3::Y * HEIGHT;
    let wall = |z: f64| dvec3(end, 0.0, z);
    for k in 0..2 * FOLDS {
        let (a, b) = (edge(k), edge(k + 1));
        quad(mesh, [a, b, b + up, a + up], DVec3::X * side, material);
        let floor = [wall(a.z), a, b, wall(b.z)];
        quad(mesh, floor, DVec3::Y, material);
        quad(mesh, floor.map(|corner| corner + up), DVec3::NEG_Y, material);
    }
    quad(mesh, [wall(0.0), wall(LENGTH), wall(LENGTH) + up, wall(0.0) + up], DVec3::X * -side, material);
    for (k, front) in [(0, DVec3::Z), (2 * FOLDS, DVec3::NEG_Z)] {
        let (a, b) = (edge(k), wall(edge(k).z));
        quad(mesh, [a, b, b + up, a + up], front, material);
    }
}

/// A room that a curtain halves, with a lamp in one half. Floors, ceilings and walls of both halves meet in their planes; the
/// other half is in the dark. With `is_grouped`, it is a reconstruction group.
fn halved(is_grouped: bool) -> Scene {
    let mut mesh = WorldMesh::default();
    half(&mut mesh, -1.0, 0);
    half(&mut mesh, 1.0, 1);
    let matt = |name: &str| Material {
        name: name.to_owned(),
        base_color: [0.7, 0.7, 0.7, 1.0],
        ..Material::default()
    };
    let position = [-1.2, 1.8, 1.2];
    let mut scene = Scene {
        name: "halved".to_owned(),
        materials: vec![matt("lit"), matt("dark")],
        lights: vec![Light::Point { position, intensity: 20.0, color: [1.0; 3], radius: 0.0 }],
        ..Scene::default()
    };
    if is_grouped {
        let dark = MaterialGroup { name: "dark".to_owned(), density: 1.0 };
        assert!(assign(&mut scene, &mut mesh, NodeGroups::default(), &[dark]).is_empty());
    }
    mesh.finish(&mut scene);
    scene
}

/// Mean bounced irradiance of what is seen from the middle of the dark half, over that of the lit one.
fn leak(scene: &Scene, solver: BakeSolver) -> f32 {
    let mut settings = BakeSettings::new(Preset::Draft);
    settings.place.functions = 4000;
    settings.operator.rays = vec![512, 256, 256, 128, 128];
    settings.solver = solver;
    let middles = [[-1.0, 1.1, 1.5], [1.0, 1.1, 1.5]];
    settings.viewpoints = middles.to_vec();
    let (file, _) = bake(scene, &settings.normalised(), &()).unwrap();
    let surfaces = TriangleSurfaces::from_scene(scene);
    let relit = Relit::new(&file, &surfaces, &scene.lights, true);
    let seen_from = |world: [f64; 3]| {
        let origin = (DVec3::from(world) - DVec3::from(scene.origin)).as_vec3();
        let mut stream = Stream::new(3, 3);
        let light = |_| {
            let ray = Ray { origin, direction: stream.sphere(), max_distance: f32::INFINITY, spread: 0.0 };
            let hit = surfaces.cast(&ray, 0).unwrap();
            relit.indirect(&surfaces, &hit, &mut stream).dot(Vec3::splat(1.0 / 3.0))
        };
        (0..10_000).map(light).sum::<f32>() / 10_000.0
    };
    let [lit, dark] = middles.map(seen_from);
    assert!(lit > 0.5, "{lit}");
    dark / lit
}

#[test]
fn a_group_that_touches_a_lit_one_in_the_dark_is_black() {
    for solver in [BakeSolver::Operator, BakeSolver::Radiosity] {
        let [alone, grouped] = [false, true].map(|is_grouped| leak(&halved(is_grouped), solver));
        println!("{solver:?}: {alone} without groups, {grouped} with them");
        assert!(grouped <= 1e-6, "{solver:?}: {grouped}");
        // The zigzag keeps functions of one floor from being cut off by planes.
        assert!(alone > 2e-3, "{solver:?}: {alone}");
    }
}

/// A room with a two-sided box of the given height that may move, 40 cm wide; without a lid if it `is_open`.
fn with_box(height: f64, is_open: bool) -> Scene {
    let mut mesh = WorldMesh::default();
    let corner = |low: DVec3, high: DVec3, i: usize| {
        dvec3([low.x, high.x][i & 1], [low.y, high.y][i >> 1 & 1], [low.z, high.z][i >> 2])
    };
    let faces = [
        ([0, 1, 5, 4], DVec3::Y),
        ([2, 3, 7, 6], DVec3::NEG_Y),
        ([0, 2, 6, 4], DVec3::X),
        ([1, 3, 7, 5], DVec3::NEG_X),
        ([0, 1, 3, 2], DVec3::Z),
        ([4, 5, 7, 6], DVec3::NEG_Z),
    ];
    for (face, inward) in faces {
        let at = face.map(|i| corner(dvec3(-1.5, 0.0, -1.5), dvec3(1.5, HEIGHT, 1.5), i));
        quad(&mut mesh, at, inward, 0);
    }
    let mut body = WorldMesh::default();
    for (face, inward) in faces.into_iter().filter(|(_, inward)| !is_open || *inward != DVec3::NEG_Y) {
        let at = face.map(|i| corner(dvec3(-0.2, 0.0, -0.2), dvec3(0.2, height, 0.2), i));
        quad(&mut body, at, -inward, 1);
    }
    let place = dvec3(0.0, 0.5, 0.0);
    mesh.in_models = (body.positions.len(), body.triangles.len());
    mesh.models.push(WorldInstancedMesh {
        mesh: body,
        world_from_model: vec![DAffine3::from_translation(place)],
        group: 1,
    });
    let name = || "box".to_owned();
    let nodes = NodeGroups {
        nodes: vec![Node { name: name(), parent: None, origin: place.to_array() }],
        groups: vec![Group { name: name(), density: 1.0, node: Some(0) }],
        pivots: vec![place],
    };
    let matt = |double_sided: bool| Material {
        base_color: [0.6, 0.6, 0.6, 1.0],
        double_sided,
        ..Material::default()
    };
    let position = [0.8, 1.8, 0.8];
    let mut scene = Scene {
        name: "with a box".to_owned(),
        materials: vec![matt(false), matt(true)],
        lights: vec![Light::Point { position, intensity: 20.0, color: [1.0; 3], radius: 0.0 }],
        ..Scene::default()
    };
    assign(&mut scene, &mut mesh, nodes, &[]);
    mesh.finish(&mut scene);
    scene
}

#[test]
fn a_closed_body_has_no_points_within_and_an_open_one_has() {
    let mut settings = BakeSettings::new(Preset::Draft);
    settings.place.functions = 4000;
    settings.solver = BakeSolver::Radiosity;
    settings.viewpoints = vec![[-1.0, 1.0, -1.0]];
    // A plate thinner than any support is high, and a box.
    for height in [0.01, 0.3] {
        for is_open in [false, true] {
            let scene = with_box(height, is_open);
            let (file, _) = bake(&scene, &settings.clone().normalised(), &()).unwrap();
            let middle = (dvec3(0.0, 0.5 + 0.5 * height, 0.0) - DVec3::from(scene.origin)).as_vec3();
            let all: Vec<usize> = (0..file.points.len()).filter(|i| file.group_of(*i) == 1).collect();
            let outward = |i: &usize| (file.points[*i].position() - middle).dot(file.points[*i].normal());
            let within = all.iter().filter(|i| outward(i) < 0.0).count();
            assert_eq!(within > 0, is_open, "{within} of {} within {height}", all.len());
            let sides = [Vec3::X, Vec3::NEG_X, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
            for side in sides {
                let is_there = |i: &usize| file.points[*i].normal().dot(side) > 0.9 && outward(i) > 0.0;
                assert!(all.iter().any(is_there), "{side} of {height}");
            }
            // Edges of a plate are narrower than a support; they reflect as the rest does.
            for i in all {
                assert!((file.albedo(i).x - 0.6).abs() < 0.01, "{}", file.albedo(i));
            }
        }
    }
}
