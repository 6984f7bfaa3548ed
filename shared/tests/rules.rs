//! Tests of the format's rules: every violation is rejected with the name of the section.

use rebounce_shared::baked::BakedScene;
use rebounce_shared::basis::ParentWeights;
use rebounce_shared::camera::Camera;
use rebounce_shared::glam::Vec3;
use rebounce_shared::light::Light;
use rebounce_shared::link::{LaterLink, Link};
use rebounce_shared::rbn::bulk::{Copies, Cut, Instance, Point, Vertex};
use rebounce_shared::rbn::extras::Extras;
use rebounce_shared::rbn::light_groups::{GroupValue, LightGroup, LightGroups};
use rebounce_shared::rbn::meta::{
    Alpha, Animation, DetailTexture, Draw, Interpolation, Level, Material, Meta, Property, Texture, Track,
};
use rebounce_shared::rbn::{EXTRAS_SECTION, GROUP_SECTIONS, LinkMatrix, MAX_ROW, container};
use rebounce_shared::relight::from_groups;

/// A triangle with a coarse function with a cut, and a fine function without cuts.
pub fn scene() -> BakedScene {
    let corner = |x: f32, y: f32| Vertex { position: [x, y, 0.0], ..Vertex::default() };
    let point = |cuts: u32| Point { position: [0.3, 0.3, 0.0], radius: 1.0, normal: 0, cuts, tint: 0 };
    let level = |first: u32| Level { first, count: 1, disk_radius: 0.5, support_radius: 1.0 };
    let camera = Camera { position: [0.0; 3], target: [0.0, 0.0, -1.0], up: [0.0, 1.0, 0.0], yfov_deg: 50.0 };
    let track = Track {
        light: 0,
        property: Property::Position,
        interpolation: Interpolation::Step,
        times: vec![0.5, 2.0],
        values: vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
    };
    let mut scene = BakedScene {
        meta: Meta {
            bounds_max: [1.0; 3],
            levels: vec![level(0), level(1)],
            sender_levels: 1,
            later_levels: 1,
            direct_levels: 2,
            materials: vec![Material::default()],
            draws: vec![Draw { first_index: 0, index_count: 3, material: 0 }],
            cameras: vec![camera],
            lights: vec![Light::Point { position: [0.0; 3], intensity: 1.0, color: [1.0; 3], radius: 0.0 }],
            animations: vec![Animation { name: "way".into(), duration: 2.0, tracks: vec![track] }],
            ..Meta::default()
        },
        vertices: vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)],
        indices: vec![0, 1, 2],
        points: vec![point(Point::pack_cuts(0, 1, 0)), point(0)],
        cuts: vec![Cut::new(Vec3::X, 0.5)],
        links: LinkMatrix::from_rows(&[vec![Link::pack(0, 0.75)], vec![Link::pack(0, -0.5)]]),
        later: LinkMatrix::from_rows(&[vec![LaterLink::pack(0, Vec3::ONE)]]),
        ..BakedScene::default()
    };
    scene.relate().unwrap();
    scene
}

fn light(x: f64, intensity: f64, cone: f64) -> Light {
    Light::Spot {
        position: [x, 0.0, 0.0],
        direction: [0.0, 0.0, -1.0],
        outer_cone_deg: cone,
        inner_cone_deg: None,
        intensity,
        color: [1.0; 3],
        radius: 0.0,
    }
}

fn sphere(radius: f64, intensity: f64) -> Light {
    Light::Sphere { position: [0.0; 3], radius, intensity, color: [1.0; 3] }
}

/// A light of every kind that is not punctual.
fn others() -> Vec<Light> {
    let (position, direction, color) = ([0.5, 1.0, 0.25], [0.0, -1.0, 0.5], [1.0, 0.5, 0.25]);
    let file = Some("sky.hdr".to_owned());
    vec![
        Light::Rectangle {
            position,
            direction,
            up: [1.0, 0.0, 0.0],
            width: 2.0,
            height: 0.5,
            intensity: 8.0,
            color,
        },
        Light::Disk { position, direction, radius: 0.25, intensity: 6.0, color },
        sphere(0.125, 20.0),
        Light::Environment { file, rotation_deg: 30.0, intensity: 1.5, color },
        Light::Emissive { group: 3, intensity: 0.5, color },
    ]
}

