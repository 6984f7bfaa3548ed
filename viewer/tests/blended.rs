//! Blended surfaces: in order from every view, without noise in the first picture of a view, without cost in scenes
//! without blended surfaces.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::glam::Vec3;
use rebounce_shared::light::Light;
use rebounce_shared::octahedral::pack_snorm16;
use rebounce_shared::rbn::bulk::Vertex;
use rebounce_shared::rbn::meta::{Alpha, Draw, Material};
use rebounce_viewer::blended_fit::MOST_LAYERS;
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::pipelines::Pipelines;
use rebounce_viewer::readback::Readback;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use rebounce_viewer::settings::{Mode, ToneMapping};
use std::rc::Rc;

const SIZE: u32 = 33;
/// An 8-bit step at the compared pictures, linear.
const STEP: f32 = 0.006;

/// A two-sided material with this emission and coverage.
fn glass(emission: [f32; 3], alpha: f32) -> Material {
    Material {
        base_color: [0.0, 0.0, 0.0, alpha],
        alpha: Alpha::Blend,
        double_sided: true,
        emission,
        ..Material::default()
    }
}

/// Adds the parallelogram around `centre` with half sides `u` and `v`; it faces along u × v.
fn pane(scene: &mut BakedScene, centre: Vec3, u: Vec3, v: Vec3, material: Material) {
    let (vertex, index) = (scene.vertices.len() as u32, scene.indices.len() as u32);
    let normal = pack_snorm16(u.cross(v).normalize());
    for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        let position = (centre + u * a + v * b).to_array();
        scene.vertices.push(Vertex { position, normal, uv: [a, b] });
    }
    scene.indices.extend([0, 1, 2, 0, 2, 3].map(|i| vertex + i));
    scene.meta.draws.push(Draw {
        material: scene.meta.materials.len() as u32,
        first_index: index,
        index_count: 6,
    });
    scene.meta.materials.push(material);
}

/// A room without light.
fn dark_room() -> BakedScene {
    let mut scene = common::room(&[3]);
    scene.meta.lights.clear();
    scene
}

fn camera(from: Vec3, to: Vec3) -> Camera {
    let array = |v: Vec3| v.to_array().map(f64::from);
    Camera { position: array(from), target: array(to), up: [0.0, 1.0, 0.0], yfov_deg: 50.0 }
}

fn renderer_with(gpu: &Gpu, pipelines: &Rc<Pipelines>, scene: &BakedScene) -> Renderer {
    let mut renderer = Renderer::with(gpu.clone(), pipelines.clone());
    let loaded = pollster::block_on(GpuScene::upload(gpu, pipelines.loaders(), scene.clone())).unwrap();
    renderer.install(loaded).unwrap();
    renderer.set_tone_mapping(ToneMapping::Neutral);
    renderer.set_auto_exposure(false);
    renderer
}

fn renderer(gpu: &Gpu, scene: &BakedScene) -> Renderer {
    renderer_with(gpu, &Rc::new(Pipelines::new(gpu).unwrap()), scene)
}

