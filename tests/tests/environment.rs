//! A room without a ceiling under a sky, with a shining panel: light at the points and pictures of the viewer are the
//! CPU's.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use common::{difference, indirect, mean_and_stops, picture};
use glam::Vec3;
use rebounce::bake::bake;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::light::direct::at_footprint;
use rebounce::scene::Scene;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::{Content, packed_environment, render};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::environment::Environment;
use rebounce_shared::light::Light;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::random::Stream;
use rebounce_shared::rbn::extras::Extras;
use rebounce_shared::rbn::meta::Material;
use rebounce_shared::relight;
use rebounce_tests::small::{add_parallelogram, settings};
use rebounce_viewer::readback::Readback;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::settings::Mode;
use std::sync::Arc;

const WIDTH: u32 = 80;
const HEIGHT: u32 = 80;

/// A blue sky over a brown ground, uneven, with a sun of about 2° if there is to be one.
fn sky(has_sun: bool) -> Environment {
    let (width, height) = (128, 64);
    let mut stream = Stream::new(5, 5);
    let mut pixels: Vec<Vec3> = (0..width * height)
        .map(|i| {
            let (x, y) = (i % width, i / width);
            let turn = 1.0 + 0.6 * (x as f32 / width as f32 * std::f32::consts::TAU).cos();
            let colour = if y < height / 2 { Vec3::new(0.5, 0.7, 1.0) } else { Vec3::new(0.2, 0.15, 0.1) };
            colour * turn * (0.9 + 0.2 * stream.sphere().x.abs())
        })
        .collect();
    if has_sun {
        pixels[(14 * width + 90) as usize] = Vec3::new(3000.0, 2700.0, 2200.0);
    }
    Environment { width, height, pixels }
}

/// The Cornell box without its ceiling, under a sky, with a lamp and a panel that shines; with `glass`, a pane in the open
/// front instead.
pub fn open_box(has_sun: bool, glass: bool) -> Scene {
    let mut room = rebounce::io::load("builtin:cornell-box").unwrap();
    let (_, high) = room.bounds();
    let is_below = |t: &[u32; 3]| t.iter().any(|i| room.positions[*i as usize].y < high.y - 0.1);
    let kept: Vec<bool> = room.triangles.iter().map(is_below).collect();
    let mut keeps = kept.iter();
    room.triangle_material.retain(|_| *keeps.next().unwrap());
    let mut keeps = kept.iter();
    room.triangles.retain(|_| *keeps.next().unwrap());
    let (at, sides) = match glass {
        true => (Vec3::new(-0.3, 0.0, 0.95), [Vec3::X * 0.6, Vec3::Y * 0.8]),
        false => (Vec3::new(0.0, 0.2, -0.9), [Vec3::X * 0.4, Vec3::Y * 0.3]),
    };
    let material = match glass {
        true => Material {
            base_color: [0.8, 0.4, 0.3, 1.0],
            extras: Extras { transmission: 0.8, ..Extras::default() },
            double_sided: true,
            ..Material::default()
        },
        false => {
            Material { base_color: [0.4, 0.3, 0.3, 1.0], emission: [0.6, 0.5, 0.3], ..Material::default() }
        }
    };
    add_parallelogram(&mut room, at, sides, material);
    room.environment = Some(Arc::new(sky(has_sun)));
    room.lights = vec![
        Light::Environment { file: None, rotation_deg: 20.0, intensity: 1.0, color: [1.0, 0.9, 0.8] },
        Light::Point { position: [0.5, 3.0, -2.0], intensity: 2.0, color: [1.0; 3], radius: 0.0 },
    ];
    room
}

/// Bakes [`open_box`].
fn room(has_sun: bool, glass: bool) -> BakedScene {
    let mut settings = settings(2400);
    settings.operator.rays = vec![512];
    let scene = bake(&open_box(has_sun, glass), &settings, &()).unwrap().0;
    assert!(scene.sources.has_sky && !scene.source_links.is_empty());
    // The bake adds a light for the panel.
    assert_eq!(scene.sources.groups.len(), usize::from(!glass));
    assert_eq!(scene.meta.lights.len(), 2 + scene.sources.groups.len());
    scene
}