#[test]
fn lights_that_are_not_punctual_have_a_version_of_their_own() {
    let plain = scene().to_bytes().unwrap();
    for light in others() {
        let mut scene = scene();
        scene.meta.lights.push(light);
        assert_eq!(scene.version(), container::ONE_GROUP);
        let mut bytes = scene.to_bytes().unwrap();
        assert_eq!(container::version(&bytes), Some(container::ONE_GROUP));
        assert_eq!(BakedScene::from_bytes(&bytes).unwrap(), scene);
        // A file that calls itself older is refused; readers of that version do not know the light.
        let sections = container::read(&bytes).unwrap();
        let parts: Vec<_> = sections.iter().map(|s| (s.name, &bytes[s.offset..s.offset + s.len])).collect();
        let error =
            BakedScene::from_bytes(&container::write(container::PUNCTUAL_LIGHTS, &parts)).unwrap_err();
        assert!(error.to_string().contains("META"), "{error}");
        // An older reader says that the file is newer.
        bytes[8] = container::VERSION as u8 + 1;
        assert_eq!(BakedScene::from_bytes(&bytes).unwrap_err().code(), "newer-version");
    }
    assert_eq!(container::version(&plain), Some(container::PUNCTUAL_LIGHTS));
}

#[test]
fn a_scene_that_keeps_the_rules_survives_the_file() {
    let scene = scene();
    assert_eq!(BakedScene::from_bytes(&scene.to_bytes().unwrap()).unwrap(), scene);
    assert!(scene.cuts_of(0)[0].ends(Vec3::X) && !scene.cuts_of(0)[0].ends(Vec3::Y));
    assert!(scene.cuts_of(1).is_empty());
}

#[test]
fn files_of_older_weights_are_of_the_least_version_that_holds_them() {
    assert_eq!(scene().version(), container::PUNCTUAL_LIGHTS);
    let mut scene = BakedScene { parent_weights: ParentWeights::Shepard, ..scene() };
    scene.relate().unwrap();
    assert_eq!(scene.version(), container::WITHOUT_COPIES);
    scene.meta.materials = vec![Material::default(); 3];
    scene.meta.materials[1].extras = Extras { unlit: true, ..Extras::default() };
    scene.meta.materials[2].extras = Extras {
        unlit: false,
        transmission: 0.5,
        transmission_texture: Some(DetailTexture { texture: 0, uv_from_vertex: [[1.0, 0.0, 0.5]; 2] }),
        transmission_tint: [0.1, 0.2, 0.3],
        scattered: 0.25,
        scattered_color: [0.4, 0.5, 0.6],
    };
    scene.meta.textures = vec![Texture::default()];
    scene.relate().unwrap();
    assert_eq!(scene.version(), container::SHEPARD_WEIGHTS);
    let bytes = scene.to_bytes().unwrap();
    assert_eq!(BakedScene::from_bytes(&bytes).unwrap(), scene);
    let sections: Vec<_> = container::read(&bytes).unwrap();
    let sections: Vec<_> =
        sections.iter().map(|s| (s.name, bytes[s.offset..s.offset + s.len].to_vec())).collect();
    let with = |version: u32, extras: &dyn Fn(&[u8]) -> Vec<u8>| {
        let changed = sections.iter().map(|(name, bytes)| {
            (*name, if *name == EXTRAS_SECTION { extras(bytes) } else { bytes.clone() })
        });
        let changed: Vec<_> = changed.collect();
        let parts: Vec<_> = changed.iter().map(|(name, bytes)| (*name, bytes.as_slice())).collect();
        BakedScene::from_bytes(&container::write(version, &parts))
    };
    assert_eq!(with(container::SHEPARD_WEIGHTS, &<[u8]>::to_vec).unwrap(), scene);
    // Rejected: an older version (its readers would ignore section MATX), trailing or missing bytes, a wrong material
    // index.
    type Change<'a> = &'a dyn Fn(&[u8]) -> Vec<u8>;
    let wrong: [(u32, Change); 4] = [
        (container::WITHOUT_EXTRAS, &<[u8]>::to_vec),
        (container::VERSION, &|bytes| [bytes, &[0]].concat()),
        (container::VERSION, &|bytes| bytes[..bytes.len() - 1].to_vec()),
        // Material index of the first record.
        (container::VERSION, &|bytes| [&bytes[..1], &[2], &bytes[2..]].concat()),
    ];
    for (i, (version, extras)) in wrong.into_iter().enumerate() {
        let error = with(version, extras).expect_err("refused").to_string();
        assert!(error.contains("MATX"), "{i}: {error}");
    }
}

