//! Scenes without a camera: objects receive bounced light on their outsides, rooms on their insides.

use boxes::add_box;
use glam::{Vec3, vec3};
use rebounce::bake::judge::Judge;
use rebounce::bake::{BakeReport, BakeSettings, Preset, bake};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Ray, Surfaces};
use rebounce::scene::Scene;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::meta::Material;
use rebounce_shared::shot::Shot;

use crate::common::boxes;

/// A closed box with faces out or in.
#[derive(Clone, Copy)]
struct Block {
    low: Vec3,
    high: Vec3,
    faces_in: bool,
}

fn out(low: Vec3, high: Vec3) -> Block {
    Block { low, high, faces_in: false }
}

fn inward(low: Vec3, high: Vec3) -> Block {
    Block { low, high, faces_in: true }
}

fn scene(blocks: &[Block], double_sided: bool) -> Scene {
    let mut scene =
        Scene { materials: vec![Material { double_sided, ..Material::default() }], ..Scene::default() };
    scene.materials[0].base_color = [0.8, 0.7, 0.6, 1.0];
    for block in blocks {
        add_box(&mut scene, [block.low, block.high], block.faces_in, 0);
    }
    scene
}

/// A board with two blocks.
fn object() -> Vec<Block> {
    vec![
        out(vec3(-2.0, 0.0, -1.5), vec3(2.0, 0.2, 1.5)),
        out(vec3(-1.4, 0.2, -0.9), vec3(-0.4, 1.3, 0.7)),
        out(vec3(0.2, 0.2, -0.8), vec3(1.3, 0.9, 0.5)),
    ]
}

fn furniture() -> Vec<Block> {
    vec![out(vec3(-1.5, 0.0, -1.5), vec3(-0.3, 1.2, -0.4)), out(vec3(0.3, 0.0, 0.2), vec3(1.6, 0.8, 1.4))]
}

fn shell(make: fn(Vec3, Vec3) -> Block) -> Block {
    make(vec3(-2.0, 0.0, -2.0), vec3(2.0, 2.5, 2.0))
}

fn baked(scene: &Scene) -> (BakedScene, BakeReport) {
    let mut settings = BakeSettings::new(Preset::Draft);
    (settings.place.levels, settings.place.functions) = (4, 6_000);
    settings.operator.rays = vec![512];
    bake(scene, &settings, &()).unwrap()
}

/// A bake of which only viewpoints and lamps are looked at.
fn sketched(scene: &Scene) -> (BakedScene, BakeReport) {
    let mut settings = BakeSettings::new(Preset::Draft);
    (settings.place.levels, settings.place.functions) = (3, 1_200);
    settings.operator.rays = vec![256];
    bake(scene, &settings, &()).unwrap()
}

/// Error of the bounced light against a path tracer, seen from `from`.
fn error(scene: &Scene, baked: &BakedScene, from: Vec3) -> f64 {
    let camera = Camera {
        position: from.as_dvec3().to_array(),
        target: [0.0, 0.5, 0.0],
        up: [0.0, 1.0, 0.0],
        yfov_deg: 45.0,
    };
    let sun = Light::Directional {
        direction: [-0.4, -1.0, -0.3],
        intensity: 3.0,
        color: [1.0; 3],
        radius_deg: 0.0,
    };
    let lamp = Light::Point { position: [-3.0, 3.0, -3.0], intensity: 30.0, color: [1.0; 3], radius: 0.0 };
    let shot = Shot::new([96, 72], camera, vec![sun, lamp]);
    let judge = Judge::new(scene, &shot, None, || ()).unwrap();
    let verdict = judge.verdict(&judge.picture(baked).unwrap()).unwrap();
    // An end of the interval, or the check below would pass on noise.
    verdict.comparison.error.at_most.unwrap()
}

#[test]
fn an_object_has_bounced_light_all_around_whatever_its_backs_do() {
    for double_sided in [false, true] {
        let scene = scene(&object(), double_sided);
        let (file, report) = baked(&scene);
        assert!(report.is_open);
        for from in [vec3(3.0, 3.0, 4.0), vec3(-4.0, 2.5, -3.0)] {
            let error = error(&scene, &file, from);
            println!("two-sided: {double_sided}, from {from}: {error}");
            assert!(error < 0.12, "two-sided: {double_sided}, from {from}: {error}");
        }
    }
}

