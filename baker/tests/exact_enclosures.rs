//! Irradiance on exact faces against closed forms: by rays from points, and by wavelets.
//!
//! | enclosure | law |
//! |---|---|
//! | sphere, of which a cap shines | irradiance is the same everywhere: radiosity times the cap's part of the area |
//! | cylinder with two disks, of which one disk shines | disk to disk ½ (X − √(X² − 4)), X = 2 + (h/r)²; the rest falls on the side |
//! | the same, at points | of the side, a height z above the disk: (Z² + ½) / √(Z² + 1) − Z, Z = z / 2r; of the other disk, off the middle by a: ½ (1 − (h² + a² − r²) / √((h² + a² + r²)² − 4 r² a²)) |
//! | torus in a closed sphere | all of one reflectance ρ and radiosity of their own (1 − ρ) B: radiosity and irradiance are B everywhere, also where the torus sees itself |
//! | white torus under an even sky | radiance L everywhere |
//!
//! View factors: Howell, A Catalog of Radiation Heat Transfer Configuration Factors (C-41, B-13, B-31).
#![cfg(feature = "exact-faces")]

use glam::{DAffine3, DVec2, DVec3, Vec2, Vec3};
use rayon::prelude::*;
use rebounce::bake::{BakeSettings, Preset, bake};
use rebounce::geometry::{Ray, SceneSurfaces, Surfaces};
use rebounce::io::picture::Only;
use rebounce::light::far::UniformEnvironment;
use rebounce::light::illumination::Illumination;
use rebounce::random::Stream;
use rebounce::scene::Scene;
use rebounce::scene::assembly::AssemblySettings;
use rebounce::shared::relight;
use rebounce::transport::wavelet::{
    Order, ScenePatches, WaveletPatch, WaveletSettings, WaveletSolution, solve,
};
use rebounce::verify::path_trace::{Settings, radiance};
use rebounce_cad::face::Face;
use rebounce_cad::frame::Frame;
use rebounce_cad::model::{Assembly, Part, PartInstance};
use rebounce_cad::surface::Surface;
use rebounce_cad::trim::{TrimEdge, TrimLoop};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Radius and height of the cylinder.
const RADIUS: f64 = 0.7;
const HEIGHT: f64 = 1.5;
/// Radii of the torus, and of the sphere around it.
const TORUS: [f64; 2] = [0.6, 0.35];
const AROUND: f64 = 1.6;
/// Colours of faces: red says which ones shine.
const BRIGHT: Vec3 = Vec3::new(1.0, 1.0, 0.0);
const DARK: Vec3 = Vec3::new(0.0, 1.0, 0.0);

fn rectangle(low: DVec2, high: DVec2) -> TrimLoop {
    let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    (0..4).map(|i| TrimEdge::Segment { from: corners[i], to: corners[(i + 1) % 4] }).collect()
}

fn upright(origin: DVec3) -> Frame {
    Frame { origin, x: DVec3::Z, y: DVec3::X, z: DVec3::Y }
}

/// A disk about the y axis that faces up or down.
fn disk(at: f64, is_reversed: bool) -> Face {
    let edges = TrimEdge::Arc { centre: DVec2::ZERO, radii: DVec2::splat(RADIUS), angles: [0.0, TAU] };
    let surface = Surface::Plane(upright(at * DVec3::Y));
    Face { surface, is_reversed, loops: vec![vec![edges]] }
}

/// A closed cylinder that faces inward; its bottom is of the first colour.
fn can() -> Vec<(Face, Vec3)> {
    let surface = Surface::Cylinder { frame: upright(DVec3::ZERO), radius: RADIUS };
    let loops = vec![rectangle(DVec2::ZERO, DVec2::new(TAU, HEIGHT))];
    let side = Face { surface, is_reversed: true, loops };
    vec![(disk(0.0, false), BRIGHT), (side, DARK), (disk(HEIGHT, true), DARK)]
}

/// The part of a sphere about the origin between two latitudes.
fn zone(radius: f64, latitudes: [f64; 2], is_reversed: bool) -> Face {
    let surface = Surface::Sphere { frame: upright(DVec3::ZERO), radius };
    let [low, high] = latitudes;
    Face { surface, is_reversed, loops: vec![rectangle(DVec2::new(0.0, low), DVec2::new(TAU, high))] }
}