/// Light of all points on the GPU, from the CPU's direct light of the lamps.
fn points(renderer: &Renderer, direct: &[Vec3]) -> Vec<Vec3> {
    let gpu = renderer.gpu();
    let relight = &renderer.scene().unwrap().relight;
    let rows: Vec<[f32; 4]> = direct.iter().map(|e| [e.x, e.y, e.z, 0.0]).collect();
    gpu.queue.write_buffer(&relight.irradiance, 0, bytemuck::cast_slice(&rows));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    relight.encode(&mut encoder, &renderer.pipelines().relight, None, None);
    gpu.queue.submit([encoder.finish()]);
    let bytes = pollster::block_on(Readback::buffer(gpu, &relight.display).wait()).unwrap();
    bytemuck::pod_collect_to_vec::<u8, [f32; 4]>(&bytes).iter().map(|p| Vec3::from_slice(p)).collect()
}

#[test]
fn light_of_sky_and_panel_at_all_points_is_the_cpus_after_every_change() {
    let scene = room(true, false);
    let surfaces = TriangleSurfaces::from_baked(&scene).unwrap();
    let Some(renderer) = common::renderer(&scene) else { return };
    let environment = packed_environment(&scene);
    let lights = scene.meta.lights.clone();
    let moved = |lights: &[Light]| {
        let mut lights = lights.to_vec();
        lights[1] = lights[1].with(rebounce_shared::light::POSITION.at, &[-1.0, 2.0, -4.0]);
        lights
    };
    let turned = |lights: &[Light]| {
        let mut lights = lights.to_vec();
        let Light::Environment { rotation_deg, .. } = &mut lights[0] else { panic!() };
        *rotation_deg += 90.0;
        lights
    };
    let dimmed = |lights: &[Light]| {
        let mut lights = lights.to_vec();
        lights[2] = Light::Emissive { group: 0, intensity: 0.2, color: [1.0, 0.1, 0.0] };
        lights
    };
    let second = moved(&lights);
    let third = turned(&second);
    let steps = [("first", lights), ("moved", second), ("turned", third.clone()), ("dimmed", dimmed(&third))];
    let mut before = Vec::new();
    for (name, lights) in steps {
        let lighting = Lighting::new(&lights, environment.as_ref(), scene.meta.origin, 1);
        assert_eq!(lighting.lamps.len(), 2, "the lamp and the sun");
        let direct: Vec<Vec3> = scene.points[..scene.direct_count()]
            .iter()
            .map(|point| at_footprint(&surfaces, &lighting.lamps, point))
            .collect();
        let strengths = scene.sources.strengths(lighting.sky.as_deref(), &lighting.emission);
        let from_sources = relight::from_sources(&scene, &strengths);
        let all = direct.iter().zip(&from_sources).map(|(a, b)| *a + *b).collect();
        let bounced = relight::relight(&scene, all);
        let truth: Vec<Vec3> = bounced.iter().zip(&from_sources).map(|(a, b)| *a + *b).collect();
        renderer.scene().unwrap().relight.set_strengths(renderer.gpu(), &strengths);
        let ours = points(&renderer, &direct);
        let largest = truth.iter().fold(0.0f32, |most, e| most.max(e.abs().max_element()));
        let apart =
            ours.iter().zip(&truth).fold(0.0f32, |most, (a, b)| most.max((*a - *b).abs().max_element()));
        println!("{name}: {:e} of {largest}", apart / largest);
        assert!(apart < 1e-4 * largest, "{name}: {apart}");
        assert!(before != truth);
        before = truth;
    }
    renderer.gpu().check().unwrap();
}

/// Whether a pixel and its neighbours are similar and below the tone curve's shoulder, at `most`.
fn is_even(truth: &[Vec3], at: usize, most: f32) -> bool {
    let (x, y) = (at as u32 % WIDTH, at as u32 / WIDTH);
    let around = |v: u32, end: u32| v.saturating_sub(1)..(v + 2).min(end);
    let near = around(y, HEIGHT).flat_map(|y| around(x, WIDTH).map(move |x| truth[(y * WIDTH + x) as usize]));
    near.into_iter().all(|p| {
        let difference = (p - truth[at]).abs().max_element();
        p.max_element() < most && difference <= 0.25 * truth[at].max_element()
    })
}

