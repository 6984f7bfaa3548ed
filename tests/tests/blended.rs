//! Blended surfaces: the viewer composites them over the background, the CPU lets rays through at random. The means
//! are equal.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use common::{difference, indirect, mean_and_stops, picture};
use glam::Vec3;
use rebounce::bake::bake;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::{Content, render};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::rbn::extras::Extras;
use rebounce_shared::rbn::meta::{Alpha, Material};
use rebounce_tests::small::{add_parallelogram, settings};
use rebounce_viewer::settings::Mode;

const WIDTH: u32 = 56;
const HEIGHT: u32 = 56;

/// Bakes the Cornell box with panes: one in the left half, one behind it across the full width, and one that crosses
/// both. `glass` makes two of them glass.
fn panes(glass: bool) -> BakedScene {
    let mut room = rebounce::io::load("builtin:cornell-box").unwrap();
    let mut pane = |at: Vec3, u: Vec3, v: Vec3, color: [f32; 3], alpha: f32| {
        let [r, g, b] = color;
        let base_color = [r, g, b, alpha];
        let extras = match glass && alpha > 0.4 {
            true => Extras { transmission: 1.0 - 0.5 * alpha, ..Extras::default() },
            false => Extras::default(),
        };
        let material = Material {
            base_color,
            extras,
            alpha: if extras == Extras::default() { Alpha::Blend } else { Alpha::Opaque },
            double_sided: true,
            ..Default::default()
        };
        add_parallelogram(&mut room, at, [u, v], material);
    };
    let up = Vec3::Y * 0.7;
    pane(Vec3::new(-0.45, -0.1, 0.7), Vec3::X * 0.5, up, [0.8, 0.2, 0.1], 4.0 / 9.0);
    pane(Vec3::new(0.0, 0.0, 0.3), Vec3::X * 0.9, up, [0.1, 0.6, 0.7], 3.0 / 9.0);
    pane(Vec3::new(0.4, 0.1, 0.5), Vec3::new(0.3, 0.0, 0.4), up, [0.7, 0.7, 0.2], 6.0 / 9.0);
    // Enough functions and rays to hide the noise of the bake in a pixel.
    let mut settings = settings(2400);
    settings.operator.rays = vec![512];
    bake(&room, &settings, &()).unwrap().0
}

/// Returns true if a pixel and its neighbours are similar and below the tone curve's shoulder, at `most`: across
/// edges the viewer averages tone-mapped values, the CPU radiance.
fn is_even(truth: &[Vec3], at: usize, most: f32) -> bool {
    let (x, y) = (at as u32 % WIDTH, at as u32 / WIDTH);
    let around = |v: u32, end: u32| v.saturating_sub(1)..(v + 2).min(end);
    let near = around(y, HEIGHT).flat_map(|y| around(x, WIDTH).map(move |x| truth[(y * WIDTH + x) as usize]));
    near.into_iter().all(|p| {
        let difference = (p - truth[at]).abs().max_element();
        p.max_element() < most && difference <= 0.25 * truth[at].max_element()
    })
}

#[test]
fn the_viewers_picture_of_panes_is_the_mean_of_the_cpus() {
    compare(false);
}

#[test]
fn the_viewers_picture_of_glass_is_the_mean_of_the_cpus() {
    compare(true);
}

fn compare(glass: bool) {
    let scene = panes(glass);
    let surfaces = TriangleSurfaces::from_baked(&scene).unwrap();
    let Some(mut renderer) = common::renderer(&scene) else { return };
    let front = scene.meta.cameras[0].clone();
    // View from inside, behind the panes.
    let behind =
        Camera { position: [0.4, 2.4, -5.3], target: [0.0, 2.6, 0.0], yfov_deg: 75.0, ..front.clone() };
    let views = [("front", front), ("behind", behind)];
    // A single view suffices to check colours.
    for (name, camera) in views.into_iter().take(if glass { 1 } else { 2 }) {
        let exposure = Exposure { size: [WIDTH, HEIGHT], samples: 1024, seed: 3 };
        // Blended surfaces have no detail in the viewer.
        let truth = |only| {
            let content = Content { only, detail: false };
            render(&scene, &surfaces, &camera, &scene.meta.lights, exposure, content, || ()).pixels
        };
        renderer.set_detail(false);
        renderer.set_camera(camera.clone()).unwrap();
        let ours = indirect(&mut renderer, [WIDTH, HEIGHT]);
        let (error, bias) = difference(&ours, &truth(Only::Indirect));
        println!("{name}, bounced light: {error:.4}, bias {bias:+.4}");
        assert!(error < 0.03 && bias.abs() < 0.01, "{name}, bounced light: {error}, bias {bias}");
        for (mode, only) in [(Mode::Direct, Only::Direct), (Mode::All, Only::All)] {
            let truth = truth(only);
            let (_, stops) = mean_and_stops(&truth);
            renderer.set_mode(mode);
            let ours = picture(&mut renderer, [WIDTH, HEIGHT], stops);
            let compared: Vec<usize> =
                (0..truth.len()).filter(|at| is_even(&truth, *at, 0.7 * (-stops).exp2())).collect();
            assert!(compared.len() > truth.len() / 4, "{name}, {only:?}: {} to compare", compared.len());
            let [ours, truth] =
                [ours, truth].map(|all| compared.iter().map(|at| all[*at]).collect::<Vec<_>>());
            let (error, bias) = difference(&ours, &truth);
            println!("{name}, {only:?}: {error:.4}, bias {bias:+.4}");
            assert!(error < 0.05 && bias.abs() < 0.01, "{name}, {only:?}: {error}, bias {bias}");
        }
    }
    renderer.gpu().check().unwrap();
}
