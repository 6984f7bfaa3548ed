//! PNGs of `rebounce render` match the page: exposure, tone mapping, emission, backdrop.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::io::picture::png::display_bytes;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::{Content, render, shown::Shown};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::rbn::meta::DetailTexture;
use rebounce_shared::rbn::shown::{Ground, SIDE};
use rebounce_tests::small::{everything, small};
use rebounce_viewer::settings::ToneMapping;

const SIZE: [u32; 2] = [128, 72];
/// Neighbourhood and maximum difference (of 255) of compared pixels: shadow edges differ by a texel of a shadow map,
/// and the page averages tone-mapped values, the command radiance.
const BESIDE: i32 = 2;
const EDGE: u8 = 24;
/// Maximum difference of compared pixels, of 255, for 99% of the pixels.
const APART: u8 = 6;
/// Maximum difference of the pictures' means.
const MEANS: f64 = 2.0;

/// RGB bytes of the first camera's picture.
fn on_cpu(scene: &BakedScene) -> Vec<u8> {
    let surfaces = TriangleSurfaces::from_baked(scene).unwrap();
    let exposure = Exposure { size: SIZE, samples: 64, seed: 1 };
    let (camera, lights) = (&scene.meta.cameras[0], &scene.meta.lights);
    // Detail is excluded: its two implementations are tested in openness.rs.
    let content = Content { only: Only::All, detail: false };
    let radiance = render(scene, &surfaces, camera, lights, exposure, content, || ());
    let sources: Vec<_> = lights.iter().map(|light| light.source(scene.meta.origin)).collect();
    let frame = camera.frame(scene.meta.origin);
    let ground = scene.meta.shown.ground();
    let of = Shown {
        surfaces: &surfaces,
        camera: &frame,
        lights: &sources,
        exposure,
        ground: ground.as_ref(),
        only: Only::All,
    };
    display_bytes(&of.picture(&radiance))
}

fn in_viewer(scene: &BakedScene) -> Option<Vec<u8>> {
    let mut renderer = common::renderer(scene)?;
    renderer.set_auto_exposure(true);
    renderer.set_detail(false);
    renderer.set_tone_mapping(ToneMapping::default());
    let read = renderer.read_pixels(SIZE[0], SIZE[1]).unwrap();
    let pixels = pollster::block_on(read.wait()).unwrap();
    Some(pixels.chunks(4).flat_map(|pixel| pixel[..3].to_vec()).collect())
}

fn mean(bytes: &[u8]) -> f64 {
    bytes.iter().map(|byte| f64::from(*byte)).sum::<f64>() / bytes.len() as f64
}

/// Returns true if the neighbourhood of a pixel is even.
fn is_even(picture: &[u8], x: i32, y: i32) -> bool {
    let [width, height] = SIZE.map(|side| side as i32);
    let at = |x: i32, y: i32| &picture[3 * (y * width + x) as usize..][..3];
    let around = (-BESIDE..=BESIDE).flat_map(|dx| (-BESIDE..=BESIDE).map(move |dy| (x + dx, y + dy)));
    around
        .filter(|(x, y)| (0..width).contains(x) && (0..height).contains(y))
        .all(|(near_x, near_y)| at(x, y).iter().zip(at(near_x, near_y)).all(|(a, b)| a.abs_diff(*b) <= EDGE))
}

/// Compares the pictures of CPU and viewer; returns the CPU's, or `None` without an adapter.
fn compared(scene: &BakedScene) -> Option<Vec<u8>> {
    let (cpu, viewer) = (on_cpu(scene), in_viewer(scene)?);
    let (a, b) = (mean(&cpu), mean(&viewer));
    let mut differences: Vec<u8> = (0..(SIZE[0] * SIZE[1]) as i32)
        .filter(|i| {
            let (x, y) = (i % SIZE[0] as i32, i / SIZE[0] as i32);
            is_even(&cpu, x, y) && is_even(&viewer, x, y)
        })
        .map(|i| {
            let of = |bytes: &[u8]| <[u8; 3]>::try_from(&bytes[3 * i as usize..][..3]).unwrap();
            of(&cpu).iter().zip(of(&viewer)).map(|(a, b)| a.abs_diff(b)).max().unwrap()
        })
        .collect();
    differences.sort_unstable();
    let most = differences[differences.len() * 99 / 100];
    println!("means {a:.1} and {b:.1}; of {} even pixels 99% within {most}", differences.len());
    assert!(differences.len() * 3 > (SIZE[0] * SIZE[1]) as usize, "{} even pixels", differences.len());
    assert!((a - b).abs() < MEANS, "means {a}, {b}");
    assert!(most <= APART, "{most}");
    Some(cpu)
}

#[test]
fn the_apartment_looks_alike() {
    let scene = small("builtin:apartment", 6000).unwrap();
    let Some(picture) = compared(&scene) else { return };
    assert!((40.0..200.0).contains(&mean(&picture)));
}

#[test]
fn coloured_and_textured_emission_look_alike() {
    let plain = {
        let mut scene = everything(1500).unwrap();
        scene.meta.materials[0].normal_texture = None;
        scene
    };
    let mut scene = plain.clone();
    let uv_from_vertex = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    scene.meta.materials[0].emission = [0.8, 0.5, 0.3];
    scene.meta.materials[0].emission_texture = Some(DetailTexture { texture: 0, uv_from_vertex });
    scene.meta.materials[1].emission = [4.0, 0.2, 0.1];
    let (Some(without), Some(with)) = (compared(&plain), compared(&scene)) else { return };
    assert!(without != with);
    // The red emitter is red.
    let reds = with.chunks(3).filter(|p| p[0] > 180 && p[1] < 140 && p[2] < 140).count();
    assert!(reds > 300, "{reds}");
}

#[test]
fn an_object_stands_before_the_same_backdrop() {
    let mut scene = small("builtin:cornell-box", 600).unwrap();
    let m = &mut scene.meta;
    let camera = Camera { yfov_deg: 60.0, ..m.cameras[0].clone() };
    let [x, y, z] = camera.target;
    m.cameras = vec![Camera { position: [x + 7.0, y + 4.0, z + 9.0], ..camera }];
    let mut ground =
        Ground { height: m.bounds_min[1], low: [-9.0; 2], high: [9.0; 2], shade: vec![0; SIDE * SIDE] };
    m.shown.ground = ground.to_bytes();
    let before = compared(&scene);
    ground.shade = (0..SIDE * SIDE).map(|i| if i / SIDE > 12 && i % SIDE > 8 { 200 } else { 0 }).collect();
    scene.meta.shown.ground = ground.to_bytes();
    let shaded = compared(&scene);
    scene.meta.shown.ground.clear();
    let (Some(before), Some(shaded), Some(without)) = (before, shaded, compared(&scene)) else { return };
    // The backdrop replaces black by grey and changes nothing else.
    let changed = before.chunks(3).zip(without.chunks(3)).filter(|(a, b)| a != b);
    let kinds: Vec<(u8, u8)> = changed.map(|(a, b)| (a[0], b.iter().copied().max().unwrap())).collect();
    assert!(kinds.len() * 4 > before.len() / 3, "{}", kinds.len());
    assert!(kinds.iter().filter(|(new, old)| *old == 0 && *new > 90).count() * 10 > kinds.len() * 9);
    // The shadow covers a part of the ground.
    let dark = shaded.iter().zip(&before).filter(|(a, b)| a.saturating_add(20) < **b).count();
    assert!(dark > 300 && dark < before.len() / 2, "{dark}");
}
