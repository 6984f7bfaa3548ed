//! The GPU's picture of the bounced light, by both ways, against a direct evaluation on the CPU; passes run after
//! each kind of change.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_shared::baked::BakedScene;
use rebounce_shared::footprint;
use rebounce_shared::glam::Vec3;
use rebounce_shared::kernel;
use rebounce_shared::light::{INTENSITY, Light};
use rebounce_shared::link::Link;
use rebounce_shared::rbn::LinkMatrix;
use rebounce_shared::rbn::bulk::Point;
use rebounce_shared::relight;
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use rebounce_viewer::settings::{Display, Mode, ToneMapping};
use rebounce_viewer::view::Sample;

const WIDTH: u32 = 48;
const HEIGHT: u32 = 36;

fn renderer(gpu: &Gpu, scene: &BakedScene) -> Renderer {
    let mut renderer = Renderer::new(gpu.clone()).unwrap();
    let loaded =
        pollster::block_on(GpuScene::upload(gpu, renderer.pipelines().loaders(), scene.clone())).unwrap();
    renderer.install(loaded).unwrap();
    renderer.set_tone_mapping(ToneMapping::Neutral);
    renderer
}

fn indirect(renderer: &mut Renderer) -> Vec<[f32; 4]> {
    let bytes = pollster::block_on(renderer.read_indirect(WIDTH, HEIGHT).unwrap().wait()).unwrap();
    bytemuck::pod_collect_to_vec(&bytes)
}

/// The mean of RGB in the tone-mapped picture.
fn brightness(renderer: &mut Renderer) -> f64 {
    let pixels = pollster::block_on(renderer.read_pixels(WIDTH, HEIGHT).unwrap().wait()).unwrap();
    pixels.chunks(4).map(|p| p[0] as f64 + p[1] as f64 + p[2] as f64).sum::<f64>() / pixels.len() as f64
}

/// Both ways from functions to pixels; tests of the picture apply to both.
const WAYS: [Display; 2] = [Display::Lookup, Display::Splat];

/// The bounced light, computed by this way in every pixel.
fn exact(gpu: &Gpu, scene: &BakedScene, way: Display) -> Vec<[f32; 4]> {
    let mut renderer = renderer(gpu, scene);
    renderer.set_every_pixel(true);
    renderer.set_display(way);
    let picture = indirect(&mut renderer);
    assert_eq!(renderer.stats().display, way.name());
    gpu.check().unwrap();
    picture
}

/// RMS difference between two pictures, relative to the second.
fn apart(ours: &[[f32; 4]], other: &[[f32; 4]]) -> f64 {
    let channels = || ours.iter().zip(other).flat_map(|(a, b)| (0..3).map(|c| (a[c] as f64, b[c] as f64)));
    let error: f64 = channels().map(|(a, b)| (a - b).powi(2)).sum();
    let power: f64 = channels().map(|(_, b)| b * b).sum();
    assert!(power > 0.0 && ours.len() == other.len(), "nothing to compare");
    (error / power).sqrt()
}

/// Exit point of a ray from inside the cube [-1, 1]³, with the wall's inward normal and material.
fn hit(eye: Vec3, direction: Vec3) -> (Vec3, Vec3, usize) {
    let mut best = (f32::INFINITY, Vec3::ZERO, 0);
    for axis in 0..3 {
        for (k, sign) in [1.0f32, -1.0].into_iter().enumerate() {
            // Wall 2·axis has the inward normal +axis and lies at -1.
            let t = (-sign - eye[axis]) / direction[axis];
            if t > 0.0 && t < best.0 {
                let mut normal = Vec3::ZERO;
                normal[axis] = sign;
                best = (t, normal, 2 * axis + k);
            }
        }
    }
    (eye + direction * best.0, best.1, best.2)
}

