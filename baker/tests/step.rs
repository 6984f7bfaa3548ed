//! A STEP file is baked and solved on its exact faces: tube.step has a plate, a wall and a tube, in millimetres, z up.
#![cfg(feature = "step")]

use glam::Vec3;
use rebounce::bake::{BakeSettings, FixedSolver, Preset, SolveSettings, bake, solve};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{SceneSurfaces, Surfaces};
use rebounce::io::files::Memory;
use rebounce::io::picture::{Only, Picture};
use rebounce::io::{LoadOptions, load_from};
use rebounce::light::illumination::Illumination;
use rebounce::scene::Scene;
use rebounce::scene::material_look::MaterialLook;
use rebounce::shared::baked::BakedScene;
use rebounce::shared::camera::Camera;
use rebounce::shared::light::Light;
use rebounce::transport::radiosity::RadiositySettings;
use rebounce::transport::wavelet::WaveletSettings;
use rebounce::verify::compare::compare;
use rebounce::verify::expose::Exposure;
use rebounce::verify::path_trace::{Settings, path_trace};
use rebounce::verify::render::render;
use std::path::Path;

const SIZE: [u32; 2] = [96, 64];

fn scene() -> Scene {
    let files: Memory = [("tube.step", include_bytes!("step/tube.step").to_vec())].into_iter().collect();
    let mut scene = load_from(&files, Path::new("tube.step"), &LoadOptions::default()).unwrap();
    scene.lights.push(Light::Spot {
        position: [0.15, 0.6, 0.35],
        direction: [-0.25, -1.0, -0.75],
        outer_cone_deg: 30.0,
        inner_cone_deg: None,
        intensity: 2.0,
        color: [1.0; 3],
        radius: 0.0,
    });
    scene.cameras.push(Camera {
        position: [0.35, 0.4, 0.7],
        target: [0.0, 0.05, -0.05],
        up: [0.0, 1.0, 0.0],
        yfov_deg: 35.0,
    });
    scene
}

fn traced(scene: &Scene, surfaces: &impl Surfaces, seed: u64) -> Picture {
    let illumination = Illumination::of(surfaces, &scene.lights, scene.origin, 1.0);
    let exposure = Exposure { size: SIZE, samples: 256, seed };
    let settings = Settings { only: Only::Indirect, ..Settings::default() };
    path_trace(surfaces, scene.origin, &scene.cameras[0], &illumination, exposure, settings, || ())
}

/// Error and bias of the bounced light of a file against the path tracer on the exact faces.
fn error(scene: &Scene, file: &BakedScene) -> [f64; 2] {
    let exact = SceneSurfaces::from_scene(scene);
    let shown = TriangleSurfaces::from_baked(file).unwrap();
    let exposure = Exposure { size: SIZE, samples: 16, seed: 3 };
    let picture = render(file, &shown, &scene.cameras[0], &scene.lights, exposure, Only::Indirect, || ());
    let found = compare(&picture, &traced(scene, &exact, 1), Some(&traced(scene, &exact, 2))).unwrap();
    [found.error.value.or(found.error.at_most).unwrap(), found.bias]
}

fn settings() -> BakeSettings {
    let mut settings = BakeSettings::new(Preset::Draft);
    settings.place.functions = 6_000;
    settings
}

#[test]
fn the_file_is_read_in_metres_with_y_up_and_has_its_names_and_colours() {
    let scene = scene();
    assert_eq!(scene.left_out, Vec::<String>::new());
    let names: Vec<&str> = scene.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["tube", "plate", "wall"]);
    assert_eq!(scene.materials[2].base_color, [0.7, 0.15, 0.1, 1.0]);
    let (low, high) = scene.bounds();
    assert!((high - low).distance(Vec3::new(0.5, 0.3, 0.42)) < 1e-3, "{}", high - low);
    let brep = scene.brep.as_ref().unwrap();
    assert_eq!((brep.faces.len(), brep.instances.len()), (16, 3));
}

#[test]
fn the_path_tracer_finds_the_same_light_on_faces_and_on_fine_triangles() {
    let scene = scene();
    let [exact, triangles] = [
        traced(&scene, &SceneSurfaces::from_scene(&scene), 1),
        traced(&scene, &TriangleSurfaces::from_scene(&scene), 2),
    ];
    let mean = |picture: &Picture| picture.pixels.iter().sum::<Vec3>().element_sum();
    let ratio = mean(&exact) / mean(&triangles);
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}

#[test]
fn a_bake_and_wavelets_have_the_path_tracers_light() {
    let scene = scene();
    let (baked, report) = bake(&scene, &settings(), &()).unwrap();
    assert_eq!(report.ray_triangles, 0);
    let [of_bake, bias] = error(&scene, &baked);
    assert!(of_bake < 0.15 && bias.abs() < 0.04, "{of_bake} {bias}");
    let solver =
        FixedSolver::Wavelet(WaveletSettings { epsilon: 0.1, max_level: 4, ..WaveletSettings::default() });
    let settings = SolveSettings { bake: settings(), radiosity: RadiositySettings::default(), solver };
    let (solved, report) = solve(&scene, &settings).unwrap();
    let report = report.wavelet.unwrap();
    assert_eq!((report.faces, report.unmapped_faces), (16, 0));
    assert!(report.convergence >= 0.99);
    let [of_wavelets, bias] = error(&scene, &solved);
    assert!(of_wavelets < 0.15 && bias.abs() < 0.05, "{of_wavelets} {bias}");
    println!("bake {of_bake}, wavelets {of_wavelets}");
}

#[test]
fn a_bake_has_the_same_bytes_twice() {
    let mut settings = settings();
    settings.place.functions = 1_000;
    let bytes = || bake(&scene(), &settings, &()).unwrap().0.to_bytes().unwrap();
    assert!(bytes() == bytes());
}

#[test]
fn parts_may_shine_and_are_triangles_for_rays_then() {
    let mut scene = scene();
    let look = |emission| MaterialLook { emission: Some(emission), ..MaterialLook::default() };
    let looks =
        [("tube".to_owned(), look([5.0; 3])), ("vase".to_owned(), look([1.0; 3]))].into_iter().collect();
    assert_eq!(scene.apply_looks(&looks), ["vase"]);
    let surfaces = SceneSurfaces::from_scene(&scene);
    assert_eq!(scene.is_exact(), [false, true, true]);
    assert!(surfaces.emitters().unwrap().emitter_count() > 100);
    assert!(rebounce::scene::emissive_groups(&scene)[0].name == "tube");
}