#[test]
fn every_broken_rule_is_refused_by_its_section() {
    type Break = fn(&mut BakedScene);
    let breaks: [(&str, Break); 62] = [
        ("META", |s| s.meta.origin[1] = f64::NAN),
        ("META", |s| s.meta.cameras.clear()),
        ("META", |s| s.meta.levels[1].first = 7),
        ("META", |s| s.meta.sender_levels = 3),
        ("META", |s| s.meta.draws[0].index_count = 6),
        ("META", |s| s.meta.draws[0].material = 1),
        ("INDX", |s| s.indices[2] = 3),
        ("VERT", |s| s.vertices[0].uv[0] = f32::INFINITY),
        ("PNTS", |s| s.points[0].radius = -1.0),
        ("PNTS", |s| s.points[0].radius = 1e20),
        ("PNTS", |s| s.points[0].cuts = Point::pack_cuts(0, 2, 255)),
        ("PNTS", |s| s.points[1].cuts = Point::pack_cuts(1 << 20, 1, 0)),
        ("CUTS", |s| s.cuts[0].towards[2] = f32::NAN),
        ("LINK", |s| s.links.offsets.insert(0, 0)),
        ("LINK", |s| s.links.offsets[1] = 3),
        ("LINK", |s| s.links.links[1] = Link::pack(1, 1.0)),
        ("META", |s| s.meta.materials[0].roughness = f32::NAN),
        ("META", |s| s.meta.materials[0].normal_texture = Some(DetailTexture::default())),
        ("META", |s| s.meta.animations[0].tracks[0].light = 1),
        ("META", |s| s.meta.animations[0].tracks[0].times[1] = 0.5),
        ("META", |s| s.meta.animations[0].tracks[0].values.truncate(3)),
        ("META", |s| s.meta.animations[0].duration = -1.0),
        ("META", |s| {
            let track = &mut s.meta.animations[0].tracks[0];
            track.property = Property::Intensity;
            track.values = track.times.iter().map(|time| 0.5 - time).collect();
        }),
        ("META", |s| s.meta.origin[0] = 1e31),
        ("META", |s| s.meta.bounds_max[0] = 1e16),
        ("META", |s| s.meta.cameras[0].target[1] = f64::INFINITY),
        ("META", |s| s.meta.cameras[0].position[2] = 1e16),
        ("META", |s| s.meta.cameras[0].yfov_deg = f64::NAN),
        ("META", |s| s.meta.lights.push(sphere(0.0, 1.0))),
        ("META", |s| s.meta.lights.push(sphere(-1.0, 1.0))),
        ("META", |s| s.meta.lights.push(sphere(1.0, -1.0))),
        ("META", |s| s.meta.lights.push(sphere(1.0, f64::NAN))),
        ("META", |s| {
            s.meta.lights.push(sphere(1.0, 1.0));
            s.parent_weights = ParentWeights::Shepard;
        }),
        ("META", |s| s.meta.lights[0] = light(f64::NAN, 1.0, 30.0)),
        ("META", |s| s.meta.lights[0] = light(1e16, 1.0, 30.0)),
        ("META", |s| s.meta.lights[0] = light(0.0, 1e300, 30.0)),
        ("META", |s| s.meta.lights[0] = light(0.0, 1.0, f64::NEG_INFINITY)),
        ("META", |s| s.meta.levels = vec![Level::default(); 100_000]),
        ("META", |s| s.meta.levels.resize(33, Level { first: 2, ..Level::default() })),
        ("META", |s| s.meta.levels[0].support_radius = f32::NAN),
        ("META", |s| s.meta.levels[1].count = u32::MAX),
        ("META", |s| s.meta.later_levels = 2),
        ("META", |s| s.meta.draws[0].first_index = u32::MAX),
        ("META", |s| s.meta.draws[0].index_count = 0),
        ("META", |s| s.meta.draws = vec![s.meta.draws[0]; 2]),
        ("META", |s| s.meta.materials[0].base_color[2] = 1.5),
        ("META", |s| s.meta.materials[0].metallic = -0.5),
        ("META", |s| s.meta.materials[0].emission[0] = 1e16),
        ("META", |s| s.meta.materials[0].alpha = Alpha::Mask { cutoff: f32::NAN }),
        ("META", |s| s.meta.materials[0].base_color_texture = Some(0)),
        ("META", |s| s.meta.materials = vec![Material::default(); 65_536]),
        ("META", |s| s.meta.materials[0].extras.transmission = 1.5),
        ("META", |s| s.meta.materials[0].extras.scattered_color[1] = f32::NAN),
        ("META", |s| s.meta.materials[0].extras.transmission_texture = Some(DetailTexture::default())),
        ("META", |s| s.meta.textures = vec![Texture { offset: u64::MAX, len: 1, ..Texture::default() }]),
        ("META", |s| s.meta.animations[0].tracks[0].values[4] = 1e16),
        ("VERT", |s| s.vertices[2].position[1] = 1e16),
        ("PNTS", |s| s.points[0].radius = 1e-30),
        ("PNTS", |s| s.points[0].radius = f32::NAN),
        ("LINK", |s| s.links.links[0] = Link(s.links.links[0].0 | 5)),
        ("LATL", |s| s.later.offsets = vec![0]),
        ("LATL", |s| s.later.links[0] = LaterLink::pack(1, Vec3::ONE)),
    ];
    for (i, (section, damage)) in breaks.into_iter().enumerate() {
        let mut scene = scene();
        damage(&mut scene);
        let error = scene.to_bytes().expect_err("refused").to_string();
        assert!(error.contains(section), "{i}: {error}");
    }
}

