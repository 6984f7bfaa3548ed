//! Fixed solutions: closed forms, linearity, walls, agreement with the operator, equal bytes.

use crate::leaks::seen_in_rooms;
use glam::{DVec3, Vec3};
use rebounce::bake::{BakeSettings, FixedSolver, Preset, SolveReport, SolveSettings, bake, solve};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::scene::Scene;
use rebounce::transport::radiosity::RadiositySettings;
use rebounce::verify::render::Relit;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::light::Light;
use rebounce_shared::light_group::group_strengths;
use rebounce_shared::relight::{self, from_groups};
use std::f32::consts::PI;

fn settings(functions: usize) -> SolveSettings {
    let mut bake = BakeSettings::new(Preset::Draft);
    bake.place.functions = functions;
    bake.operator.rays = vec![512, 256, 256, 128, 128];
    SolveSettings { bake, radiosity: RadiositySettings::default(), solver: FixedSolver::Radiosity }
}

fn solved(scene: &Scene) -> (BakedScene, SolveReport) {
    solve(scene, &settings(4000)).unwrap()
}

/// Bounced irradiance at all points with the file's own lights.
fn own_light(file: &BakedScene) -> Vec<Vec3> {
    from_groups(file, &group_strengths(&file.meta.lights, &file.meta.lights).unwrap()).bounced
}

fn mean(values: impl ExactSizeIterator<Item = Vec3>) -> Vec3 {
    let count = values.len() as f32;
    values.sum::<Vec3>() / count
}

#[test]
fn a_shining_furnace_is_as_bright_everywhere_as_the_series_says() {
    let mut scene = rebounce::io::load("builtin:furnace").unwrap();
    scene.materials[0].emission = [1.0, 0.5, 0.25];
    let (file, report) = solved(&scene);
    let emissive = file.meta.lights.iter().position(|light| matches!(light, Light::Emissive { .. })).unwrap();
    let mut strengths = vec![Vec3::ZERO; file.meta.lights.len()];
    strengths[emissive] = Vec3::ONE;
    let light = from_groups(&file, &strengths);
    // Direct π L everywhere, and of that ρ / (1 − ρ) = 1 bounced.
    let expected = PI * Vec3::new(1.0, 0.5, 0.25);
    // Direct light is sampled: the noise of a point is larger than that of its bounced light.
    for (what, values, most) in [("direct", &light.direct, 0.08), ("bounced", &light.bounced, 0.05)] {
        let mean = mean(values.iter().copied());
        assert!((mean / expected - 1.0).abs().max_element() < 0.02, "{what}: {mean}, not {expected}");
        let off: f32 = values.iter().map(|value| (*value / expected - 1.0).length_squared() / 3.0).sum();
        let off = (off / values.len() as f32).sqrt();
        assert!(off < most, "{what}: {off} off in the root mean square");
    }
    // Where light does not vary, nothing fine is gathered for.
    assert!(report.samples_gathered < report.samples_generated / 2, "{report}");
}

#[test]
fn a_lamp_in_a_furnace_gives_its_walls_the_energy_of_the_series() {
    let scene = rebounce::io::load("builtin:furnace").unwrap();
    let (file, _) = solved(&scene);
    let light = own_light(&file);
    // 4π candela over walls of 24 square metres, times ρ / (1 − ρ) = 1.
    let expected = scene.lights[0].strength() * (4.0 * PI / 24.0);
    let found = mean(file.display().map(|i| light[i]));
    assert!((found / expected - 1.0).abs().max_element() < 0.02, "{found}, not {expected}");
}

/// The Cornell box with a second lamp, red.
fn two_lamps() -> Scene {
    let mut scene = rebounce::io::load("builtin:cornell-box").unwrap();
    let (low, high) = scene.bounds();
    let corner = low + (high - low) * Vec3::new(0.2, 0.3, 0.7);
    let position = (DVec3::from(scene.origin) + corner.as_dvec3()).to_array();
    scene.lights.push(Light::Point { position, intensity: 3.0, color: [1.0, 0.1, 0.0], radius: 0.0 });
    scene
}

