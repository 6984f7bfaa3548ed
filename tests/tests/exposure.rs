//! Automatic exposure keeps a nearly unlit room beside a lit room dark.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::io::picture::png::{developed, exposure_of_lit};
use rebounce::light::{direct, level::level};
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::render;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::colour::luminance;
use rebounce_shared::exposure;
use rebounce_shared::light::{Light, LightSource};
use rebounce_shared::relight;
use rebounce_tests::small::small;
use rebounce_viewer::renderer::Renderer;

const SIZE: u32 = 64;

/// Lamps of these intensities in the middle of two adjacent rooms.
fn lamps(intensities: [f64; 2]) -> Vec<Light> {
    let lamp =
        |(x, intensity)| Light::Point { position: [x, 1.3, 2.0], intensity, color: [1.0; 3], radius: 0.0 };
    [-2.0, 2.0].into_iter().zip(intensities).map(lamp).collect()
}

/// Returns the light level of a file, computed at its points.
fn level_at_points(scene: &BakedScene, surfaces: &TriangleSurfaces, lights: &[LightSource]) -> f32 {
    let points = &scene.points[..scene.direct_count()];
    let mut light: Vec<_> = points.iter().map(|p| direct::at_footprint(surfaces, lights, p)).collect();
    relight::pull(scene, &mut light);
    relight::add_bounced(scene, &mut light);
    let finest = scene.level(scene.meta.sender_levels as usize - 1);
    exposure::level(finest.map(|i| luminance(light[i])))
}

/// Returns the RGB bytes of the first picture after a reset of the automatic exposure, and the measured exposure.
fn shown(renderer: &mut Renderer, lights: Vec<Light>) -> (Vec<u8>, [f32; 3]) {
    renderer.set_lights(lights).unwrap();
    renderer.rekey();
    renderer.want_key(true);
    let pixels = pollster::block_on(renderer.read_pixels(SIZE, SIZE).unwrap().wait()).unwrap();
    let key = pollster::block_on(renderer.take_measured().unwrap().wait()).unwrap();
    let colours = pixels.chunks(4).flat_map(|pixel| pixel[..3].to_vec()).collect();
    (colours, bytemuck::pod_read_unaligned(&key[..12]))
}

fn mean(bytes: &[u8]) -> f64 {
    bytes.iter().map(|byte| f64::from(*byte)).sum::<f64>() / bytes.len() as f64
}

#[test]
fn a_room_with_next_to_nothing_of_its_neighbours_light_is_black() {
    let scene = small("builtin:two-rooms", 600).unwrap();
    // The first camera looks into the unlit room, the second into the lit room.
    let [dark, lit] = [scene.meta.cameras[0].clone(), scene.meta.cameras[1].clone()];
    let surfaces = TriangleSurfaces::from_baked(&scene).unwrap();
    // On the CPU, as in PNGs.
    let developed = |factors: [f64; 2]| {
        let lights = lamps(factors);
        let exposure = Exposure { size: [24, 24], samples: 16, seed: 1 };
        let picture = render(&scene, &surfaces, &dark, &lights, exposure, Only::All, || ());
        let sources: Vec<LightSource> = lights.iter().map(|light| light.source(scene.meta.origin)).collect();
        let most = exposure::most(level(&surfaces, &sources));
        let shown = developed(&picture, exposure_of_lit(&picture, most));
        shown.pixels.iter().map(|p| luminance(*p)).sum::<f32>() / shown.pixels.len() as f32
    };
    // Linear: a display value of 2 of 255 is 0.0006.
    let (black, dim, same) = (developed([1.0, 2e-5]), developed([1.0, 1e-2]), developed([1e-6, 1e-6]));
    println!("on the CPU: {black}, {dim}, {same}");
    assert!(black < 6e-4 && dim > 0.05 && same > 0.05);
    let Some(mut renderer) = common::renderer(&scene) else { return };
    renderer.set_auto_exposure(true);
    renderer.set_camera(dark).unwrap();
    let (black, [_, _, most]) = shown(&mut renderer, lamps([1.0, 2e-5]));
    let (dim, _) = shown(&mut renderer, lamps([1.0, 1e-2]));
    // Except pixels at the joint of partition wall and ceiling, thinner than a texel of the shadow map.
    let bright = black.chunks(3).filter(|pixel| pixel.iter().any(|c| *c > 2)).count();
    println!("in the viewer: {} ({bright} pixels above 2), {}", mean(&black), mean(&dim));
    assert!(mean(&black) < 1.0 && bright <= 16, "{} and {bright}", mean(&black));
    assert!(mean(&dim) > 50.0, "{}", mean(&dim));
    // The CPU computes the same limit.
    let sources: Vec<LightSource> =
        lamps([1.0, 2e-5]).iter().map(|light| light.source(scene.meta.origin)).collect();
    let expected = exposure::most(level_at_points(&scene, &surfaces, &sources));
    assert!((most / expected - 1.0).abs() < 0.05, "{most}, {expected}");
    let everywhere = exposure::most(level(&surfaces, &sources));
    println!("the most by points {expected}, by rays {everywhere}");
    assert!((everywhere / expected).log2().abs() < 1.5, "{everywhere}, {expected}");
    // The limit is relative: a uniformly dim scene, and a dim room by itself, have the usual exposure.
    let (dim_all_over, _) = shown(&mut renderer, lamps([2e-5, 2e-5]));
    let (alone, _) = shown(&mut renderer, lamps([0.0, 2e-5]));
    assert!((mean(&dim_all_over) - mean(&alone)).abs() < 2.0 && mean(&alone) > 50.0);
    renderer.set_camera(lit).unwrap();
    let (beside, _) = shown(&mut renderer, lamps([1.0, 2e-5]));
    let (strong, _) = shown(&mut renderer, lamps([1e4, 0.0]));
    assert!((mean(&beside) - mean(&strong)).abs() < 2.0, "{}, {}", mean(&beside), mean(&strong));
    renderer.gpu().check().unwrap();
}