#[test]
fn an_object_without_camera_and_light_is_seen_from_outside_in_the_light_of_a_lamp() {
    let lone = vec![out(Vec3::ZERO, Vec3::ONE)];
    for (blocks, double_sided) in [(lone.clone(), false), (lone, true), (object(), true)] {
        let scene = scene(&blocks, double_sided);
        let (file, report) = baked(&scene);
        assert!(report.is_open);
        let frame = file.meta.cameras[0].frame(file.meta.origin);
        let surfaces = TriangleSurfaces::from_baked(&file).unwrap();
        let (low, high) = surfaces.bounds();
        assert!(frame.eye.cmplt(low).any() || frame.eye.cmpgt(high).any(), "{}", frame.eye);
        let ray = |x, y| Ray {
            origin: frame.eye,
            direction: frame.direction(x, y, 160, 90),
            max_distance: f32::INFINITY,
            spread: 0.0,
        };
        let seen = |x, y| surfaces.cast(&ray(x, y), 0).is_some_and(|hit| hit.faces(ray(x, y).direction));
        assert!(seen(80.0, 45.0), "in the middle");
        assert!(matches!(file.meta.lights[..], [Light::Spot { .. }]) && report.lamp_added);
        assert!(file.meta.shown.ground().is_some() && !report.is_unlit);
        // The complete object is in the picture.
        let border = (0..160).flat_map(|x| [(x, 0), (x, 89)]).chain((0..90).flat_map(|y| [(0, y), (159, y)]));
        assert!(border.into_iter().all(|(x, y)| !seen(x as f32, y as f32)));
    }
}

#[test]
fn a_room_is_looked_at_from_within_whichever_way_its_walls_face() {
    let within = |report: &BakeReport| {
        report.viewpoints.iter().all(|p| p[0].abs() < 2.0 && p[1] > 0.0 && p[1] < 2.5 && p[2].abs() < 2.0)
    };
    for (walls, double_sided) in [(shell(inward), false), (shell(inward), true), (shell(out), true)] {
        let mut blocks = furniture();
        blocks.push(walls);
        let (file, report) = sketched(&scene(&blocks, double_sided));
        // In a room without lamp, a lamp is added above the camera.
        let [Light::Point { position, .. }] = file.meta.lights[..] else { panic!("{:?}", file.meta.lights) };
        let camera = file.meta.cameras[0].position;
        assert!(report.lamp_added && position[1] > camera[1] && position[1] < 2.5, "{position:?}");
        assert!(report.camera_added && (camera[1] - 1.6).abs() < 0.01, "{camera:?}");
        let is_inside = |p: &[f64; 3], block: &Block| {
            let p = Vec3::from(p.map(|x| x as f32));
            p.cmpgt(block.low).all() && p.cmplt(block.high).all()
        };
        assert!(!report.is_open && within(&report), "{:?}", report.viewpoints);
        // Not inside the furniture, although its back faces reflect.
        let hidden = report.viewpoints.iter().any(|p| furniture().iter().any(|block| is_inside(p, block)));
        assert!(!hidden, "{:?}", report.viewpoints);
    }
    // Only a lamp distinguishes an empty box from an object.
    let mut empty = scene(&[shell(out)], true);
    assert!(sketched(&empty).1.is_open);
    empty.lights.push(Light::Point {
        position: [0.5, 2.0, 0.3],
        intensity: 10.0,
        color: [1.0; 3],
        radius: 0.0,
    });
    let (file, report) = sketched(&empty);
    assert!(!report.lamp_added && file.meta.lights == empty.lights);
    assert!(!report.is_open && within(&report), "{:?}", report.viewpoints);
}

#[test]
fn what_nobody_fits_in_is_an_object() {
    let mut blocks = furniture();
    blocks.push(shell(inward));
    let mut small = scene(&blocks, true);
    small.positions.iter_mut().for_each(|position| *position *= 0.05);
    assert!(sketched(&small).1.is_open);
}

#[test]
fn a_lamp_that_is_added_to_a_room_lights_it_and_is_not_beside_a_wall() {
    for scale in [0.8, 1.0, 100.0] {
        let mut scene = scene(&[vec![shell(inward)], furniture()].concat(), false);
        scene.positions.iter_mut().for_each(|position| *position *= scale);
        let (file, report) = sketched(&scene);
        assert!(!report.is_open && report.lamp_added && report.camera_added, "{scale}");
        assert!(!report.is_unlit, "{scale}");
        let lamp = file.meta.lights[0].position().unwrap();
        assert!(lamp[0].abs() < 1.8 * scale as f64 && lamp[2].abs() < 1.8 * scale as f64, "{lamp:?}");
    }
}

#[test]
fn lights_that_reach_nothing_are_told() {
    let mut scene = scene(&[vec![shell(inward)], furniture()].concat(), false);
    let down = [0.0, -1.0, 0.0];
    scene.lights =
        vec![Light::Directional { direction: down, intensity: 3.0, color: [1.0; 3], radius_deg: 0.0 }];
    let (_, report) = sketched(&scene);
    println!("{report}");
    // One-sided walls let no light in; the sun is outside.
    assert!(report.is_unlit && report.to_string().contains("none reaches"));
}
