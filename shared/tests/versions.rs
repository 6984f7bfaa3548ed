//! Compatibility tests with files of every version: supported files keep their meaning; unsupported files name their
//! writer.
//!
//! `files/format-N.rbn` is a file of version N, baked from `baker/tests/gltf/plain.glb` by the first Rebounce with
//! version N and never regenerated (7: the Cornell box, with a wall in two places; 8 and 9: a floor, a wall and a
//! half-transparent board; 10: the Cornell box with a light of every kind, baked, and the same solved for its lights); `files/format-N.head` is the begin of a file of an unreleased version.

use rebounce_shared::baked::BakedScene;
use rebounce_shared::basis::ParentWeights;
use rebounce_shared::environment::PackedEnvironment;
use rebounce_shared::environment::bins::BINS;
use rebounce_shared::glam::Vec3;
use rebounce_shared::light::{Light, LightKind};
use rebounce_shared::light_group::group_strengths;
use rebounce_shared::rbn::{RbnError, container};
use rebounce_shared::relight::{from_groups, from_sources, relight};
use std::path::PathBuf;

fn file(name: &str) -> Vec<u8> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/files").join(name);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn a_file_of_version_6_means_what_it_meant() {
    let bytes = file("format-6.rbn");
    let scene = BakedScene::from_bytes(&bytes).unwrap();
    assert_eq!(scene.meta.generator, "rebounce 0.1.0");
    assert_eq!(scene.meta.scene_name, "plain");
    let counts = [
        scene.vertices.len(),
        scene.indices.len(),
        scene.meta.materials.len(),
        scene.meta.textures.len(),
        scene.texture_bytes.len(),
        scene.meta.lights.len(),
        scene.points.len(),
        scene.cuts.len(),
        scene.links.links.len(),
        scene.later.links.len(),
    ];
    assert_eq!(counts, [734, 4326, 25, 1, 3114, 0, 217, 186, 1534, 3536]);
    // Relighting with uniform direct light gives the recorded mean.
    let light = relight(&scene, vec![Vec3::ONE; scene.direct_count()]);
    let mean = light.iter().sum::<Vec3>() / light.len() as f32;
    let then = Vec3::new(0.11593077, 0.12552752, 0.13108319);
    assert!((mean - then).abs().max_element() < 1e-5, "{mean}");
    // The file is written back bit-identical.
    assert!(scene.to_bytes().unwrap() == bytes);
}

#[test]
fn a_file_of_version_7_means_what_it_meant() {
    let bytes = file("format-7.rbn");
    let scene = BakedScene::from_bytes(&bytes).unwrap();
    assert_eq!(scene.version(), container::WITHOUT_EXTRAS);
    assert_eq!(scene.meta.scene_name, "cornell-box");
    let counts = [scene.vertices.len(), scene.indices.len(), scene.instances.len(), scene.points.len()];
    assert_eq!(counts, [60, 90, 2, 21]);
    assert_eq!(scene.triangles_placed(), 32);
    let place = scene.instances[1].local_from_model().transform_point3(Vec3::ZERO);
    assert_eq!(place, Vec3::new(0.0, 0.0, -0.25));
    let light = relight(&scene, vec![Vec3::ONE; scene.direct_count()]);
    let mean = light.iter().sum::<Vec3>() / light.len() as f32;
    assert!((mean - Vec3::new(0.40261978, 0.46042323, 0.39337125)).abs().max_element() < 1e-5, "{mean}");
    assert!(scene.to_bytes().unwrap() == bytes);
}

/// Loads a file of the board scene (versions 8 and 9). Returns the scene, record counts, and mean light for unit
/// direct light at every sampled point.
fn board(name: &str) -> (BakedScene, [usize; 5], Vec3) {
    let bytes = file(name);
    let scene = BakedScene::from_bytes(&bytes).unwrap();
    assert_eq!(scene.meta.scene_name, "board");
    assert_eq!(scene.meta.materials[1].extras.transmission, 0.5);
    let counts = [
        scene.vertices.len(),
        scene.points.len(),
        scene.cuts.len(),
        scene.links.links.len(),
        scene.later.links.len(),
    ];
    let light = relight(&scene, vec![Vec3::ONE; scene.direct_count()]);
    let mean = light.iter().sum::<Vec3>() / light.len() as f32;
    assert!(scene.to_bytes().unwrap() == bytes);
    (scene, counts, mean)
}

#[test]
fn a_file_of_version_8_means_what_it_meant() {
    let (scene, counts, mean) = board("format-8.rbn");
    assert_eq!((scene.version(), scene.parent_weights), (container::SHEPARD_WEIGHTS, ParentWeights::Shepard));
    assert_eq!(counts, [12, 83, 22, 975, 1140]);
    assert!((mean - Vec3::new(0.2456204, 0.22067507, 0.18441641)).abs().max_element() < 1e-5, "{mean}");
}