/// The linear radiance at a pixel of the view; its smallest channel must be 0, a value that the tone curve
/// preserves.
fn seen(renderer: &mut Renderer, from: Vec3, to: Vec3, x: u32, y: u32) -> Vec3 {
    renderer.set_camera(camera(from, to)).unwrap();
    let pixels = pollster::block_on(renderer.read_pixels(SIZE, SIZE).unwrap().wait()).unwrap();
    let at = 4 * (y * SIZE + x) as usize;
    let linear = |c: u8| {
        let c = f32::from(c) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    let rgb = [pixels[at], pixels[at + 1], pixels[at + 2]].map(linear);
    assert!(rgb.iter().all(|c| *c < 0.75) && rgb.iter().any(|c| *c < STEP), "badly exposed: {rgb:?}");
    Vec3::from(rgb)
}

fn middle(renderer: &mut Renderer, from: Vec3, to: Vec3) -> Vec3 {
    seen(renderer, from, to, SIZE / 2, SIZE / 2)
}

#[track_caller]
fn assert_near(found: Vec3, expected: Vec3) {
    assert!((found - expected).abs().max_element() < STEP, "{found}, expected {expected}");
}

const RED: Vec3 = Vec3::new(0.4, 0.0, 0.0);
const BLUE: Vec3 = Vec3::new(0.0, 0.0, 0.4);

#[test]
fn panes_lie_over_each_other_in_the_right_order_from_both_sides() {
    let Some(gpu) = common::gpu() else { return };
    // In any order and of any size.
    for swapped in [false, true] {
        let mut scene = dark_room();
        let mut panes = [(0.3, 0.5, RED, 0.5), (-0.3, 0.9, BLUE, 0.5)];
        if swapped {
            panes.reverse();
        }
        for (z, side, emission, alpha) in panes {
            let centre = Vec3::new(0.1, 0.0, z);
            pane(&mut scene, centre, Vec3::X * side, Vec3::Y * side, glass(emission.to_array(), alpha));
        }
        let mut renderer = renderer(&gpu, &scene);
        let (front, back) = (Vec3::new(0.1, 0.05, 0.9), Vec3::new(0.1, 0.05, -0.9));
        assert_near(middle(&mut renderer, front, Vec3::ZERO), 0.5 * RED + 0.25 * BLUE);
        assert_near(middle(&mut renderer, back, Vec3::ZERO), 0.5 * BLUE + 0.25 * RED);
    }
    gpu.check().unwrap();
}

#[test]
fn panes_that_cross_change_their_order_where_they_do() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = dark_room();
    for (slope, emission) in [(1.0, RED), (-1.0, BLUE)] {
        let u = Vec3::new(0.6, 0.0, 0.3 * slope);
        pane(&mut scene, Vec3::ZERO, u, Vec3::Y * 0.8, glass(emission.to_array(), 0.5));
    }
    let mut renderer = renderer(&gpu, &scene);
    let eye = Vec3::new(0.0, 0.0, 0.95);
    // On the right the red one is nearer.
    let [left, right] = [6, SIZE - 7].map(|x| seen(&mut renderer, eye, Vec3::ZERO, x, SIZE / 2));
    assert_near(right, 0.5 * RED + 0.25 * BLUE);
    assert_near(left, 0.5 * BLUE + 0.25 * RED);
    gpu.check().unwrap();
}

#[test]
fn a_glass_box_is_seen_through_both_faces_and_the_wall_behind_it() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = dark_room();
    scene.meta.materials[4].emission = BLUE.to_array();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let (mut n, mut u, mut v) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
            (n[axis], u[(axis + 1) % 3], v[(axis + 2) % 3]) = (0.3 * side, 0.3 * side, 0.3);
            pane(&mut scene, n, u, v, glass(RED.to_array(), 0.3));
        }
    }
    let mut renderer = renderer(&gpu, &scene);
    let found = middle(&mut renderer, Vec3::new(0.05, 0.02, 0.9), Vec3::new(0.05, 0.02, -1.0));
    assert_near(found, 0.3 * RED + 0.7 * (0.3 * RED + 0.7 * BLUE));
    gpu.check().unwrap();
}

#[test]
fn the_back_of_a_one_sided_pane_is_not_there() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = dark_room();
    scene.meta.materials[4].emission = BLUE.to_array();
    scene.meta.materials[5].emission = BLUE.to_array();
    let material = Material { double_sided: false, ..glass(RED.to_array(), 0.25) };
    pane(&mut scene, Vec3::ZERO, Vec3::X * 0.5, Vec3::Y * 0.5, material);
    let mut renderer = renderer(&gpu, &scene);
    let z = Vec3::new(0.03, 0.02, 0.9);
    assert_near(middle(&mut renderer, z, Vec3::ZERO), 0.25 * RED + 0.75 * BLUE);
    assert_near(middle(&mut renderer, -z, Vec3::ZERO), BLUE);
    gpu.check().unwrap();
}

#[test]
fn what_is_opaque_hides_panes_and_is_seen_through_more_than_there_are_layers() {
    let Some(gpu) = common::gpu() else { return };
    let count = MOST_LAYERS + 3;
    let mut scene = dark_room();
    scene.meta.materials[4].emission = BLUE.to_array();
    for i in 0..count {
        let centre = Vec3::new(0.0, 0.0, 0.4 - 0.08 * i as f32);
        pane(&mut scene, centre, Vec3::X * 0.5, Vec3::Y * 0.5, glass(RED.to_array(), 0.1));
    }
    // Behind the first pane.
    let screen = Material { alpha: Alpha::Opaque, ..glass(BLUE.to_array(), 1.0) };
    pane(&mut scene, Vec3::new(-0.5, 0.0, 0.36), Vec3::X * 0.4, Vec3::Y * 0.5, screen);
    let mut renderer = renderer(&gpu, &scene);
    let (eye, ahead) = (Vec3::new(0.1, 0.02, 0.9), Vec3::new(0.1, 0.02, -1.0));
    let left = 0.9f32.powi(MOST_LAYERS as i32);
    assert_near(middle(&mut renderer, eye, ahead), (1.0 - left) * RED + left * BLUE);
    let beside = Vec3::new(-0.3, 0.02, -1.0);
    assert_near(middle(&mut renderer, eye - Vec3::X * 0.4, beside), 0.1 * RED + 0.9 * BLUE);
    gpu.check().unwrap();
}

