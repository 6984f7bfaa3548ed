//! Openness on the GPU equals the Rust implementation, and bounced light follows openness.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
use rebounce_shared::openness::{LEVELS, REACH, View, gain, horizon, received};
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use rebounce_viewer::settings::Display;

const SIZE: [u32; 2] = [48, 36];
/// Size of the rendered picture; the bounced light of a picture is averaged from twice the size.
const LARGE: [u32; 2] = [96, 72];

fn renderer(gpu: &Gpu, scene: &BakedScene) -> Renderer {
    let mut renderer = Renderer::new(gpu.clone()).unwrap();
    let loaded =
        pollster::block_on(GpuScene::upload(gpu, renderer.pipelines().loaders(), scene.clone())).unwrap();
    renderer.install(loaded).unwrap();
    renderer.set_every_pixel(true);
    renderer
}

/// Bounced radiance, green.
fn picture(renderer: &mut Renderer, detail: bool) -> Vec<f32> {
    renderer.set_detail(detail);
    let bytes = pollster::block_on(renderer.read_indirect(SIZE[0], SIZE[1]).unwrap().wait()).unwrap();
    bytemuck::pod_collect_to_vec::<u8, f32>(&bytes).chunks(4).map(|pixel| pixel[1]).collect()
}

/// Hit of a ray from inside the room [-1, 1]³ with a wall, and the wall's normal.
fn wall(eye: Vec3, direction: Vec3) -> (Vec3, Vec3) {
    let distances = (direction.signum() - eye) / direction;
    let axis = distances.min_position();
    let mut normal = Vec3::ZERO;
    normal[axis] = -direction[axis].signum();
    (eye + direction * distances[axis], normal)
}

#[test]
fn pixels_receive_what_the_twin_says() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = common::room(&[6, 12]);
    // Every function is partly closed, so that pixels on bare walls are evaluated.
    scene.openness = vec![LEVELS - 1; scene.points.len()];
    let camera = scene.meta.cameras[0].frame([0.0; 3]);
    let [width, height] = LARGE;
    let position = |x: u32, y: u32| {
        Some(wall(camera.eye, camera.direction(x as f32 + 0.5, y as f32 + 0.5, width, height)).0)
    };
    let pixels_per_unit = 0.5 * height as f32 / camera.tan_half_yfov;
    let axes = [camera.right, camera.up, camera.forward];
    let view = View { eye: camera.eye, axes, pixels_per_unit, size: LARGE, position: &position };
    let reach = REACH * scene.meta.levels[1].support_radius;
    let twin = |x: u32, y: u32| {
        let (place, normal) =
            wall(camera.eye, camera.direction(x as f32 + 0.5, y as f32 + 0.5, width, height));
        received(horizon(&view, [x, y], place, normal, reach))
    };
    let mut renderer = renderer(&gpu, &scene);
    for way in [Display::Lookup, Display::Splat] {
        renderer.set_display(way);
        let [without, with] = [false, true].map(|detail| picture(&mut renderer, detail));
        let (mut sum, mut count, mut darkest) = (0.0, 0, 1f32);
        for y in 0..SIZE[1] {
            for x in 0..SIZE[0] {
                let of = |i: u32| twin(2 * x + (i & 1), 2 * y + (i >> 1));
                let [a, b, c, d] = [0, 1, 2, 3].map(of);
                let i = (y * SIZE[0] + x) as usize;
                // Skips places where openness changes from pixel to pixel: the average of the picture's samples
                // differs there.
                let spread = [a, b, c, d].iter().fold(0f32, |most, v| most.max((v - a).abs()));
                if without[i] > 1e-4 && spread < 0.02 {
                    let found = with[i] / (without[i] * gain(LEVELS - 1));
                    let expected = 0.25 * (a + b + c + d);
                    assert!((found - expected).abs() < 0.05, "{way:?}, {x}, {y}: {found}, not {expected}");
                    sum += (found - expected).abs();
                    (count, darkest) = (count + 1, darkest.min(found));
                }
            }
        }
        let error = sum / count as f32;
        println!("{way:?}: {count} pixels, {error} apart, the darkest {darkest}");
        assert!(count > 800 && error < 0.01 && darkest < 0.97, "{way:?}: {count}, {error}, {darkest}");
    }
}

#[test]
fn points_that_are_less_open_pass_on_more() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = common::room(&[6, 12]);
    let mut ratio = |level: u8| {
        scene.openness = vec![level; scene.points.len()];
        picture(&mut renderer(&gpu, &scene), true)
    };
    let [open, narrow] = [LEVELS - 1, LEVELS / 2].map(&mut ratio);
    let expected = gain(LEVELS / 2) / gain(LEVELS - 1);
    for (open, narrow) in open.into_iter().zip(narrow).filter(|(open, _)| *open > 1e-4) {
        assert!((narrow / open - expected).abs() < 0.01, "{narrow} from {open}");
    }
}

#[test]
fn where_nothing_is_near_the_points_detail_changes_nothing() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = common::room(&[6, 12]);
    scene.openness = vec![LEVELS; scene.points.len()];
    let mut renderer = renderer(&gpu, &scene);
    renderer.set_display(Display::Lookup);
    assert_eq!(picture(&mut renderer, true), picture(&mut renderer, false));
}

#[test]
fn a_file_without_openness_is_shown_as_without_detail() {
    let Some(gpu) = common::gpu() else { return };
    let mut renderer = renderer(&gpu, &common::room(&[6, 12]));
    assert_eq!(picture(&mut renderer, true), picture(&mut renderer, false));
}