/// The bounced radiance in one direction, summed over the functions of the finest level that covers the hit.
fn radiance(scene: &BakedScene, values: &[Vec3], eye: Vec3, direction: Vec3) -> Vec3 {
    let (position, normal, wall) = hit(eye, direction);
    let color = scene.meta.materials[wall].base_color;
    for l in (0..scene.meta.levels.len()).rev() {
        let (mut sum, mut total) = (Vec3::ZERO, 0.0);
        for j in scene.level(l) {
            let p = &scene.points[j];
            let offset = position - p.position();
            if scene.cuts_of(j).iter().any(|cut| cut.ends(offset)) {
                continue;
            }
            let w = kernel::weight(offset, normal, p.normal(), p.radius);
            sum += w * values[j];
            total += w;
        }
        if total > 0.0 {
            let irradiance = sum.max(Vec3::ZERO) / total;
            return Vec3::from_slice(&color[..3]) / std::f32::consts::PI * irradiance;
        }
    }
    Vec3::ZERO
}

/// Nothing blocks light within a convex room: direct irradiance without visibility.
fn unblocked(scene: &BakedScene) -> Vec<Vec3> {
    let lights: Vec<_> = scene.meta.lights.iter().map(|l| l.source(scene.meta.origin)).collect();
    let at = |normal: Vec3, place: Vec3| -> Vec3 {
        let sum = lights.iter().filter_map(|light| light.incident(place));
        sum.map(|i| i.irradiance * normal.dot(i.to_light).max(0.0)).sum()
    };
    // Mean over the footprint, or the value at the point if the footprint has no samples.
    let at = |p: &Point| {
        let samples: Vec<u32> = (0..footprint::SAMPLES).filter(|k| p.has_sample(*k)).collect();
        let mut places: Vec<Vec3> =
            samples.iter().map(|k| p.position() + footprint::offset(*k, p.normal(), p.radius)).collect();
        if places.is_empty() {
            places.push(p.position());
        }
        places.iter().map(|place| at(p.normal(), *place)).sum::<Vec3>() / places.len() as f32
    };
    scene.points[..scene.direct_count()].iter().map(at).collect()
}

/// Relative RMS difference between the GPU's picture and the CPU's, at the same 64 places in a pixel: 16 shifts of
/// each quarter.
fn difference(scene: &BakedScene, ours: &[[f32; 4]]) -> f64 {
    let values = relight::relight(scene, unblocked(scene));
    let camera = scene.meta.cameras[0].frame(scene.meta.origin);
    let (mut error, mut power) = (0.0, 0.0);
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let mut sum = Vec3::ZERO;
            for k in 0..64 {
                let [right, down] = Sample::of_count(k / 4, 16).shift;
                let dx = ((k % 2) as f32 + 0.5 + right) / 2.0;
                let dy = ((k / 2 % 2) as f32 + 0.5 + down) / 2.0;
                let direction = camera.direction(x as f32 + dx, y as f32 + dy, WIDTH, HEIGHT);
                sum += radiance(scene, &values, camera.eye, direction) / 64.0;
            }
            let gpu = ours[(y * WIDTH + x) as usize];
            assert_eq!(gpu[3], 1.0, "a closed room covers the picture");
            for c in 0..3 {
                error += (gpu[c] as f64 - sum[c] as f64).powi(2);
                power += (sum[c] as f64).powi(2);
            }
        }
    }
    assert!(power > 0.0, "nothing to compare");
    (error / power).sqrt()
}

#[test]
fn pixels_are_the_basis_evaluated_in_every_pixel() {
    let Some(gpu) = common::gpu() else { return };
    let scene = common::room(&[3, 6, 12]);
    for way in WAYS {
        let difference = difference(&scene, &exact(&gpu, &scene, way));
        println!("{way:?}: {difference}");
        // Remaining differences: 8-bit albedo, shadow maps at the walls' corners, and edges between walls.
        assert!(difference < 0.01, "{way:?}: {difference}");
    }
}