/// A lit room with a curtain across the room, near the wall in front of the camera.
fn curtained() -> BakedScene {
    let mut scene = common::room(&[3, 6]);
    let material = Material {
        base_color: [0.8, 0.75, 0.6, 0.4],
        alpha: Alpha::Blend,
        double_sided: true,
        ..Material::default()
    };
    pane(&mut scene, Vec3::new(0.0, 0.0, -0.7), Vec3::X * 0.99, Vec3::Y * 0.99, material);
    scene
}

/// Draws one picture, or draws until the picture is complete (`rest`), and reads it.
fn drawn(gpu: &Gpu, renderer: &mut Renderer, screen: &wgpu::Texture, rest: bool) -> Vec<u8> {
    renderer.set_gizmos(false);
    let view = screen.create_view(&Default::default());
    loop {
        renderer.draw(&view, screen.format(), screen.width(), screen.height()).unwrap();
        if !rest || !renderer.needs_frame() {
            return pollster::block_on(Readback::texture(gpu, screen, 4).wait()).unwrap();
        }
    }
}

#[test]
fn the_first_picture_of_a_view_and_of_a_moved_lamp_has_no_noise() {
    let Some(gpu) = common::gpu() else { return };
    let mut renderer = renderer(&gpu, &curtained());
    let screen = common::screen(&gpu, 2 * SIZE, SIZE);
    let check = |renderer: &mut Renderer, what: &str| {
        let [first, still] = [false, true].map(|rest| drawn(&gpu, renderer, &screen, rest));
        // Within the curtain and one wall behind it; elsewhere edges are smoothed.
        let inner = |picture: &[u8]| -> Vec<u8> {
            let rows = picture.chunks_exact(4 * screen.width() as usize);
            rows.flat_map(|row| row[row.len() / 3..row.len() * 2 / 3].to_vec()).collect()
        };
        let [first, still] = [inner(&first), inner(&still)];
        let mean = still.iter().map(|c| u64::from(*c)).sum::<u64>() / still.len() as u64;
        assert!((100..245).contains(&mean), "{what}: badly exposed, {mean}");
        let off = first.iter().zip(&still).filter(|(a, b)| a.abs_diff(**b) > 3).count();
        assert!(off * 100 < still.len(), "{what}: {off} of {} differ", still.len());
    };
    for shift in [0.0, 0.11] {
        let eye = Vec3::new(0.1 + shift, 0.1, 0.9);
        renderer.set_camera(camera(eye, Vec3::new(shift, 0.0, -1.0))).unwrap();
        check(&mut renderer, "a view");
    }
    let Light::Point { intensity, .. } = common::lamp([0.0; 3]) else { panic!() };
    for x in [0.25, -0.3] {
        let lamp = Light::Point { position: [x, 0.4, 0.3], intensity, color: [1.0, 0.8, 0.6], radius: 0.0 };
        renderer.set_lights(vec![lamp]).unwrap();
        check(&mut renderer, "a lamp");
    }
    gpu.check().unwrap();
}