/// A whole torus about the y axis.
fn torus() -> Face {
    let surface = Surface::Torus { frame: upright(DVec3::ZERO), major: TORUS[0], minor: TORUS[1] };
    Face { surface, is_reversed: false, loops: vec![rectangle(DVec2::ZERO, DVec2::splat(TAU))] }
}

/// A scene of closed bodies, each a list of faces and colours.
fn scene(bodies: Vec<Vec<(Face, Vec3)>>) -> Scene {
    let mut all = Assembly::default();
    for (part, faces) in bodies.into_iter().enumerate() {
        let faces = faces.into_iter().map(|(face, colour)| (face, Some(colour))).collect();
        all.parts.push(Part { name: format!("body {part}"), faces, is_closed: true });
        all.instances.push(PartInstance { part, path: Vec::new(), world_from_part: DAffine3::IDENTITY });
    }
    Scene::of_assembly("test", "test".to_owned(), &all, &AssemblySettings::default()).unwrap()
}

/// Irradiance at a point of a face, by rays on a grid of the hemisphere: the mean of what they see of the colour.
fn gathered(scene: &Scene, surfaces: &SceneSurfaces, face: usize, at: DVec2) -> Vec3 {
    const SIDE: u32 = 200;
    let cast = &scene.brep.as_ref().unwrap().faces[face].cast;
    let normal = cast.normal(at).as_vec3();
    let origin = (cast.surface().point(at) - DVec3::from(scene.origin)).as_vec3();
    let origin = origin + surfaces.epsilon_at(origin) * normal;
    let (x, y) = normal.any_orthonormal_pair();
    let seen = |i: u32| {
        let mut stream = Stream::new(9, i.into());
        let cell = Vec2::new((i % SIDE) as f32, (i / SIDE) as f32);
        let unit = (cell + Vec2::new(stream.unit(), stream.unit())) / SIDE as f32;
        let (sine, cosine) = (unit.y * std::f32::consts::TAU).sin_cos();
        let radius = unit.x.sqrt();
        let direction = radius * (cosine * x + sine * y) + (1.0 - unit.x).max(0.0).sqrt() * normal;
        let hit = surfaces.cast(&Ray::visibility(origin, direction.normalize()), i);
        hit.map_or(Vec3::ZERO, |hit| if hit.faces(direction) { hit.albedo } else { Vec3::ZERO })
    };
    let all = (0..SIDE * SIDE).into_par_iter().map(|i| seen(i).as_dvec3());
    (all.collect::<Vec<_>>().into_iter().sum::<DVec3>() / f64::from(SIDE * SIDE)).as_vec3()
}

/// Wavelets between the faces of a scene, for albedo and radiosity by colour.
fn solved(
    scene: &Scene,
    look: impl Fn(Vec3) -> [Vec3; 2],
    settings: &WaveletSettings,
) -> (Vec<WaveletPatch>, WaveletSolution) {
    let surfaces = SceneSurfaces::from_scene(scene);
    let found = ScenePatches::new(scene, surfaces.epsilon()).unwrap();
    assert_eq!(found.unmapped, 0);
    let mut patches = found.with_emission(&[], &[]);
    for patch in &mut patches {
        [patch.albedo, patch.emission] = look(patch.albedo);
    }
    let solution = solve(&patches, &surfaces, |_, _| Vec3::ZERO, settings, |_| Ok(())).unwrap();
    (patches, solution)
}

/// Only red shines, and nothing reflects.
fn red_shines(colour: Vec3) -> [Vec3; 2] {
    [Vec3::ZERO, Vec3::splat(colour.x)]
}

/// Points of a patch on a grid of its square, which must be all real, or those of them that are.
fn grid(patch: &WaveletPatch, side: u32) -> impl Iterator<Item = DVec2> {
    let points = (0..side * side).map(move |i| DVec2::new(f64::from(i % side), f64::from(i / side)));
    points.map(move |cell| (cell + 0.5) / f64::from(side)).filter(|st| patch.mesh.is_real(*st))
}

fn close(found: f64, expected: f64, what: &str) {
    println!("{what}: {found} and {expected}");
    assert!((found / expected - 1.0).abs() < 0.005, "{what}: {found} and {expected}");
}

/// From the shining disk to the other one, as a whole.
fn disk_to_disk() -> f64 {
    let x: f64 = 2.0 + (HEIGHT / RADIUS).powi(2);
    0.5 * (x - (x * x - 4.0).sqrt())
}

