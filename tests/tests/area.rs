//! Area lights in the picture: the page's direct light is the CPU's, without occluders and in soft shadows.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use common::{CornellBox, cornell_box, mean_and_stops, picture};
use glam::Vec3;
use rebounce::io::picture::Only;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::render;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;

const SIZE: u32 = 88;
/// Maximum RMS difference, as a share of the mean.
const MOST: f32 = 0.12;
/// Maximum share of pixels that show a light in one picture alone.
const ASTRAY: f32 = 0.005;

const COLOR: [f64; 3] = [1.0, 0.8, 0.6];

fn rectangle(position: [f64; 3], direction: [f64; 3], width: f64, height: f64) -> Light {
    Light::Rectangle { position, direction, up: [0.0; 3], width, height, intensity: 10.0, color: COLOR }
}

fn disk(position: [f64; 3], direction: [f64; 3], radius: f64) -> Light {
    Light::Disk { position, direction, radius, intensity: 10.0, color: COLOR }
}

fn sphere(position: [f64; 3], radius: f64) -> Light {
    Light::Sphere { position, radius, intensity: 10.0, color: COLOR }
}

#[test]
fn area_lights_light_the_picture_as_on_the_cpu() {
    let Some(CornellBox { scene, surfaces, mut renderer, camera }) = cornell_box() else { return };
    let down = [0.0, -1.0, 0.0];
    let lights = [
        ("panel", rectangle([0.2, 4.7, -2.6], down, 1.0, 1.0)),
        ("tube", rectangle([-0.5, 4.7, -2.2], down, 0.3, 2.4)),
        ("disk", disk([0.5, 4.5, -2.0], down, 0.5)),
        ("sphere", sphere([-1.5, 4.3, -0.35], 0.3)),
    ];
    for (name, light) in lights {
        let exposure = Exposure { size: [SIZE; 2], samples: 128, seed: 5 };
        let truth =
            render(&scene, &surfaces, &camera, std::slice::from_ref(&light), exposure, Only::Direct, || ())
                .pixels;
        let (mean, stops) = mean_and_stops(&truth);
        let most = Vec3::splat(0.7 * (-stops).exp2());
        renderer.set_lights(vec![light]).unwrap();
        let ours = picture(&mut renderer, [SIZE; 2], stops);
        let off = |(a, b): (&Vec3, &Vec3)| (a.min(most) - b.min(most)).length_squared();
        let rms = (ours.iter().zip(&truth).map(off).sum::<f32>() / truth.len() as f32).sqrt();
        let sum: Vec3 = ours.iter().zip(&truth).map(|(a, b)| a.min(most) - b.min(most)).sum();
        let bias = sum / truth.len() as f32 / mean;
        println!("{name}: off by {:.3} of the mean, bias {bias:.3}", rms / mean);
        assert!(rms < MOST * mean, "{name}: off by {} of the mean", rms / mean);
    }
    renderer.gpu().check().unwrap();
}

#[test]
fn area_lights_are_seen_before_and_behind_surfaces_as_on_the_cpu() {
    let Some(CornellBox { scene, surfaces, mut renderer, .. }) = cornell_box() else { return };
    let camera =
        Camera { position: [0.0, 2.5, 0.5], target: [0.0, 2.4, -3.0], up: [0.0, 1.0, 0.0], yfov_deg: 60.0 };
    renderer.set_camera(camera.clone()).unwrap();
    let lights = [
        rectangle([-1.0, 3.6, -1.5], [0.3, -0.4, 1.0], 1.2, 0.5),
        disk([1.0, 3.6, -1.5], [-0.3, -0.4, 1.0], 0.4),
        sphere([0.0, 3.4, -1.2], 0.25),
        // From behind, black; and half behind a block.
        disk([0.9, 2.2, -0.5], [0.0, 0.0, -1.0], 0.2),
        sphere([1.3, 1.4, -3.6], 0.6),
    ];
    let exposure = Exposure { size: [SIZE; 2], samples: 32, seed: 5 };
    let truth = render(&scene, &surfaces, &camera, &lights, exposure, Only::Direct, || ()).pixels;
    // A light is the middle grey.
    let stops = (0.25f32 / 10.0).log2();
    renderer.set_lights(lights.to_vec()).unwrap();
    let ours = picture(&mut renderer, [SIZE; 2], stops);
    let shows = |p: &Vec3| p.x > 8.0;
    let astray = ours.iter().zip(&truth).filter(|(a, b)| shows(a) != shows(b)).count();
    let seen = truth.iter().filter(|p| shows(p)).count();
    println!("{seen} pixels show a light, {astray} in one picture alone");
    assert!(seen > truth.len() / 30, "{seen} pixels show a light");
    assert!((astray as f32) < ASTRAY * truth.len() as f32, "{astray} pixels of {}", truth.len());
    // At another exposure, which keeps dark surfaces apart from black.
    let bright = picture(&mut renderer, [SIZE; 2], stops + 6.0);
    let black = |p: &&Vec3| p.max_element() < 0.01;
    let (a, b) = (bright.iter().filter(black).count() as f32, truth.iter().filter(black).count() as f32);
    println!("{a} black pixels, {b} on the CPU");
    assert!((a - b).abs() < 0.01 * truth.len() as f32 && b > 50.0, "{a} black pixels, {b} on the CPU");
}
