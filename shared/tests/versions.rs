//! Compatibility tests with files of every version: supported files keep their meaning; unsupported files name their
//! writer.
//!
//! `files/format-N.rbn` is a file of version N, baked from `baker/tests/gltf/plain.glb` by the first Rebounce with
//! version N and never regenerated (7: the Cornell box, with a wall in two places; 8 and 9: a floor, a wall and a
//! half-transparent board); `files/format-N.head` is the begin of a file of an unreleased version.

use rebounce_shared::baked::BakedScene;
use rebounce_shared::basis::ParentWeights;
use rebounce_shared::glam::Vec3;
use rebounce_shared::rbn::{RbnError, container};
use rebounce_shared::relight::relight;
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
