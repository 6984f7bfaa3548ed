//! Comparison of the viewer with the CPU: a renderer of a scene, and radiance from its pictures.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]
#![allow(dead_code, reason = "each test uses a part of it")]

use glam::Vec3;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::Relit;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_tests::small::small;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use rebounce_viewer::settings::{Mode, ToneMapping};

#[path = "../../../viewer/tests/device/mod.rs"]
mod device;

/// Returns a renderer of a scene at a fixed exposure, with the invertible tone curve; `None`, with a message, without
/// an adapter.
pub fn renderer(scene: &BakedScene) -> Option<Renderer> {
    let gpu = device::gpu()?;
    let mut renderer = Renderer::new(gpu.clone()).unwrap();
    let pipelines = renderer.pipelines();
    let loaded = GpuScene::upload(&gpu, pipelines.loaders(), scene.clone());
    renderer.install(pollster::block_on(loaded).unwrap()).unwrap();
    renderer.set_auto_exposure(false);
    renderer.set_tone_mapping(ToneMapping::Neutral);
    Some(renderer)
}

/// The Cornell box on the CPU and in the viewer, which shows direct light alone; `camera` looks down onto the floor and
/// the blocks.
pub struct CornellBox {
    pub scene: BakedScene,
    pub surfaces: TriangleSurfaces,
    pub renderer: Renderer,
    pub camera: Camera,
}

/// Returns the [`CornellBox`]; `None`, with a message, without an adapter.
pub fn cornell_box() -> Option<CornellBox> {
    let scene = small("builtin:cornell-box", 600).unwrap();
    let surfaces = TriangleSurfaces::from_baked(&scene).unwrap();
    let mut renderer = renderer(&scene)?;
    renderer.set_mode(Mode::Direct);
    let camera =
        Camera { position: [0.0, 4.6, -0.4], target: [0.0, 0.3, -3.2], up: [0.0, 1.0, 0.0], yfov_deg: 60.0 };
    renderer.set_camera(camera.clone()).unwrap();
    Some(CornellBox { scene, surfaces, renderer, camera })
}

/// Returns the mean of the pixels' largest components, and an exposure in stops that maps the mean well below the
/// tone curve's shoulder.
pub fn mean_and_stops(truth: &[Vec3]) -> (f32, f32) {
    let mean = truth.iter().map(|p| p.max_element()).sum::<f32>() / truth.len() as f32;
    (mean, (0.25 / mean).log2())
}

/// Returns the viewer's bounced radiance for its camera and lights.
pub fn indirect(renderer: &mut Renderer, [width, height]: [u32; 2]) -> Vec<Vec3> {
    let bytes = pollster::block_on(renderer.read_indirect(width, height).unwrap().wait()).unwrap();
    bytemuck::pod_collect_to_vec::<u8, [f32; 4]>(&bytes).iter().map(|p| Vec3::from_slice(p)).collect()
}

/// Returns the viewer's radiance of all light for its camera and lights.
pub fn radiance(renderer: &mut Renderer, [width, height]: [u32; 2]) -> Vec<Vec3> {
    let bytes = pollster::block_on(renderer.read_radiance(width, height).unwrap().wait()).unwrap();
    bytemuck::pod_collect_to_vec::<u8, [f32; 4]>(&bytes).iter().map(|p| Vec3::from_slice(p)).collect()
}

/// Returns the CPU's radiance of all light for a scene's first camera, with metals as conductors.
pub fn conductors(scene: &BakedScene, lights: &[Light], size: [u32; 2]) -> Vec<Vec3> {
    let surfaces = TriangleSurfaces::from_baked(scene).unwrap();
    let relit = Relit::new(scene, &surfaces, lights, false).with_gloss(scene, &surfaces);
    let exposure = Exposure { size, samples: 64, seed: 5 };
    relit.picture(scene, &surfaces, &scene.meta.cameras[0], exposure, Only::All, || ()).pixels
}

/// Returns the RMS difference relative to the CPU's picture, and the bias.
pub fn difference(ours: &[Vec3], truth: &[Vec3]) -> (f32, f32) {
    let sum = |f: &dyn Fn(Vec3, Vec3) -> f32| -> f32 { ours.iter().zip(truth).map(|(a, b)| f(*a, *b)).sum() };
    let power = sum(&|_, b| b.length_squared());
    assert!(power > 0.0 && ours.len() == truth.len(), "nothing to compare");
    let error = (sum(&|a, b| (a - b).length_squared()) / power).sqrt();
    (error, sum(&|a, _| a.element_sum()) / sum(&|_, b| b.element_sum()) - 1.0)
}

/// Returns the radiance of a picture of this size at this exposure.
pub fn picture(renderer: &mut Renderer, [width, height]: [u32; 2], stops: f32) -> Vec<Vec3> {
    renderer.set_exposure(stops).unwrap();
    let read = renderer.read_pixels(width, height).unwrap();
    let bytes = pollster::block_on(read.wait()).unwrap();
    bytes.chunks_exact(4).map(|p| linear(p) * (-stops).exp2()).collect()
}

/// Returns linear radiance of display values: inverts 8-bit sRGB and, below its shoulder, Khronos PBR Neutral.
fn linear(rgb: &[u8]) -> Vec3 {
    let display = Vec3::from_slice(&[rgb[0], rgb[1], rgb[2]].map(|c| {
        let c = f32::from(c) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    }));
    let least = display.min_element();
    let before = if least < 0.04 { (least / 6.25).sqrt() } else { least + 0.04 };
    display + (before - least)
}