/// Returns [`scene`] with the triangle in two places.
fn copied() -> BakedScene {
    let mut scene = scene();
    let mut moved = Instance::IDENTITY;
    moved.rows[1][3] = 0.5;
    scene.instances = vec![Instance::IDENTITY, moved];
    scene.copies = vec![Copies { first: 0, count: 2 }];
    scene
}

#[test]
fn of_older_weights_only_copies_ask_for_a_newer_version() {
    let (mut scene, mut copied) = (scene(), copied());
    for scene in [&mut scene, &mut copied] {
        scene.parent_weights = ParentWeights::Shepard;
        scene.relate().unwrap();
    }
    let version = |bytes: &[u8]| u32::from_le_bytes(bytes[8..12].try_into().unwrap());
    let (before, now) = (scene.to_bytes().unwrap(), copied.to_bytes().unwrap());
    assert_eq!((version(&before), version(&now)), (6, 7));
    assert_eq!(BakedScene::from_bytes(&now).unwrap(), copied);
    assert_eq!((scene.triangles_placed(), copied.triangles_placed()), (1, 2));
    assert_eq!((scene.copies_of(0), copied.copies_of(0)), (0..0, 0..2));
    let place = copied.instances[1].local_from_model();
    assert_eq!(place.transform_point3(Vec3::ONE), Vec3::new(1.0, 1.5, 1.0));
    assert_eq!(Instance::from(&place), copied.instances[1]);
}