#[test]
fn shadows_of_panes_are_even_and_as_dark_as_their_alphas_say() {
    let Some(gpu) = common::gpu() else { return };
    // A lamp behind the camera shines at the wall in front, through panes also behind the camera.
    let wall = |panes: &[f32], intensity: f64| {
        let mut scene = common::room(&[3]);
        scene.meta.materials[4].base_color = [0.5, 0.5, 0.5, 1.0];
        let [position, direction] = [[0.0, 0.0, 0.9], [0.0, 0.0, -1.0]];
        let (outer_cone_deg, inner_cone_deg) = (40.0, Some(39.0));
        let color = [1.0; 3];
        scene.meta.lights = vec![Light::Spot {
            position,
            direction,
            outer_cone_deg,
            inner_cone_deg,
            intensity,
            color,
            radius: 0.0,
        }];
        for (i, side) in panes.iter().enumerate() {
            let centre = Vec3::Z * (0.6 - 0.1 * i as f32);
            let material = Material {
                alpha: Alpha::Blend,
                base_color: [0.0, 0.0, 0.0, 1.0 / 3.0],
                ..glass([0.0; 3], 0.0)
            };
            // All of one material, like the faces of a drinking glass.
            let (first, count) = (scene.meta.draws.len(), scene.meta.materials.len());
            pane(&mut scene, centre, Vec3::X * 0.7 * *side, Vec3::Y * 0.7, material);
            scene.meta.draws[first].material = (count - i) as u32;
        }
        let mut renderer = renderer(&gpu, &scene);
        renderer.set_still_pictures(1);
        renderer.set_mode(Mode::Direct);
        // Close, so that a texel of the shadow map is several pixels wide.
        renderer.set_largest_shadow_map(128);
        renderer.set_camera(camera(Vec3::new(0.05, 0.1, -0.7), Vec3::new(0.05, 0.1, -1.0))).unwrap();
        pollster::block_on(renderer.read_pixels(SIZE, SIZE).unwrap().wait()).unwrap()
    };
    let intensity = 9.0;
    // Each face absorbs a third: through two faces that look away from each other, four ninths pass.
    for (panes, share) in [(&[1.0f32][..], 6.0 / 9.0), (&[1.0, -1.0], 4.0 / 9.0)] {
        let (shadow, expected) = (wall(panes, intensity), wall(&[], intensity * share));
        assert!(expected.chunks(4).all(|p| (60..220).contains(&p[0])), "badly exposed");
        let most = shadow.iter().zip(&expected).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
        assert!(most <= 2, "{} panes: {most}", panes.len());
    }
    gpu.check().unwrap();
}

#[test]
fn scenes_without_blended_surfaces_pay_nothing_for_them() {
    let Some(gpu) = common::gpu() else { return };
    let pipelines = Rc::new(Pipelines::new(&gpu).unwrap());
    let screen = common::screen(&gpu, 2 * SIZE, SIZE);
    let mut plain = curtained();
    for material in &mut plain.meta.materials {
        // An opaque material, as written by many exporters.
        (material.alpha, material.base_color[3]) = (Alpha::Blend, 1.0);
    }
    let stats = |scene: &BakedScene| {
        let mut renderer = renderer_with(&gpu, &pipelines, scene);
        renderer.set_auto_exposure(true);
        drawn(&gpu, &mut renderer, &screen, true);
        renderer.stats()
    };
    let (opaque, blended) = (stats(&plain), stats(&curtained()));
    assert_eq!(opaque.blended_layers, 0);
    assert_eq!(opaque.milliseconds.blended, None);
    // One pane, one layer in each picture; the exposure is measured with the layers of the first picture.
    assert_eq!((blended.frames, blended.blended_layers), (16, 16));
    assert_eq!(blended.milliseconds.blended.is_some(), gpu.timestamps);
    // Light and coverage, and two depths.
    let pixels = u64::from(screen.width() * screen.height());
    assert_eq!(blended.bytes.picture - opaque.bytes.picture, pixels * (8 + 2 * 4));
    gpu.check().unwrap();
}

#[test]
fn sketches_show_blended_surfaces_too() {
    let Some(gpu) = common::gpu() else { return };
    let screen = common::screen(&gpu, 2 * SIZE, SIZE);
    let mut renderer = renderer(&gpu, &curtained());
    renderer.set_exposure(1.0).unwrap();
    renderer.set_still_pictures(1);
    renderer.set_sketching(true);
    let sketch = drawn(&gpu, &mut renderer, &screen, false);
    let whole = drawn(&gpu, &mut renderer, &screen, true);
    let difference: u64 = sketch.iter().zip(&whole).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    assert!(sketch != whole && difference < 8 * whole.len() as u64, "{difference}");
    gpu.check().unwrap();
}

#[test]
fn light_of_any_strength_passes() {
    let Some(gpu) = common::gpu() else { return };
    let picture = |factor: f64| {
        let mut scene = curtained();
        let Light::Point { intensity, .. } = &mut scene.meta.lights[0] else { panic!() };
        *intensity *= factor;
        let mut renderer = renderer(&gpu, &scene);
        renderer.set_mode(Mode::All);
        renderer.set_exposure(-factor.log2() as f32).unwrap();
        pollster::block_on(renderer.read_pixels(SIZE, SIZE).unwrap().wait()).unwrap()
    };
    let (plain, strong) = (picture(1.0), picture(f64::from(1 << 24)));
    let most = plain.iter().zip(&strong).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
    assert!(most <= 1, "{most}");
    gpu.check().unwrap();
}
