//! Pictures of a fixed solution in the viewer are the CPU's, for every mix of its lights; lights stay in their places.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;
use crate::environment::open_box;

use common::{difference, indirect, mean_and_stops, picture};
use glam::Vec3;
use rebounce::bake::{FixedSolver, SolveSettings, solve};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::transport::radiosity::RadiositySettings;
use rebounce::transport::wavelet::WaveletSettings;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::{Content, render};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::environment::{Environment, PackedEnvironment};
use rebounce_shared::light::{COLOR, INTENSITY, Light, LightKind, POSITION};
use rebounce_shared::mix::{Channel, mixed};
use rebounce_shared::rbn::lightmap::TexelCoordinates;
use rebounce_tests::small::settings;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::settings::Mode;

const SIZE: [u32; 2] = [64, 64];

fn solved() -> BakedScene {
    let bake = settings(2400);
    let radiosity = RadiositySettings { rays: vec![256], ..RadiositySettings::default() };
    let file =
        solve(&open_box(false, false), &SolveSettings { bake, radiosity, solver: FixedSolver::Radiosity })
            .unwrap()
            .0;
    let kinds: Vec<LightKind> = file.meta.lights.iter().map(Light::kind).collect();
    assert_eq!(kinds, [LightKind::Environment, LightKind::Point, LightKind::Emissive]);
    assert_eq!(file.light_groups.columns(), 5);
    // As a page reads it.
    BakedScene::from_bytes(&file.to_bytes().unwrap()).unwrap()
}

/// Radiance of the CPU.
fn truth(scene: &BakedScene, lights: &[Light], only: Only) -> Vec<Vec3> {
    let surfaces = TriangleSurfaces::from_baked(scene).unwrap();
    let exposure = Exposure { size: SIZE, samples: 64, seed: 5 };
    let content = Content { only, detail: false };
    render(scene, &surfaces, &scene.meta.cameras[0], lights, exposure, content, || ()).pixels
}

/// The bounced light of the viewer, compared with the CPU's for these lights; returns the CPU's.
fn compare(name: &str, scene: &BakedScene, renderer: &mut Renderer, lights: &[Light]) -> Vec<Vec3> {
    let truth = truth(scene, lights, Only::Indirect);
    let (error, bias) = difference(&indirect(renderer, SIZE), &truth);
    println!("{name}: {error:.4}, bias {bias:+.4}");
    assert!(error < 0.03 && bias.abs() < 0.01, "{name}: {error}, bias {bias}");
    truth
}

#[test]
fn a_lightmap_is_mixed_as_on_the_cpu() {
    let bake = settings(2400);
    let wavelets = WaveletSettings { convergence: 0.9, max_level: 3, ..WaveletSettings::default() };
    let solver = FixedSolver::Wavelet(wavelets);
    let settings = SolveSettings { bake, radiosity: RadiositySettings::default(), solver };
    let file = solve(&open_box(false, false), &settings).unwrap().0;
    let scene = BakedScene::from_bytes(&file.to_bytes().unwrap()).unwrap();
    assert_eq!(scene.lightmap.layout.scales.len(), 5);
    let Some(mut renderer) = common::renderer(&scene) else { return };
    renderer.set_detail(false);
    let own = scene.meta.lights.clone();
    let whole = compare("lightmap", &scene, &mut renderer, &own);
    let fewer = [own[1].with(INTENSITY.at, &[9.0]).with(COLOR.at, &[1.0, 0.1, 0.0])];
    renderer.set_lights(fewer.to_vec()).unwrap();
    let red = compare("lightmap of one lamp", &scene, &mut renderer, &fewer);
    assert!(difference(&whole, &red).0 > 0.1, "the lights change the picture");
    // Triangles without a chart have the light of the points beside those that have one.
    let mut partial = scene.clone();
    let (half, count) = (partial.indices.len() / 6 * 3, partial.vertices.len());
    let mut is_left_out = vec![false; count];
    partial.indices[..half].iter().for_each(|i| is_left_out[*i as usize] = true);
    partial.indices[half..].iter().for_each(|i| is_left_out[*i as usize] = false);
    for (at, out) in partial.lightmap.coordinates.iter_mut().zip(is_left_out) {
        *at = if out { TexelCoordinates::NONE } else { *at };
    }
    let Some(mut renderer) = common::renderer(&partial) else { return };
    renderer.set_detail(false);
    compare("half a lightmap", &partial, &mut renderer, &own);
}