#[test]
fn a_file_of_version_9_means_what_it_meant() {
    let (scene, counts, mean) = board("format-9.rbn");
    assert_eq!((scene.version(), scene.parent_weights), (9, ParentWeights::LeastSquares));
    assert_eq!(counts, [12, 83, 22, 960, 1143]);
    assert!((mean - Vec3::new(0.24589814, 0.21918626, 0.18344763)).abs().max_element() < 1e-5, "{mean}");
}

/// Means of the file of version 10: bounced light under unit direct light, light of a sky of radiance 1, and of the panel.
const MEANS: [Vec3; 3] = [
    Vec3::new(0.7301578, 0.632802, 0.5189006),
    Vec3::splat(0.5105279),
    Vec3::new(0.034374207, 0.02864517, 0.017187104),
];
/// Means of the solved file: bounced and direct light of its own lights.
const SOLVED: [Vec3; 2] =
    [Vec3::new(0.8087576, 0.6891732, 0.5286022), Vec3::new(0.35011974, 0.5699123, 0.9521871)];

/// Loads a file of version 10. Returns the scene, and record counts.
fn all_lights(name: &str) -> (BakedScene, [usize; 6]) {
    let bytes = file(name);
    let scene = BakedScene::from_bytes(&bytes).unwrap();
    assert_eq!((scene.version(), scene.parent_weights), (10, ParentWeights::LeastSquares));
    assert_eq!(scene.meta.scene_name, "cornell-box");
    let color = [1.0, 0.9, 0.8];
    let (down, up) = ([0.0, -1.0, 0.0], [0.0, 0.0, 1.0]);
    let [spot, others @ ..] = &scene.meta.lights[..] else { panic!() };
    assert_eq!(spot.kind(), LightKind::Spot);
    assert_eq!(
        others,
        [
            Light::Environment { file: None, rotation_deg: 20.0, intensity: 2.0, color },
            Light::Rectangle {
                position: [1.0, 4.0, -2.0],
                direction: down,
                up,
                width: 0.5,
                height: 0.25,
                intensity: 9.0,
                color
            },
            Light::Disk { position: [-1.0, 4.0, -2.0], direction: down, radius: 0.25, intensity: 8.0, color },
            Light::Sphere { position: [0.0, 2.5, -1.0], radius: 0.125, intensity: 7.0, color },
            Light::Emissive { group: 0, intensity: 1.0, color: [1.0; 3] },
        ]
    );
    let [panel] = &scene.sources.groups[..] else { panic!() };
    assert_eq!((panel.name.as_str(), panel.is_coloured), ("panel", false));
    let sky = PackedEnvironment::from_bytes(&scene.sources.environment).unwrap().unpack();
    assert!(sky.radiance(Vec3::X).min_element() > 0.05, "{}", sky.radiance(Vec3::X));
    assert!(scene.to_bytes().unwrap() == bytes);
    let counts = [
        scene.vertices.len(),
        scene.points.len(),
        scene.links.links.len(),
        scene.source_links.links.len(),
        scene.light_groups.columns(),
        scene.light_groups.values.len(),
    ];
    (scene, counts)
}

fn mean(light: &[Vec3]) -> Vec3 {
    light.iter().sum::<Vec3>() / light.len() as f32
}

#[test]
fn a_file_of_version_10_means_what_it_meant() {
    let (scene, counts) = all_lights("format-10.rbn");
    assert_eq!(counts, [64, 69, 967, 982, 0, 0]);
    let bounced = mean(&relight(&scene, vec![Vec3::ONE; scene.direct_count()]));
    let bins = Box::new([Vec3::ONE; BINS]);
    let from = |sky, panel| mean(&from_sources(&scene, &scene.sources.strengths(sky, &[panel])));
    let found = [bounced, from(Some(&bins), Vec3::ZERO), from(None, Vec3::ONE)];
    for (found, then) in found.into_iter().zip(MEANS) {
        assert!((found - then).abs().max_element() < 1e-5, "{found}, not {then}");
    }
}

#[test]
fn a_fixed_solution_of_version_10_means_what_it_meant() {
    let (scene, counts) = all_lights("format-10-solved.rbn");
    assert_eq!(counts, [64, 21, 0, 0, 8, 168]);
    let own = group_strengths(&scene.meta.lights, &scene.meta.lights).unwrap();
    let light = from_groups(&scene, &own);
    let found = [mean(&light.bounced), mean(&light.direct)];
    for (found, then) in found.into_iter().zip(SOLVED) {
        assert!((found - then).abs().max_element() < 1e-4 * then.max_element(), "{found}, not {then}");
    }
}

#[test]
fn older_files_say_who_wrote_them_and_what_to_do() {
    for version in [3, 4, 5] {
        let error = BakedScene::from_bytes(&file(&format!("format-{version}.head"))).unwrap_err();
        assert!(matches!(error, RbnError::OlderVersion { found, .. } if found == version));
        let said = error.to_string();
        assert!(said.contains(&format!("by rebounce 0.1.0 in format version {version}")), "{said}");
        assert!(said.contains("rebounce bake SCENE.glb"), "{said}");
    }
}
