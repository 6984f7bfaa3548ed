//! Area lights at the points of an empty room: the GPU's irradiance is the closed form's.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_shared::footprint;
use rebounce_shared::glam::Vec3;
use rebounce_shared::light::{Light, LightSource};
use rebounce_shared::rbn::bulk::Point;
use rebounce_viewer::pipelines::Pipelines;
use rebounce_viewer::readback::Readback;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use std::rc::Rc;

/// Maximum difference of a point, as a share of the brightest point: in corners a tap of the shadow filter may meet a wall.
const MOST: f32 = 0.03;
/// Maximum mean difference.
const MEAN: f32 = 1e-4;

/// Irradiance at a point without occluders: the mean over its footprint.
fn irradiance(light: &LightSource, point: &Point) -> Vec3 {
    let (position, normal) = (point.position(), point.normal());
    let samples = (0..footprint::SAMPLES).filter(|k| point.has_sample(*k));
    let mut places: Vec<Vec3> =
        samples.map(|k| position + footprint::offset(k, normal, point.radius)).collect();
    if places.is_empty() {
        places.push(position);
    }
    let of =
        |place: &Vec3| -> f32 { light.parts().map(|part| part.projected_solid_angle(*place, normal)).sum() };
    light.intensity * places.iter().map(of).sum::<f32>() / places.len() as f32
}

#[test]
fn in_an_empty_room_points_get_what_the_closed_form_says() {
    let Some(gpu) = common::gpu() else { return };
    let (pipelines, scene) = (Rc::new(Pipelines::new(&gpu).unwrap()), common::room(&[3, 6, 12]));
    let mut renderer = Renderer::with(gpu.clone(), pipelines.clone());
    let loaded = pollster::block_on(GpuScene::upload(&gpu, pipelines.loaders(), scene.clone())).unwrap();
    renderer.install(loaded).unwrap();
    let (intensity, color) = (3.0, [1.0, 0.7, 0.4]);
    let tilted = [0.4, -1.0, 0.2];
    let rectangle = |position, width, height| Light::Rectangle {
        position,
        direction: tilted,
        up: [0.0, 0.0, 1.0],
        width,
        height,
        intensity,
        color,
    };
    let lights = [
        rectangle([0.1, 0.4, -0.2], 0.3, 0.4),
        rectangle([0.0, 0.7, 0.0], 1.2, 0.3),
        Light::Disk { position: [-0.3, 0.2, 0.3], direction: tilted, radius: 0.25, intensity, color },
        Light::Sphere { position: [0.3, -0.1, 0.2], radius: 0.3, intensity, color },
    ];
    for light in lights {
        renderer.set_lights(vec![light.clone()]).unwrap();
        pollster::block_on(renderer.read_pixels(4, 4).unwrap().wait()).unwrap();
        let buffer = &renderer.scene().unwrap().relight.irradiance;
        let bytes = pollster::block_on(Readback::buffer(&gpu, buffer).wait()).unwrap();
        let found: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
        let source = light.source(scene.meta.origin);
        // Bounced light is added to that of the senders, which are coarser.
        let level = scene.meta.levels.last().unwrap();
        let finest = level.first as usize..scene.direct_count();
        let points = &scene.points[finest.clone()];
        let expected: Vec<Vec3> = points.iter().map(|point| irradiance(&source, point)).collect();
        let brightest = expected.iter().fold(0f32, |most, e| most.max(e.max_element()));
        assert!(brightest > 0.0);
        let off = |(found, expected): (&[f32; 4], &Vec3)| {
            (Vec3::from_slice(found) - expected).abs().max_element() / brightest
        };
        let off: Vec<f32> = found[finest].iter().zip(&expected).map(off).collect();
        let (most, mean) =
            (off.iter().fold(0f32, |a, b| a.max(*b)), off.iter().sum::<f32>() / off.len() as f32);
        println!("{light:?}: off by {mean:.5}, at most {most:.4}");
        assert!(most < MOST && mean < MEAN, "{light:?}: off by {mean}, at most {most}");
    }
    renderer.gpu().check().unwrap();
}
