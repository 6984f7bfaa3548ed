//! The kept sum of lights at rest plus the moving lights equals the light of all lights.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_shared::baked::BakedScene;
use rebounce_shared::light::Light;
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::pipelines::Pipelines;
use rebounce_viewer::readback::Readback;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use std::rc::Rc;

const LIGHTS: usize = 16;

/// Lights of several kinds: a single kind would hide errors in counting shadow map layers.
fn light(i: usize, shift: f64) -> Light {
    let position = [0.1 * i as f64 - 0.7, 0.5 - 0.05 * i as f64, shift];
    let (intensity, color) = (0.5 + 0.1 * i as f64, [1.0, 0.8, 0.6]);
    match i % 3 {
        0 => Light::Point { position, intensity, color, radius: 0.0 },
        1 => Light::Directional { direction: [0.3, -1.0, shift], intensity, color, radius_deg: 0.0 },
        _ => Light::Spot {
            position,
            direction: [0.2, -1.0, 0.1],
            inner_cone_deg: Some(10.0),
            outer_cone_deg: 40.0,
            intensity,
            color,
            radius: 0.0,
        },
    }
}

fn renderer(gpu: &Gpu, pipelines: &Rc<Pipelines>, scene: &BakedScene) -> Renderer {
    let mut renderer = Renderer::with(gpu.clone(), pipelines.clone());
    renderer.set_largest_shadow_map(64);
    renderer.set_still_pictures(1);
    let loaded = pollster::block_on(GpuScene::upload(gpu, pipelines.loaders(), scene.clone())).unwrap();
    renderer.install(loaded).unwrap();
    renderer
}

/// Direct and bounced light at all points under these lights.
fn light_at_points(gpu: &Gpu, renderer: &mut Renderer, lights: &[Light]) -> Vec<f32> {
    renderer.set_lights(lights.to_vec()).unwrap();
    pollster::block_on(renderer.read_pixels(4, 4).unwrap().wait()).unwrap();
    let relight = &renderer.scene().unwrap().relight;
    let read = |buffer| -> Vec<f32> {
        bytemuck::pod_collect_to_vec(&pollster::block_on(Readback::buffer(gpu, buffer).wait()).unwrap())
    };
    [read(&relight.irradiance), read(&relight.display)].concat()
}

fn relative(a: &[f32], b: &[f32]) -> f32 {
    let largest = b.iter().fold(0f32, |m, x| m.max(x.abs()));
    assert!(largest > 0.0 && a.len() == b.len(), "nothing to compare");
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) / largest
}

#[test]
fn whatever_lights_do_the_light_is_that_of_all_of_them() {
    let Some(gpu) = common::gpu() else { return };
    let (pipelines, scene) = (Rc::new(Pipelines::new(&gpu).unwrap()), common::room(&[3, 6, 12]));
    let mut ours = renderer(&gpu, &pipelines, &scene);
    let mut lights: Vec<Light> = (0..LIGHTS).map(|i| light(i, 0.1)).collect();
    let mut check = |lights: &[Light], what: &str| {
        let found = light_at_points(&gpu, &mut ours, lights);
        let all = light_at_points(&gpu, &mut renderer(&gpu, &pipelines, &scene), lights);
        let difference = relative(&found, &all);
        assert!(difference < 2e-6, "{what}: {difference}");
    };
    check(&lights, "all at rest");
    for step in 0..3 {
        lights[5] = light(5, 0.2 + 0.1 * step as f64);
        check(&lights, "one moves");
    }
    for step in 0..10 {
        lights[2] = light(2, -0.05 * step as f64);
        check(&lights, "another moves, and the first comes to rest");
    }
    lights.push(light(1, -0.4));
    check(&lights, "one more");
    lights.remove(0);
    check(&lights, "one less, and all have other places");
    if let Light::Point { intensity, .. } = &mut lights[2] {
        *intensity = 0.0;
    }
    check(&lights, "one goes out");
    lights.swap(3, 4);
    check(&lights, "two change places");
    lights.truncate(2);
    check(&lights, "two are left");
}

#[test]
fn of_sixteen_lights_only_the_one_that_moves_is_evaluated_and_has_its_shadows_drawn() {
    let Some(gpu) = common::gpu() else { return };
    let (pipelines, scene) = (Rc::new(Pipelines::new(&gpu).unwrap()), common::room(&[3, 6]));
    let mut renderer = renderer(&gpu, &pipelines, &scene);
    let mut lights: Vec<Light> = (0..LIGHTS).map(|i| light(i, 0.1)).collect();
    let mut cost = |lights: &[Light]| {
        let before = renderer.stats();
        light_at_points(&gpu, &mut renderer, lights);
        let after = renderer.stats();
        [after.lights_evaluated - before.lights_evaluated, after.shadow_layers - before.shadow_layers]
    };
    // Six points with six layers, the others with one, five of them with three cascades.
    assert_eq!(cost(&lights), [16, 46 + 15]);
    lights[0] = light(0, 0.2);
    assert_eq!(cost(&lights), [16, 6], "the first time the sum is made without it");
    for step in 0..5 {
        lights[0] = light(0, 0.3 + 0.1 * step as f64);
        assert_eq!(cost(&lights), [1, 6]);
    }
    // Brighter only: shadows are unchanged.
    if let Light::Point { intensity, .. } = &mut lights[0] {
        *intensity *= 2.0;
    }
    assert_eq!(cost(&lights), [1, 0]);
    assert_eq!(cost(&lights), [0, 0], "nothing has changed");
}
