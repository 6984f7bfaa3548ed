//! No shimmer: for a slowly turning camera, consecutive pictures of the viewer change about as much as the CPU's,
//! averaged over many rays per pixel.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use glam::Vec3;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::render;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::tone::neutral;
use rebounce_tests::small::small;

const SIZE: [u32; 2] = [160, 90];
/// Number of pictures, and the turn between pictures in degrees: under half a pixel.
const PICTURES: u32 = 5;
const STEP: f64 = 0.25;
/// Maximum ratio of change, viewer to CPU.
const MORE: f64 = 1.2;

fn turned(camera: &Camera, degrees: f64) -> Camera {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let [x, y, z] = std::array::from_fn(|axis| camera.target[axis] - camera.position[axis]);
    let way = [x * cos + z * sin, y, z * cos - x * sin];
    Camera { target: std::array::from_fn(|axis| camera.position[axis] + way[axis]), ..camera.clone() }
}

/// Display values of a picture of this radiance, of 255.
fn shown(radiance: &[Vec3], stops: f32) -> Vec<f64> {
    let encode = |c: f32| if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    let pixel = |p: &Vec3| neutral(*p * stops.exp2()).to_array().map(|c| f64::from(255.0 * encode(c)));
    radiance.iter().flat_map(pixel).collect()
}

/// RMS of the change between consecutive pictures.
fn change(pictures: &[Vec<f64>]) -> f64 {
    let squares = |pair: &[Vec<f64>]| {
        let sum: f64 = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a - b).powi(2)).sum();
        sum / pair[0].len() as f64
    };
    (pictures.windows(2).map(squares).sum::<f64>() / (pictures.len() - 1) as f64).sqrt()
}

/// RMS difference of two series of pictures.
fn apart(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let squares = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).powi(2));
    (squares.sum::<f64>() / a.iter().map(|picture| picture.len() as f64).sum::<f64>()).sqrt()
}

fn on_cpu(scene: &BakedScene, cameras: &[Camera], stops: f32) -> Vec<Vec<f64>> {
    let surfaces = TriangleSurfaces::from_baked(scene).unwrap();
    let exposure = Exposure { size: SIZE, samples: 64, seed: 3 };
    let picture = |camera: &Camera| {
        let picture = render(scene, &surfaces, camera, &scene.meta.lights, exposure, Only::All, || ());
        shown(&picture.pixels, stops)
    };
    cameras.iter().map(picture).collect()
}

fn in_viewer(scene: &BakedScene, cameras: &[Camera], stops: f32) -> Option<Vec<Vec<f64>>> {
    let mut renderer = common::renderer(scene)?;
    renderer.set_exposure(stops).unwrap();
    // Single pictures as during motion, without averaging.
    renderer.set_still_pictures(1);
    renderer.set_antialias(true);
    let picture = |camera: &Camera| {
        renderer.set_camera(camera.clone()).unwrap();
        let read = renderer.read_pixels(SIZE[0], SIZE[1]).unwrap();
        let bytes = pollster::block_on(read.wait()).unwrap();
        bytes.chunks(4).flat_map(|pixel| [0, 1, 2].map(|c| f64::from(pixel[c]))).collect()
    };
    let pictures = cameras.iter().map(picture).collect();
    renderer.gpu().check().unwrap();
    Some(pictures)
}

#[test]
fn a_turning_camera_sees_nothing_shimmer() {
    let scene = small("builtin:apartment", 2000).unwrap();
    let stops = -3.0;
    for (name, camera) in ["living room", "kitchen"].into_iter().zip(&scene.meta.cameras) {
        let cameras: Vec<_> = (0..PICTURES).map(|i| turned(camera, STEP * f64::from(i))).collect();
        let Some(ours) = in_viewer(&scene, &cameras, stops) else { return };
        let truth = on_cpu(&scene, &cameras, stops);
        let [moves, least] = [&ours, &truth].map(|pictures| change(pictures));
        println!("{name}: {moves:.2} of 255 a picture, the CPU's {least:.2}: {:.3}", moves / least);
        let apart = apart(&ours, &truth);
        println!("{name}: {apart:.2} apart");
        assert!(least > 1.0, "{name}: nothing moves");
        assert!(moves < MORE * least, "{name}: {moves} and {least}");
    }
}
