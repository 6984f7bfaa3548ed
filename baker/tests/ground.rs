//! Detail in far larger scenes: a house on a plain, a room beside a stray object.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use glam::{DVec3, Vec3};
use rebounce::bake::judge::Judge;
use rebounce::bake::{BakeSettings, Preset, bake, choose_emitter};
use rebounce::basis::{Evaluator, Leveled, Support};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Ray, Surfaces};
use rebounce::sampling::place;
use rebounce::scene::{self, Scene};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_shared::shot::Shot;
use serde_json::{Value, json};

/// A box with faces out, or in if the flag is set.
struct Block(DVec3, DVec3, bool);

fn block(low: [f64; 3], high: [f64; 3]) -> Block {
    Block(low.into(), high.into(), false)
}

/// A scene of blocks and an optional plain of side `plain`, as from a glTF file.
fn loaded(blocks: &[Block], plain: Option<f64>) -> Scene {
    let (mut corners, mut indices): (Vec<f32>, Vec<u32>) = Default::default();
    let mut quad = |round: [DVec3; 4]| {
        let first = corners.len() as u32 / 3;
        corners.extend(round.iter().flat_map(|p| p.to_array()).map(|x| x as f32));
        indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    };
    for Block(low, high, faces_in) in blocks {
        let (middle, half) = (0.5 * (*low + *high), 0.5 * (*high - *low));
        for (axis, sign) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
            let normal = DVec3::AXES[axis] * sign;
            let (across, up) = (DVec3::AXES[(axis + 1) % 3] * sign, DVec3::AXES[(axis + 2) % 3]);
            let mut round = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .map(|(x, y)| middle + half * (normal + across * x + up * y));
            if *faces_in {
                round.reverse();
            }
            quad(round);
        }
    }
    if let Some(size) = plain {
        quad([(-0.5, -0.5), (-0.5, 0.5), (0.5, 0.5), (0.5, -0.5)].map(|(x, z)| size * DVec3::new(x, 0.0, z)));
    }
    let bin: Vec<u8> = [bytemuck::cast_slice(&corners), bytemuck::cast_slice::<u32, u8>(&indices)].concat();
    let extent = |fold: fn(f32, f32) -> f32| -> Vec<f32> {
        (0..3).map(|axis| corners.iter().skip(axis).step_by(3).copied().reduce(fold).unwrap()).collect()
    };
    let (vertices, split) = (corners.len() / 3, 4 * corners.len());
    let file = json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "materials": [{ "pbrMetallicRoughness": { "baseColorFactor": [0.6, 0.5, 0.4, 1.0] } }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }] }],
        "buffers": [{ "byteLength": bin.len() }],
        "bufferViews": [
            { "buffer": 0, "byteLength": split },
            { "buffer": 0, "byteOffset": split, "byteLength": bin.len() - split },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": vertices,
              "min": extent(f32::min), "max": extent(f32::max) },
            { "bufferView": 1, "componentType": 5125, "type": "SCALAR", "count": indices.len() },
        ],
    });
    rebounce::io::from_bytes("ground", &glb(&file, &bin)).unwrap()
}

