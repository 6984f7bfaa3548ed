//! Lookup and splatting of functions give the same picture.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_shared::baked::BakedScene;
use rebounce_tests::small::{everything, small};
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::settings::{Display, Mode};

const SIZE: [u32; 2] = [96, 72];

fn values(renderer: &mut Renderer, way: Display, mode: Option<Mode>) -> Vec<f32> {
    renderer.set_display(way);
    let [width, height] = SIZE;
    let values = match mode {
        // Linear, of Lambertian surfaces.
        None => {
            let bytes = pollster::block_on(renderer.read_indirect(width, height).unwrap().wait()).unwrap();
            bytemuck::pod_collect_to_vec(&bytes)
        }
        // As on the screen, with normal maps.
        Some(mode) => {
            renderer.set_mode(mode);
            let bytes = pollster::block_on(renderer.read_pixels(width, height).unwrap().wait()).unwrap();
            bytes.iter().map(|byte| *byte as f32).collect()
        }
    };
    assert_eq!(renderer.stats().display, way.name());
    values
}

/// Returns the RMS difference of lookup and splatting, relative to lookup.
fn apart(scene: &BakedScene, mode: Option<Mode>) -> Option<f64> {
    let mut renderer = common::renderer(scene)?;
    renderer.set_auto_exposure(true);
    let [lookup, splat] = [Display::Lookup, Display::Splat].map(|way| values(&mut renderer, way, mode));
    let colours = || lookup.chunks(4).zip(splat.chunks(4)).flat_map(|(a, b)| (0..3).map(|c| (a[c], b[c])));
    let power: f64 = colours().map(|(a, _)| (a as f64).powi(2)).sum();
    let error: f64 = colours().map(|(a, b)| (a as f64 - b as f64).powi(2)).sum();
    assert!(power > 0.0, "nothing to compare");
    renderer.gpu().check().unwrap();
    Some((error / power).sqrt())
}

/// The Cornell box as baked, and with holes: the finest level ends in the middle of the room, the next coarser level
/// covers three quarters of the room.
#[test]
fn both_ways_make_one_picture_wherever_levels_end() {
    let whole = small("builtin:cornell-box", 2400).unwrap();
    let mut holes = whole.clone();
    let [finest, next] = [whole.meta.levels.len() - 1, whole.meta.levels.len() - 2];
    let middle = 0.5 * (whole.meta.bounds_min[0] + whole.meta.bounds_max[0]);
    let quarter = 0.5 * (whole.meta.bounds_min[1] + middle);
    for i in whole.level(finest).filter(|i| whole.points[*i].position[0] > middle) {
        holes.points[i].radius *= 1e-3;
    }
    for i in whole.level(next).filter(|i| whole.points[*i].position[1] < quarter) {
        holes.points[i].radius *= 1e-3;
    }
    for (name, scene) in [("whole", &whole), ("holes", &holes)] {
        let Some(error) = apart(scene, None) else { return };
        println!("{name}: {error}");
        assert!(error < 0.01, "{name}: {error}");
    }
}

#[test]
fn both_ways_bend_light_by_normal_maps() {
    let mut scene = everything(1200).unwrap();
    // On every surface.
    for material in &mut scene.meta.materials {
        let uv_from_vertex = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        material.normal_texture =
            Some(rebounce_shared::rbn::meta::DetailTexture { texture: 0, uv_from_vertex });
    }
    let Some(bent) = apart(&scene, Some(Mode::Indirect)) else { return };
    println!("normal maps: {bent}");
    assert!(bent < 0.01, "{bent}");
}