#[test]
fn light_between_looked_up_pixels_is_nearly_the_same() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = common::room(&[3, 6, 12]);
    // Without cuts, which end every third support in the middle of a wall here: the basis is smooth.
    for point in &mut scene.points {
        point.cuts &= !7;
    }
    for way in WAYS {
        let mut interpolated = renderer(&gpu, &scene);
        interpolated.set_display(way);
        let error = apart(&indirect(&mut interpolated), &exact(&gpu, &scene, way));
        assert!(error > 1e-3, "nothing was interpolated");
        // Neighbouring functions are independent here: the roughest possible light.
        assert!(error < 0.03, "{way:?}: {error}");
    }
}

#[test]
fn the_units_of_light_do_not_matter() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = common::room(&[3, 6, 12]);
    let rebounce_shared::light::Light::Point { intensity, .. } = &mut scene.meta.lights[0] else { panic!() };
    *intensity = 3e7;
    for way in WAYS {
        let difference = difference(&scene, &exact(&gpu, &scene, way));
        assert!(difference < 0.01, "{way:?}: {difference}");
    }
}

#[test]
fn holes_take_the_next_coarser_level() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = common::room(&[3, 6, 12]);
    // Functions so small that large parts of the finest two levels' surfaces are uncovered.
    for (l, radius) in [(1, 0.15), (2, 0.04)] {
        for i in scene.level(l) {
            scene.points[i].radius = radius;
        }
    }
    for way in WAYS {
        let ours = exact(&gpu, &scene, way);
        let dark = ours.iter().filter(|p| p[0] + p[1] + p[2] == 0.0).count();
        let difference = difference(&scene, &ours);
        println!("{way:?}: {difference}");
        assert!(difference < 0.02, "{way:?}: {difference}, {dark} dark pixels");
    }
}

#[test]
fn light_is_linear() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = common::room(&[3, 6, 12]);
    // No negative values, which would be clamped to zero: light comes from above, from senders without parents.
    scene.meta.sender_levels = 1;
    let senders = scene.meta.levels[0].count;
    let all = scene.points.len() as u32;
    let rows: Vec<_> = (0..all).map(|i| vec![Link::pack(i % senders, 0.1)]).collect();
    scene.links = LinkMatrix::from_rows(&rows);
    scene.meta.later_levels = 0;
    scene.later = LinkMatrix::default();
    let lamps = [common::lamp([0.3, 0.4, 0.2]), common::lamp([-0.5, -0.3, -0.4])];
    for way in WAYS {
        let mut renderer = renderer(&gpu, &scene);
        renderer.set_display(way);
        let mut picture = |lights: &[rebounce_shared::light::Light]| {
            renderer.set_lights(lights.to_vec()).unwrap();
            indirect(&mut renderer)
        };
        let (both, first, second) = (picture(&lamps), picture(&lamps[..1]), picture(&lamps[1..]));
        let dark = picture(&[]);
        assert!(dark.iter().all(|p| p[..3] == [0.0; 3]), "no light, no light");
        let sum: Vec<_> = first.iter().zip(&second).map(|(a, b)| [0, 1, 2, 3].map(|c| a[c] + b[c])).collect();
        let error = apart(&sum, &both);
        assert!(error < 1e-3, "{way:?}: {error}");
    }
}