#[test]
fn copies_that_are_not_there_or_cannot_be_turned_back_are_refused() {
    type Break = fn(&mut BakedScene);
    let breaks: [(&str, Break); 11] = [
        ("INST", |s| (0..3).for_each(|i| s.instances[1].rows[i][i] = 1e13)),
        ("INST", |s| (s.instances[1].rows[0][0], s.vertices[1].position[0]) = (1e8, 1e8)),
        ("COPY", |s| s.copies.clear()),
        ("COPY", |s| s.copies[0].count = 0),
        ("COPY", |s| s.copies[0].count = 3),
        ("COPY", |s| s.copies[0].first = u32::MAX),
        ("COPY", |s| s.copies.push(Copies::default())),
        ("INST", |s| s.instances[1].rows[0][0] = -1.0),
        ("INST", |s| s.instances[1].rows[2] = [0.0; 4]),
        ("INST", |s| s.instances[0].rows[2][3] = f32::NAN),
        ("INST", |s| s.instances[0].rows[0][0] = 1e-20),
    ];
    for (i, (section, damage)) in breaks.into_iter().enumerate() {
        let mut scene = copied();
        damage(&mut scene);
        let error = scene.to_bytes().expect_err("refused").to_string();
        assert!(error.contains(section), "{i}: {error}");
    }
    // A few bytes that request a billion triangles.
    let mut scene = copied();
    scene.indices = [0, 1, 2].repeat(1 << 10);
    scene.meta.draws[0].index_count = 3 << 10;
    scene.instances = vec![Instance::IDENTITY; 1 << 20];
    scene.copies[0].count = 1 << 20;
    scene.to_bytes().unwrap();
    scene.instances.push(Instance::IDENTITY);
    scene.copies[0].count += 1;
    let refused = scene.to_bytes().unwrap_err().to_string();
    assert!(refused.contains("1073742848 triangles with all copies"), "{refused}");
    // A file that repeats a million instances for several draw calls.
    let mut scene = copied();
    scene.meta.draws = vec![scene.meta.draws[0]; 6];
    (0..6).for_each(|d| scene.meta.draws[d].first_index = 3 * d as u32);
    scene.indices = [0, 1, 2].repeat(6);
    scene.instances = vec![Instance::IDENTITY; 1 << 20];
    scene.copies = (0..6).map(|d| Copies { first: d % 2, count: (1 << 20) - 1 }).collect();
    let refused = scene.to_bytes().unwrap_err().to_string();
    assert!(refused.contains("6291450 copies"), "{refused}");
    scene.copies = vec![scene.copies[0]; 6];
    scene.to_bytes().unwrap();
}

/// Returns [`scene`] as a fixed solution of a lamp and a sky.
pub fn solved() -> BakedScene {
    let mut scene = scene();
    scene.meta.lights.push(others()[3].clone());
    scene.meta.animations.clear();
    scene.meta.later_levels = 0;
    scene.links = LinkMatrix::from_rows(&[Vec::new(), Vec::new()]);
    scene.later = LinkMatrix::default();
    let group = |has_direct| LightGroup { floor: 0.001, has_direct };
    scene.light_groups = LightGroups { groups: vec![group(false), group(true)], values: Vec::new() };
    let (lamp, sky) = ([Vec3::new(0.5, 1.0, 0.25), Vec3::new(0.25, 2.0, 0.0)], [Vec3::ONE, Vec3::ZERO]);
    for column in [lamp, sky, sky] {
        scene.light_groups.push_column(&column, 0.001, scene.relations.push(), |_| true);
    }
    scene
}

#[test]
fn light_groups_survive_the_file_and_add_up() {
    let scene = solved();
    let bytes = scene.to_bytes().unwrap();
    assert_eq!(container::version(&bytes), Some(container::ONE_GROUP));
    let back = BakedScene::from_bytes(&bytes).unwrap();
    assert_eq!(back, scene);
    assert_eq!((back.light_groups.columns(), back.light_groups.direct_column(1)), (3, Some(2)));
    let light = from_groups(&back, &[Vec3::splat(2.0), Vec3::new(0.0, 1.0, 0.0)]);
    let near =
        |found: Vec3, expected: Vec3| (found - expected).abs().max_element() < 0.02 * expected.max_element();
    assert!(near(light.bounced[0], Vec3::new(1.0, 3.0, 0.5)), "{}", light.bounced[0]);
    assert!(near(light.bounced[1], Vec3::new(0.5, 4.0, 0.0)), "{}", light.bounced[1]);
    assert!(near(light.direct[0], Vec3::Y), "{}", light.direct[0]);
    // Readers of older versions would show no bounced light.
    let sections = container::read(&bytes).unwrap();
    let parts: Vec<_> = sections.iter().map(|s| (s.name, &bytes[s.offset..s.offset + s.len])).collect();
    let mut plain = scene.clone();
    plain.meta.lights.pop();
    plain.light_groups = LightGroups::default();
    let meta = plain.to_bytes().unwrap();
    let meta_section = container::read(&meta).unwrap()[0];
    let meta = &meta[meta_section.offset..meta_section.offset + meta_section.len];
    let older: Vec<_> =
        parts.iter().map(|(name, bytes)| (*name, if name == b"META" { meta } else { bytes })).collect();
    let error = BakedScene::from_bytes(&container::write(container::PUNCTUAL_LIGHTS, &older)).unwrap_err();
    assert!(error.to_string().contains("LGRP"), "{error}");
    // A section alone, or cut short.
    for missing in GROUP_SECTIONS {
        let rest: Vec<_> = parts.iter().filter(|part| part.0 != missing).copied().collect();
        let error = BakedScene::from_bytes(&container::write(container::VERSION, &rest)).unwrap_err();
        assert!(error.to_string().contains(&String::from_utf8_lossy(&missing)[..]), "{error}");
        let short: Vec<_> = parts
            .iter()
            .map(|(name, bytes)| (*name, if *name == missing { &bytes[..bytes.len() - 1] } else { bytes }))
            .collect();
        let error = BakedScene::from_bytes(&container::write(container::VERSION, &short)).unwrap_err();
        assert!(error.to_string().contains(&String::from_utf8_lossy(&missing)[..]), "{error}");
    }
}