#[test]
fn a_fixed_solution_is_mixed_as_on_the_cpu() {
    let scene = solved();
    let Some(mut renderer) = common::renderer(&scene) else { return };
    renderer.set_detail(false);
    let own = scene.meta.lights.clone();
    assert_eq!(renderer.lights(), own);
    let mut seen = vec![compare("as solved", &scene, &mut renderer, &own)];
    // Each group alone, in other strengths and colours; the sky in its own.
    for alone in 0..own.len() {
        let mut mix = vec![Channel::default(); own.len()];
        mix[alone] = Channel { solo: true, stops: 1.0 - alone as f64, ..Channel::default() };
        mix[alone].color = (alone > 0).then_some([0.2, 0.5, 1.0]);
        renderer.set_mix(mix.clone()).unwrap();
        seen.push(compare(&format!("{alone} alone"), &scene, &mut renderer, &mixed(&own, &mix)));
    }
    // By the lights themselves, and one is removed.
    renderer.set_mix(Vec::new()).unwrap();
    let fewer = [own[2].with(COLOR.at, &[1.0, 0.1, 0.0]), own[1].with(INTENSITY.at, &[9.0])];
    renderer.set_lights(fewer.to_vec()).unwrap();
    seen.push(compare("fewer", &scene, &mut renderer, &fewer));
    for (i, a) in seen.iter().enumerate() {
        for b in &seen[..i] {
            assert!(difference(a, b).0 > 0.1, "the lights change the picture");
        }
    }
    // All of the picture, and its direct light: of lamps by shadow maps, of sky and panel by the points.
    renderer.set_backdrop(false);
    let plain = [own[2].clone(), own[1].with(INTENSITY.at, &[9.0])];
    renderer.set_lights(plain.to_vec()).unwrap();
    let truth = truth(&scene, &plain, Only::All);
    let (_, stops) = mean_and_stops(&truth);
    let [all, direct] = [Mode::All, Mode::Direct].map(|mode| {
        renderer.set_mode(mode);
        picture(&mut renderer, SIZE, stops)
    });
    let even: Vec<usize> =
        (0..truth.len()).filter(|at| truth[*at].max_element() < 0.7 * (-stops).exp2()).collect();
    let part = |pixels: &[Vec3]| even.iter().map(|at| pixels[*at]).collect::<Vec<_>>();
    let (error, bias) = difference(&part(&all), &part(&truth));
    println!("all: {error:.4}, bias {bias:+.4}, {} pixels", even.len());
    assert!(even.len() > truth.len() / 4 && error < 0.15 && bias.abs() < 0.02, "{error}, {bias}");
    let sum = |pixels: &[Vec3]| pixels.iter().map(|p| p.element_sum()).sum::<f32>();
    assert!(sum(&part(&direct)) < 0.95 * sum(&part(&all)), "direct light alone is less");
    renderer.gpu().check().unwrap();
}

#[test]
fn lights_and_sky_of_a_fixed_solution_stay_in_their_places() {
    let scene = solved();
    let Some(mut renderer) = common::renderer(&scene) else { return };
    let own = scene.meta.lights.clone();
    let before = indirect(&mut renderer, SIZE);
    let moved = own[1].with(POSITION.at, &[0.5, 2.5, -2.0]);
    let added = Light::Point { position: [0.0; 3], intensity: 1.0, color: [1.0; 3], radius: 0.0 };
    let mut turned = own[0].clone();
    let Light::Environment { rotation_deg, .. } = &mut turned else { panic!() };
    *rotation_deg += 90.0;
    let lists = [vec![own[0].clone(), moved], vec![turned], [&own[..], &[added]].concat()];
    for (number, lights) in [1, 0, 3].into_iter().zip(lists) {
        let told = renderer.set_lights(lights).unwrap_err();
        assert_eq!(told.code(), "bad-argument");
        let told = told.to_string();
        assert!(told.contains(&format!("light {number},")) && told.contains("rebounce bake"), "{told}");
        assert_eq!(renderer.lights(), own, "the old lights stay");
    }
    let picture = Environment { width: 8, height: 4, pixels: vec![Vec3::ONE; 32] };
    let told = renderer.set_environment(Some(PackedEnvironment::new(&picture))).unwrap_err().to_string();
    assert!(told.contains("own sky"), "{told}");
    renderer.set_environment(None).unwrap();
    let after = indirect(&mut renderer, SIZE);
    assert!(difference(&after, &before).0 < 1e-6, "the picture is the same");
    // A size is of the lamp's direct light alone.
    let mut wide = own.clone();
    let Light::Point { radius, .. } = &mut wide[1] else { panic!() };
    *radius = 0.1;
    renderer.set_lights(wide).unwrap();
    renderer.gpu().check().unwrap();
}