#[test]
fn a_still_scene_costs_nothing_and_a_moved_light_only_what_it_must() {
    let Some(gpu) = common::gpu() else { return };
    let mut renderer = renderer(&gpu, &common::room(&[3, 6]));
    let texture = common::screen(&gpu, WIDTH, HEIGHT);
    let view = texture.create_view(&Default::default());
    let draw = |renderer: &mut Renderer| {
        let mut frames = 0;
        while renderer.needs_frame() {
            renderer.draw(&view, texture.format(), WIDTH, HEIGHT).unwrap();
            frames += 1;
            assert!(frames < 100, "it never rests");
        }
        frames
    };
    assert!(draw(&mut renderer) > 1);
    let before = renderer.stats();
    assert_eq!(draw(&mut renderer), 0);
    assert_eq!((before.relights, before.shadow_layers), (1, 6));
    let camera = renderer.camera().clone();
    renderer.set_camera(rebounce_shared::camera::Camera { yfov_deg: 50.0, ..camera }).unwrap();
    draw(&mut renderer);
    assert_eq!(renderer.stats().relights, 1, "the camera does not move light");
    renderer.set_lights(vec![common::lamp([0.3, 0.4, 0.2]), common::lamp([-0.5, 0.0, 0.0])]).unwrap();
    draw(&mut renderer);
    let base = renderer.stats().shadow_layers;
    renderer.set_lights(vec![common::lamp([0.3, 0.4, 0.2]), common::lamp([-0.5, 0.1, 0.0])]).unwrap();
    draw(&mut renderer);
    assert_eq!(renderer.stats().shadow_layers - base, 6, "the light that stood still keeps its maps");
    let same = renderer.lights().to_vec();
    renderer.set_lights(same).unwrap();
    assert!(!renderer.needs_frame());
    gpu.check().unwrap();
}

#[test]
fn lights_come_and_go() {
    let Some(gpu) = common::gpu() else { return };
    let mut renderer = renderer(&gpu, &common::room(&[3, 6]));
    let spot = rebounce_shared::light::Light::Spot {
        position: [0.0; 3],
        direction: [0.0, -1.0, 0.0],
        outer_cone_deg: 40.0,
        inner_cone_deg: None,
        intensity: 1.0,
        color: [1.0; 3],
        radius: 0.0,
    };
    let lamp = common::lamp([0.3, 0.4, 0.2]);
    for lights in [vec![], vec![spot.clone()], vec![lamp.clone(), spot.clone()], vec![], vec![lamp, spot]] {
        let wanted = !lights.is_empty();
        renderer.set_lights(lights).unwrap();
        let lit = indirect(&mut renderer).iter().any(|p| p[0] > 0.0);
        assert_eq!(lit, wanted);
    }
    gpu.check().unwrap();
}

#[test]
fn pictures_are_lit_and_modes_add_up() {
    let Some(gpu) = common::gpu() else { return };
    let mut renderer = renderer(&gpu, &common::room(&[3, 6]));
    renderer.set_still_pictures(1);
    let mut mean = |mode| {
        renderer.set_mode(mode);
        brightness(&mut renderer)
    };
    let (all, direct, indirect) = (mean(Mode::All), mean(Mode::Direct), mean(Mode::Indirect));
    assert!(all > direct && all > indirect && direct > 1.0 && indirect > 1.0, "{all} {direct} {indirect}");
    gpu.check().unwrap();
}

#[test]
fn the_exposure_follows_light_beyond_its_latitude_only() {
    let Some(gpu) = common::gpu() else { return };
    let scene = common::room(&[3, 6]);
    let mut renderer = renderer(&gpu, &scene);
    let lights = renderer.lights().to_vec();
    let mut lit = |stops: Option<f64>| {
        let factor = stops.map_or(0.0, f64::exp2);
        let scaled = |light: &Light| light.with(INTENSITY.at, &[factor * light.intensity()]);
        renderer.set_lights(lights.iter().map(scaled).collect()).unwrap();
        brightness(&mut renderer)
    };
    let first = lit(Some(0.0));
    // Within a stop and a half, the picture follows the lamps.
    let within = [-1.4, -0.7, 0.0, 0.7, 1.4].map(|stops| lit(Some(stops)));
    assert!(within.windows(2).all(|pair| pair[1] > 1.1 * pair[0]), "{within:?}");
    assert_eq!(within[2], first, "it does not depend on what was shown before");
    // Beyond, the exposure adapts: the brightness stays constant under a sun and at night.
    for far in [[1.5, 6.0, 20.0], [-1.5, -6.0, -20.0]] {
        let [edge, farther, farthest] = far.map(|stops| lit(Some(stops)));
        assert!((farther - edge).abs() < 0.5 && (farthest - edge).abs() < 0.5, "{edge} {farther} {farthest}");
    }
    assert_eq!(lit(None), 0.0);
    assert_eq!(lit(Some(0.0)), first, "darkness says nothing");
    // After `rekey` the exposure is measured again.
    let dim = lit(Some(-6.0));
    renderer.rekey();
    let anew = brightness(&mut renderer);
    assert!((anew - first).abs() < 0.5 && anew > 1.2 * dim, "{anew}, not {first}; {dim}");
    gpu.check().unwrap();
}