#[test]
fn light_groups_that_do_not_fit_are_refused() {
    type Break = fn(&mut BakedScene);
    let breaks: [(&str, Break); 11] = [
        ("LGRP", |s| s.light_groups.groups.truncate(1)),
        ("LGRP", |s| s.light_groups.groups[0].floor = 0.0),
        ("LGRP", |s| s.light_groups.groups[0].floor = -1.0),
        ("LGRP", |s| s.light_groups.groups[1].floor = f32::NAN),
        ("LGRP", |s| s.light_groups.groups[1].floor = 1e20),
        ("LGRP", |s| s.light_groups.groups[1].floor = 1e-42),
        ("LVAL", |s| s.light_groups.groups[0].has_direct = true),
        ("LVAL", |s| s.light_groups.values.push(GroupValue::default())),
        ("LGRP", |s| s.light_groups.groups.clear()),
        ("LGRP", |s| s.links = LinkMatrix::from_rows(&[vec![Link::pack(0, 0.5)], Vec::new()])),
        ("LGRP", |s| s.meta.animations = scene().meta.animations),
    ];
    for (i, (section, damage)) in breaks.into_iter().enumerate() {
        let mut scene = solved();
        damage(&mut scene);
        let error = scene.to_bytes().expect_err("refused").to_string();
        assert!(error.contains(section), "{i}: {error}");
    }
}

#[test]
fn a_file_of_the_version_before_has_no_copies() {
    let mut bytes = copied().to_bytes().unwrap();
    bytes[8] = 6;
    let sum = xxhash_rust::xxh32::xxh32(&bytes[..28], 0);
    bytes[28..32].copy_from_slice(&sum.to_le_bytes());
    assert!(BakedScene::from_bytes(&bytes).unwrap_err().to_string().contains("COPY"));
}

#[test]
fn rows_that_would_keep_a_shader_busy_are_refused() {
    let mut scene = scene();
    let count = MAX_ROW as u32 + 1;
    let points = vec![scene.points[1]; 2];
    scene.points = points;
    scene.points.resize(count as usize, scene.points[0]);
    scene.cuts.clear();
    scene.meta.levels = vec![Level { first: 0, count, ..Level::default() }];
    (scene.meta.sender_levels, scene.meta.later_levels, scene.meta.direct_levels) = (1, 0, 1);
    scene.later = LinkMatrix::default();
    let mut rows = vec![Vec::new(); count as usize];
    rows[7] = (0..MAX_ROW as u32).map(|sender| Link::pack(sender, 0.1)).collect();
    scene.links = LinkMatrix::from_rows(&rows);
    scene.to_bytes().unwrap();
    rows[7].push(Link::pack(MAX_ROW as u32, 0.1));
    scene.links = LinkMatrix::from_rows(&rows);
    let refused = scene.to_bytes().unwrap_err().to_string();
    assert!(refused.contains("section LINK") && refused.contains("links in a row"), "{refused}");
}

#[test]
fn lights_of_any_numbers_end_in_no_panic() {
    let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -5.0, 0.0, 1e-320, 45.0, 400.0, f64::MAX];
    for outer in odd {
        for inner in odd {
            let light = Light::Spot {
                position: [inner; 3],
                direction: [outer; 3],
                outer_cone_deg: outer,
                inner_cone_deg: Some(inner),
                intensity: inner,
                color: [outer; 3],
                radius: 0.0,
            };
            let source = light.source([0.0; 3]);
            if light.is_usable() {
                assert!(source.position.is_finite() && source.direction.is_finite(), "{light:?}");
                assert!(source.intensity.is_finite() && source.cone_scale.is_finite(), "{light:?}");
            }
        }
    }
}