/// From a point of the side to the shining disk.
fn from_side(height: f64) -> f64 {
    let z = height / (2.0 * RADIUS);
    (z * z + 0.5) / (z * z + 1.0).sqrt() - z
}

/// From a point of the other disk to the shining one.
fn from_disk(aside: f64) -> f64 {
    let [h, a, r] = [HEIGHT, aside, RADIUS].map(|length| length * length);
    0.5 * (1.0 - (h + a - r) / ((h + a + r).powi(2) - 4.0 * r * a).sqrt())
}

#[test]
fn rays_find_the_irradiance_of_a_disk_within_a_closed_cylinder() {
    let scene = scene(vec![can()]);
    let surfaces = SceneSurfaces::from_scene(&scene);
    for (i, height) in [0.02, 0.2, 0.7, 1.2, 1.47].into_iter().enumerate() {
        let found = gathered(&scene, &surfaces, 1, DVec2::new(1.3 * i as f64, height));
        assert_eq!(found.y, 1.0, "all rays end on fronts");
        close(f64::from(found.x), from_side(height), &format!("side at {height}"));
    }
    for (i, aside) in [0.0, 0.2, 0.5, 0.68].into_iter().enumerate() {
        let found = gathered(&scene, &surfaces, 2, aside * DVec2::from_angle(1.1 * i as f64));
        assert_eq!(found.y, 1.0, "all rays end on fronts");
        close(f64::from(found.x), from_disk(aside), &format!("disk at {aside}"));
    }
}

#[test]
fn wavelets_find_the_irradiance_of_a_disk_within_a_closed_cylinder() {
    let scene = scene(vec![can()]);
    for order in [Order::M1, Order::M2, Order::M3] {
        let settings = WaveletSettings { order, epsilon: 0.002, max_level: 6, ..WaveletSettings::default() };
        let (patches, solution) = solved(&scene, red_shines, &settings);
        let at = |patch: usize, st| f64::from(solution.irradiance_of_emitters(patch, st).x);
        // Means: the disk's real points stand for equal areas.
        let mean = |patch: usize| {
            let points: Vec<DVec2> = grid(&patches[patch], 200).collect();
            points.iter().map(|st| at(patch, *st)).sum::<f64>() / points.len() as f64
        };
        let across = disk_to_disk();
        close(mean(2), across, &format!("{order:?} disk"));
        // Areas: π r² shines on 2 π r h.
        close(mean(1), (1.0 - across) * RADIUS / (2.0 * HEIGHT), &format!("{order:?} side"));
        let worst = |patch: usize, expected: &dyn Fn(DVec3) -> f64| {
            let error = |st| at(patch, st) / expected(patches[patch].mesh.point(st)) - 1.0;
            grid(&patches[patch], 24).map(|st| error(st).abs()).fold(0.0, f64::max)
        };
        let side = worst(1, &|point| from_side(point.y));
        let disk = worst(2, &|point| from_disk(point.x.hypot(point.z)));
        println!("{order:?} worst: side {side}, disk {disk}, {:?}", solution.figures);
        // At points, cells of a constant have steps between them.
        let most = if order == Order::M1 { 0.025 } else { 0.005 };
        assert!(side < most && disk < most, "{order:?}: {side} {disk}");
    }
}

#[test]
fn irradiance_within_a_sphere_is_the_same_everywhere() {
    let latitude: f64 = 0.6;
    let [bottom, top] = [[-FRAC_PI_2, latitude], [latitude, FRAC_PI_2]];
    let scene = scene(vec![vec![(zone(1.0, bottom, true), DARK), (zone(1.0, top, true), BRIGHT)]]);
    let expected = 0.5 * (1.0 - latitude.sin());
    let surfaces = SceneSurfaces::from_scene(&scene);
    for at in [[0.3, -1.5], [1.0, -0.8], [2.0, 0.0], [3.0, 0.58]] {
        let found = gathered(&scene, &surfaces, 0, at.into());
        assert_eq!(found.y, 1.0, "all rays end on fronts");
        close(f64::from(found.x), expected, &format!("rays at {at:?}"));
    }
    let found = gathered(&scene, &surfaces, 1, DVec2::new(4.0, 1.1));
    close(f64::from(found.x), expected, "rays in the cap");
    for order in [Order::M1, Order::M2, Order::M3] {
        let settings = WaveletSettings { order, epsilon: 0.005, ..WaveletSettings::default() };
        let (patches, solution) = solved(&scene, red_shines, &settings);
        let mut worst = 0.0f64;
        for (number, patch) in patches.iter().enumerate() {
            for st in grid(patch, 24) {
                let found = f64::from(solution.irradiance_of_emitters(number, st).x);
                worst = worst.max((found / expected - 1.0).abs());
            }
        }
        assert!(worst < 0.005, "{order:?}: {worst}");
    }
}

