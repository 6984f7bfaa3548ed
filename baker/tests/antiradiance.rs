//! Antiradiance beside path tracing.

use crate::gloss::{add_quad, empty, matt, metal};
use glam::Vec3;
use rebounce::bake::{BakeSettings, FixedSolver, Preset, SolveSettings, solve};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::light::illumination::Illumination;
use rebounce::transport::antiradiance::AntiradianceSettings;
use rebounce::transport::radiosity::RadiositySettings;
use rebounce::verify::compare::compare;
use rebounce::verify::expose::Exposure;
use rebounce::verify::path_trace::{self, path_trace};
use rebounce::verify::render::Relit;
use rebounce_shared::antiradiance::SolverSettings;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;

#[test]
fn the_light_that_a_metal_throws_on_a_wall_is_the_path_tracers() {
    // A metal floor under a spot, and the wall that its lobe falls on.
    let mut scene = empty(vec![metal([0.95, 0.8, 0.5], 0.4), matt([0.6; 3])], Vec3::ZERO);
    add_quad(&mut scene, Vec3::new(0.0, -0.5, 0.0), [0.5 * Vec3::Z, 0.5 * Vec3::X], 0);
    add_quad(&mut scene, Vec3::new(0.7, 0.25, 0.0), [0.6 * Vec3::Z, 0.75 * Vec3::Y], 1);
    let spot = Light::Spot {
        position: [-0.8, 0.9, 0.0],
        direction: [0.8, -1.4, 0.0],
        outer_cone_deg: 14.0,
        inner_cone_deg: Some(10.0),
        intensity: 10.0,
        color: [1.0; 3],
        radius: 0.0,
    };
    scene.lights = vec![spot];
    scene.cameras = vec![Camera {
        position: [-0.6, 0.3, 0.0],
        target: [0.7, 0.25, 0.0],
        up: [0.0, 1.0, 0.0],
        yfov_deg: 36.0,
    }];
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let illumination = Illumination::of_scene(&surfaces, &scene.lights, scene.origin, &[], None);
    let exposure = |samples, seed| Exposure { size: [32, 32], samples, seed };
    let truth = [1, 2].map(|seed| {
        let settings = path_trace::Settings { only: Only::Indirect, gloss: true, bounces: None };
        let exposure = exposure(1024, seed);
        path_trace(&surfaces, scene.origin, &scene.cameras[0], &illumination, exposure, settings, || ())
    });
    let by = |gloss| {
        let mut bake = BakeSettings::new(Preset::Draft);
        bake.place.functions = 3000;
        let solver = SolverSettings { bins: 256, ..SolverSettings::default() };
        let solver = FixedSolver::Antiradiance(AntiradianceSettings { elements: 2000, gloss, solver });
        let settings = SolveSettings { bake, radiosity: RadiositySettings::default(), solver };
        let file = solve(&scene, &settings).unwrap().0;
        let relit = Relit::new(&file, &surfaces, &scene.lights, false);
        let exposure = exposure(16, 3);
        let picture = relit.picture(&file, &surfaces, &scene.cameras[0], exposure, Only::Indirect, || ());
        let found = compare(&picture, &truth[0], Some(&truth[1])).unwrap();
        (found.error.value.or(found.error.at_most).unwrap(), found.bias)
    };
    let [(lobe, bias), (chalk, _)] = [true, false].map(by);
    println!("{lobe}, bias {bias}; as chalk {chalk}");
    // The spot's light comes by one bin, and the lobe is as wide as a bin more.
    assert!(lobe < 0.2 && bias.abs() < 0.12 && chalk > 3.0 * lobe, "{lobe} {bias} {chalk}");
}