#[test]
fn light_is_linear_in_each_group_and_a_lamp_alone_has_the_light_of_its_group() {
    let scene = two_lamps();
    let (file, _) = solved(&scene);
    let lamps = file.meta.lights.len();
    let of =
        |lights: &[Light]| from_groups(&file, &group_strengths(&file.meta.lights, lights).unwrap()).bounced;
    let [first, second, both] = [&scene.lights[..1], &scene.lights[1..2], &scene.lights[..]].map(of);
    let doubled = of(&[
        scene.lights[0].with(rebounce_shared::light::INTENSITY.at, &[2.0 * scene.lights[0].intensity()])
    ]);
    assert!(lamps >= 2 && first.iter().any(|e| *e != Vec3::ZERO) && second.iter().any(|e| *e != Vec3::ZERO));
    for (i, both) in both.iter().enumerate() {
        let size = 1e-5 * (1.0 + both.max_element());
        assert!((first[i] + second[i] - *both).abs().max_element() < size);
        assert!((2.0 * first[i] - doubled[i]).abs().max_element() < 2.0 * size);
    }
    // The red lamp's light has its colour, though it was solved for in white: no blue.
    assert!(second.iter().all(|e| e.z == 0.0));
    let alone = |number: usize| {
        let mut scene = scene.clone();
        scene.lights = vec![scene.lights[number].clone()];
        let (file, _) = solved(&scene);
        let light = own_light(&file);
        mean(file.display().map(|i| light[i]))
    };
    for (number, group) in [&first, &second].into_iter().enumerate() {
        let (alone, group) = (alone(number), mean(file.display().map(|i| group[i])));
        // Alone, other receivers are refined.
        assert!((alone - group).length() < 0.04 * group.length(), "{alone} alone, {group} in its group");
    }
}

#[test]
fn the_light_is_that_of_the_operator() {
    let scene = rebounce::io::load("builtin:cornell-box").unwrap();
    let settings = settings(12_000);
    let (file, _) = solve(&scene, &settings).unwrap();
    let (baked, _) = bake(&scene, &settings.bake, &()).unwrap();
    assert_eq!(file.points.len(), baked.points.len());
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let [ours, theirs] = [&file, &baked].map(|file| Relit::new(file, &surfaces, &scene.lights, false));
    let (mut difference, mut power, mut sums) = (0.0, 0.0, [Vec3::ZERO; 2]);
    for i in baked.display() {
        let (position, normal) = (baked.points[i].position(), baked.points[i].normal());
        let [ours, theirs] = [&ours, &theirs].map(|relit| relit.interpolated(position, normal, 0));
        difference += (ours - theirs).length_squared();
        power += theirs.length_squared();
        sums = [sums[0] + ours, sums[1] + theirs];
    }
    let error = (difference / power).sqrt();
    let bias = (sums[0] / sums[1] - 1.0).abs().max_element();
    assert!(error < 0.08 && bias < 0.03, "error {error}, bias {bias}");
    assert!(error > 1e-4, "two solvers, one light: {error}");
}

#[test]
fn a_file_has_the_same_bytes_at_any_number_of_threads_and_comes_back() {
    let scene = two_lamps();
    let bytes = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solved(&scene).0.to_bytes().unwrap())
    };
    let first = bytes(1);
    assert!(first == bytes(3) && first == bytes(3));
    let (file, _) = solved(&scene);
    let back = BakedScene::from_bytes(&first).unwrap();
    assert_eq!(back.light_groups, file.light_groups);
    assert!(back.is_solved() && back == file && back.to_bytes().unwrap() == first);
    // No links are left, and relighting by them gives nothing.
    assert!(relight::relight(&back, vec![Vec3::ONE; back.direct_count()]).iter().all(|e| *e == Vec3::ZERO));
}

#[test]
fn no_light_passes_through_walls() {
    for functions in [3000, 16_000] {
        let scene = rebounce::io::load("builtin:two-rooms").unwrap();
        let (file, _) = solve(&scene, &settings(functions)).unwrap();
        let (lit, other, greatest) = seen_in_rooms(&scene, &file);
        assert!(lit > 1.0, "{lit}");
        assert!(other <= 1e-3 * lit && greatest <= 1e-2 * lit, "{other}, at most {greatest}, beside {lit}");
    }
}

#[test]
fn finer_thresholds_gather_for_more() {
    let scene = rebounce::io::load("builtin:cornell-box").unwrap();
    let gathered = |epsilon_e: f32| {
        let mut settings = settings(4000);
        settings.radiosity.epsilon_e = epsilon_e;
        solve(&scene, &settings).unwrap().1.samples_gathered
    };
    let [coarse, fine] = [1.0, 0.02].map(gathered);
    assert!(2 * coarse < fine, "{coarse}, {fine}");
}