fn glb(file: &Value, bin: &[u8]) -> Vec<u8> {
    let mut text = file.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    for word in [2, (28 + text.len() + bin.len()) as u32, text.len() as u32] {
        out.extend(word.to_le_bytes());
    }
    out.extend(b"JSON");
    out.extend(text);
    out.extend((bin.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(bin);
    out
}

/// A house without a front.
fn house() -> Vec<Block> {
    vec![
        block([-4.0, 0.0, -3.0], [4.0, 0.1, 3.0]),
        block([-4.0, 0.1, -3.0], [-3.8, 3.0, 3.0]),
        block([3.8, 0.1, -3.0], [4.0, 3.0, 3.0]),
        block([-3.8, 0.1, -3.0], [3.8, 3.0, -2.8]),
        block([-4.3, 3.0, -3.3], [4.3, 3.2, 3.3]),
    ]
}

fn camera() -> Camera {
    Camera { position: [3.0, 1.8, 9.0], target: [0.0, 1.4, 0.0], up: [0.0, 1.0, 0.0], yfov_deg: 50.0 }
}

fn settings() -> BakeSettings {
    let mut settings = BakeSettings::new(Preset::Draft);
    (settings.place.levels, settings.place.functions) = (4, 6_000);
    settings.operator.rays = vec![512, 512, 256, 256];
    settings
}

fn error(judge: &Judge, baked: &BakedScene) -> f64 {
    judge.verdict(&judge.picture(baked).unwrap()).unwrap().comparison.error.figure()
}

#[test]
#[ignore = "takes much processor time: docs/dev/testing.md"]
fn a_house_on_a_plain_without_end_gets_the_functions() {
    let mut scene = loaded(&house(), Some(4000.0));
    let sun = Light::Directional {
        direction: [-0.5, -1.0, -0.8],
        intensity: 3.0,
        color: [1.0; 3],
        radius_deg: 0.0,
    };
    let shot = Shot::new([80, 60], camera(), vec![sun]);
    let truth = scene.clone();
    let judge = Judge::new(&truth, &shot, None, || ()).unwrap();
    // No view given; a camera in the file; the shot's camera passed as setting.
    let found = bake(&scene, &settings(), &()).unwrap().0;
    let told = bake(&scene, &BakeSettings { camera: Some(camera()), ..settings() }, &()).unwrap().0;
    scene.cameras.push(camera());
    let seen = bake(&scene, &settings(), &()).unwrap().0;
    assert!(told.points == seen.points && told.links == seen.links && told.points != found.points);
    for (name, file, most) in [("found", &found, 0.12), ("seen", &seen, 0.1)] {
        let error = error(&judge, file);
        println!("{name}: {error}, {} functions on {} levels", file.points.len(), file.meta.levels.len());
        assert!(error < most, "{name}: {error}");
        assert!(file.points.len() < 30_000 && file.meta.levels.len() > 8);
    }
    // The added camera looks at the house.
    assert!(DVec3::from(found.meta.cameras[0].position).length() < 40.0);
}

#[test]
fn all_that_is_seen_of_a_plain_is_covered() {
    let mut scene = loaded(&house(), Some(4000.0));
    scene.cameras.push(camera());
    let surfaces = TriangleSurfaces::simplified(&scene);
    let settings = settings();
    let emitter = choose_emitter(&scene, &surfaces, &settings).unwrap();
    let points = place(&surfaces, &emitter, &settings.place, &()).unwrap();
    let of_level = |level: &rebounce::sampling::PointLevel| {
        let support = |i: usize| {
            let point = &points.points[i];
            let (position, normal) = (point.position, point.normal);
            Support { position, normal, radius: level.support_radius, cuts: &[], group: 0 }
        };
        Evaluator::new(level.range().map(support), level.first as u32)
    };
    let functions = Leveled::new(points.levels.iter().map(of_level).collect());
    let frame = camera().frame(scene.origin);
    let (mut seen, mut finer) = (0, 0);
    for (x, y) in (0..64).flat_map(|x| (0..64).map(move |y| (x as f32 + 0.5, y as f32 + 0.5))) {
        let direction = frame.direction(x, y, 64, 64);
        let Some(hit) = surfaces.cast(&Ray::visibility(frame.eye, direction), 0) else { continue };
        let radius = functions.radius_at(hit.position, hit.normal, 0);
        assert!(radius.is_some(), "nothing covers {}, {} away", hit.position, hit.distance);
        seen += 1;
        finer += radius.is_some_and(|radius| radius < 0.1 * hit.distance.max(5.0)) as u32;
    }
    assert!(seen > 2000 && 2 * finer > seen, "{finer} of {seen}");
}

#[test]
fn rooms_have_one_radius() {
    for name in ["cornell-box", "apartment", "library", "two-rooms-door"] {
        let scene = rebounce::io::load(&format!("builtin:{name}")).unwrap();
        let surfaces = TriangleSurfaces::simplified(&scene);
        assert_eq!(surfaces.main_part(), surfaces.bounds(), "{name}");
        let settings = settings();
        let emitter = choose_emitter(&scene, &surfaces, &settings).unwrap();
        assert!(!emitter.views.is_empty());
        let placer = rebounce::sampling::Placer::new(&surfaces, &emitter, &settings.place).unwrap();
        assert_eq!(placer.levels(), settings.place.levels, "{name}");
    }
}

#[test]
#[ignore = "takes much processor time: docs/dev/testing.md"]
fn a_stray_changes_nothing() {
    let mut blocks = vec![
        Block(DVec3::new(-2.0, 0.0, -2.0), DVec3::new(2.0, 3.0, 2.0), true),
        block([-0.8, 0.0, -0.8], [0.2, 1.0, 0.2]),
    ];
    let lamp = Light::Point { position: [0.0, 2.4, 0.0], intensity: 10.0, color: [1.0; 3], radius: 0.0 };
    let position = [0.0, 1.5, 1.9];
    let camera = Camera { position, target: [0.0, 1.3, 0.0], up: [0.0, 1.0, 0.0], yfov_deg: 63.0 };
    let shot = Shot::new([80, 60], camera.clone(), vec![lamp]);
    let room = loaded(&blocks, None);
    let judge = Judge::new(&room, &shot, None, || ()).unwrap();
    blocks.push(block([80_000.0, 0.0, 3.0], [80_001.0, 1.0, 4.0]));
    let stray = loaded(&blocks, None);
    assert!(Vec3::from(stray.origin.map(|x| x as f32)).length() < 4.0, "{:?}", stray.origin);
    assert_eq!(scene::outliers::far_away(&stray), None);
    let errors = [&room, &stray].map(|scene| {
        let mut scene = scene.clone();
        scene.cameras.push(camera.clone());
        error(&judge, &bake(&scene, &settings(), &()).unwrap().0)
    });
    println!("{errors:?}");
    assert!(errors[1] < 1.3 * errors[0] + 0.005, "{errors:?}");
}