#[test]
fn what_little_is_lit_does_not_burn_out() {
    let Some(gpu) = common::gpu() else { return };
    let mut renderer = renderer(&gpu, &common::room(&[3, 6]));
    renderer.set_mode(Mode::Direct);
    renderer.want_key(true);
    // The present and the initial factor on radiance.
    let mut keys = |outer_cone_deg: f64, intensity: f64| -> [f32; 2] {
        let [position, direction] = [[0.0; 3], [0.2, -0.1, -1.0]];
        let color = [1.0; 3];
        let inner_cone_deg = Some(0.9 * outer_cone_deg);
        let spot = Light::Spot {
            position,
            direction,
            outer_cone_deg,
            inner_cone_deg,
            intensity,
            color,
            radius: 0.0,
        };
        renderer.set_lights(vec![spot]).unwrap();
        pollster::block_on(renderer.read_pixels(96, 72).unwrap().wait()).unwrap();
        let bytes = pollster::block_on(renderer.take_measured().unwrap().wait()).unwrap();
        bytemuck::pod_read_unaligned(&bytes[..8])
    };
    let [first, begun] = keys(80.0, 1.0);
    assert_eq!(first, begun, "the first picture sets it");
    let [narrow, kept] = keys(4.0, 1.0);
    assert_eq!(kept, begun);
    // A few pixels are lit, as brightly as before: up to eight times the middle grey; the mean of all pixels would
    // demand far more.
    let [dim, _] = keys(4.0, 1e-3);
    println!("{first}; narrow {narrow}, a thousand times dimmer {dim}");
    assert!(narrow >= first && narrow < 16.0 * first, "{narrow}, {first}");
    assert!((dim / narrow - 1000.0).abs() < 50.0, "{dim}, {narrow}: it follows what is lit");
    gpu.check().unwrap();
}

#[test]
fn a_sketch_is_drawn_while_the_view_changes_and_the_whole_picture_after_it() {
    let Some(gpu) = common::gpu() else { return };
    let scene = common::room(&[3, 6]);
    let draw = |sketching: bool| {
        let mut renderer = renderer(&gpu, &scene);
        renderer.set_still_pictures(1);
        renderer.set_sketching(sketching);
        // The exposure measured on the sketch would differ slightly.
        renderer.set_auto_exposure(false);
        let target = common::screen(&gpu, WIDTH, HEIGHT);
        let view = target.create_view(&Default::default());
        let mut pictures = Vec::new();
        while renderer.needs_frame() {
            renderer.draw(&view, target.format(), WIDTH, HEIGHT).unwrap();
            let read = rebounce_viewer::readback::Readback::texture(&gpu, &target, 4);
            pictures.push(pollster::block_on(read.wait()).unwrap());
        }
        pictures
    };
    let (sketched, whole) = (draw(true), draw(false));
    assert_eq!((sketched.len(), whole.len()), (2, 1));
    assert!(sketched[1] == whole[0], "the second picture is not the whole one");
    // The sketch is the same picture, only coarser.
    let difference: f64 =
        sketched[0].iter().zip(&whole[0]).map(|(a, b)| (*a as f64 - *b as f64).abs()).sum::<f64>();
    let difference = difference / whole[0].len() as f64;
    assert!(difference > 0.0 && difference < 8.0, "{difference}");
    gpu.check().unwrap();
}