/// Compares pictures of the viewer with the CPU's, whose emission is multiplied by `emission`.
fn compare(
    scene: &BakedScene,
    lights: &[Light],
    emission: Vec3,
    views: &[(&str, Camera)],
    modes: &[(Mode, Only)],
) {
    let mut seen = scene.clone();
    for material in &mut seen.meta.materials {
        material.emission = (Vec3::from(material.emission) * emission).to_array();
    }
    let surfaces = TriangleSurfaces::from_baked(&seen).unwrap();
    let Some(mut renderer) = common::renderer(scene) else { return };
    renderer.set_detail(false);
    renderer.set_lights(lights.to_vec()).unwrap();
    for (name, camera) in views {
        renderer.set_camera(camera.clone()).unwrap();
        let exposure = Exposure { size: [WIDTH, HEIGHT], samples: 256, seed: 3 };
        let truth = |only| {
            let content = Content { only, detail: false };
            render(scene, &surfaces, camera, lights, exposure, content, || ()).pixels
        };
        let ours = indirect(&mut renderer, [WIDTH, HEIGHT]);
        let (error, bias) = difference(&ours, &truth(Only::Indirect));
        println!("{name}, bounced light: {error:.4}, bias {bias:+.4}");
        assert!(error < 0.03 && bias.abs() < 0.01, "{name}, bounced light: {error}, bias {bias}");
        for (mode, only) in modes {
            let truth = truth(*only);
            let (_, stops) = mean_and_stops(&truth);
            renderer.set_mode(*mode);
            let ours = picture(&mut renderer, [WIDTH, HEIGHT], stops);
            let compared: Vec<usize> =
                (0..truth.len()).filter(|at| is_even(&truth, *at, 0.7 * (-stops).exp2())).collect();
            assert!(compared.len() > truth.len() / 4, "{name}, {only:?}: {} to compare", compared.len());
            let [ours, truth] =
                [ours, truth].map(|all| compared.iter().map(|at| all[*at]).collect::<Vec<_>>());
            let (error, bias) = difference(&ours, &truth);
            println!("{name}, {only:?}: {error:.4}, bias {bias:+.4}, {} pixels", compared.len());
            assert!(error < 0.05 && bias.abs() < 0.01, "{name}, {only:?}: {error}, bias {bias}");
        }
    }
    renderer.gpu().check().unwrap();
}

#[test]
fn an_open_room_under_a_sky_with_a_shining_panel_looks_as_on_the_cpu() {
    let scene = room(true, false);
    let front = scene.meta.cameras[0].clone();
    let above =
        Camera { position: [1.5, 9.0, 4.0], target: [0.0, 3.0, -3.0], yfov_deg: 60.0, ..front.clone() };
    let up = Camera { position: [0.0, 1.0, -1.0], target: [0.3, 5.0, -4.0], yfov_deg: 80.0, ..front.clone() };
    let views = [("front", front), ("above", above), ("up", up)];
    let mut lights = scene.meta.lights.clone();
    compare(&scene, &lights, Vec3::ONE, &views, &[(Mode::All, Only::All)]);
    // Turned, and the panel brighter and red.
    let Light::Environment { rotation_deg, .. } = &mut lights[0] else { panic!() };
    *rotation_deg += 90.0;
    lights[2] = Light::Emissive { group: 0, intensity: 2.0, color: [1.0, 0.2, 0.1] };
    compare(&scene, &lights, Vec3::new(2.0, 0.4, 0.2), &views[..1], &[(Mode::All, Only::All)]);
}

#[test]
fn glass_before_the_sky_looks_as_on_the_cpu() {
    let scene = room(false, true);
    let lights = scene.meta.lights.clone();
    let within = Camera {
        position: [0.4, 2.4, -4.5],
        target: [0.0, 3.2, 0.0],
        yfov_deg: 75.0,
        ..scene.meta.cameras[0].clone()
    };
    let modes = [(Mode::Direct, Only::Direct), (Mode::All, Only::All)];
    compare(&scene, &lights, Vec3::ONE, &[("within", within)], &modes);
}