/// A torus in a closed sphere, all of a reflectance of ½.
fn furnace() -> Scene {
    let grey = Vec3::splat(0.5);
    scene(vec![vec![(torus(), grey)], vec![(zone(AROUND, [-FRAC_PI_2, FRAC_PI_2], true), grey)]])
}

/// M1 is left out: with cells of these levels its constants are up to 38 % off on the inner side of the tube.
#[test]
fn wavelets_on_a_torus_in_a_furnace_are_even() {
    let scene = furnace();
    for order in [Order::M2, Order::M3] {
        let settings =
            WaveletSettings { order, epsilon: 0.01, convergence: 0.9995, ..WaveletSettings::default() };
        let (patches, solution) = solved(&scene, |grey| [grey, 1.0 - grey], &settings);
        for (number, patch) in patches.iter().enumerate() {
            let error = |st| {
                let all = solution.irradiance(number, st) + solution.irradiance_of_emitters(number, st);
                f64::from(all.x) - 1.0
            };
            let errors: Vec<f64> = grid(patch, 24).map(error).collect();
            let count = errors.len() as f64;
            let bias = errors.iter().sum::<f64>() / count;
            let rms = (errors.iter().map(|error| error * error).sum::<f64>() / count).sqrt();
            let worst = errors.iter().map(|error| error.abs()).fold(0.0, f64::max);
            println!("{order:?} patch {number}: bias {bias}, rms {rms}, worst {worst}");
            // The mean is right; points are within what the oracle lets pass, a few shots' tolerance.
            assert!(bias.abs() < 0.005 && rms < 0.01 && worst < 0.05, "{order:?}: {bias} {rms} {worst}");
        }
    }
}

#[test]
fn a_baked_torus_in_a_furnace_is_even() {
    let mut settings = BakeSettings::new(Preset::Draft);
    settings.place.levels = 4;
    settings.place.functions = 4000;
    settings.operator.rays = vec![512, 512, 512, 256];
    let (baked, report) = bake(&furnace(), &settings, &()).unwrap();
    assert!(report.lost_share < 1e-4, "{}", report.lost_share);
    // ρ / (1 − ρ) with ρ = ½, under direct light of 1.
    let irradiance = relight::relight(&baked, vec![Vec3::ONE; baked.direct_count()]);
    let mean = irradiance.iter().sum::<Vec3>() / irradiance.len() as f32;
    let worst = irradiance.iter().map(|e| (*e - 1.0).abs().max_element()).fold(0.0, f32::max);
    assert!((mean - 1.0).abs().max_element() < 0.002, "{mean}");
    assert!(worst < 0.005, "{worst}");
}

#[test]
fn a_white_torus_under_an_even_sky_is_as_bright_as_the_sky() {
    let scene = scene(vec![vec![(torus(), Vec3::ONE)]]);
    let surfaces = SceneSurfaces::from_scene(&scene);
    let sky = UniformEnvironment(Vec3::splat(0.8));
    let illumination = Illumination::new(&surfaces, &[]).with_environment(sky);
    let settings = Settings { only: Only::All, ..Settings::default() };
    let cast = &scene.brep.as_ref().unwrap().faces[0].cast;
    for (i, v) in [0.0, 0.3, 0.5, 0.7, 0.9, 1.0].into_iter().enumerate() {
        let at = DVec2::new(1.1 * i as f64, v * PI);
        let normal = cast.normal(at).as_vec3();
        let point = (cast.surface().point(at) - DVec3::from(scene.origin)).as_vec3();
        let path = |i: u32| {
            let mut stream = Stream::new(4, i.into());
            let ray = Ray::visibility(point + 1e-2 * normal, -normal);
            radiance(&surfaces, &illumination, ray, settings, &mut stream).x
        };
        let count = 400_000;
        let all: Vec<f32> = (0..count).into_par_iter().map(path).collect();
        let mean = all.into_iter().map(f64::from).sum::<f64>() / f64::from(count);
        close(mean, 0.8, &format!("radiance at {v} of half a turn"));
    }
}
