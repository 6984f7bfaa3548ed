//! Shadow maps of the viewer against the CPU's rays: no acne on lit surfaces at grazing light, no light leaks under
//! objects on a floor, no dark lines at the joint of two lit walls.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use common::{CornellBox, cornell_box, mean_and_stops, picture};
use glam::Vec3;
use rebounce::io::picture::Only;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::render;
use rebounce_shared::light::Light;

const SIZE: u32 = 160;
/// Maximum distance of a shadow's edge from the CPU's edge, pixels: the filter is up to two texels wide.
const NEAR: u32 = 3;
/// Tolerance away from edges, as shares of the CPU's pixel and of the picture's mean.
const AGREE: [f32; 2] = [0.05, 0.05];
/// Reciprocal of the share of pixels exempt from the tolerance: at the joint of a floor and a wall without thickness,
/// with light behind the wall, a texel may lie on either side.
const ONE_IN: usize = 1500;
/// Relative change within `NEAR` pixels that counts as an edge.
const EDGE: f32 = 0.2;

/// Returns true if the picture has an edge within `NEAR` pixels of a pixel.
fn is_near_an_edge(truth: &[Vec3], at: usize) -> bool {
    let (x, y) = (at as u32 % SIZE, at as u32 / SIZE);
    let around = |v: u32| v.saturating_sub(NEAR)..(v + NEAR + 1).min(SIZE);
    let near = || around(y).flat_map(|y| around(x).map(move |x| truth[(y * SIZE + x) as usize]));
    let least = near().fold(Vec3::INFINITY, Vec3::min);
    let most = near().fold(Vec3::ZERO, Vec3::max);
    // Smooth falloff changes less over a few pixels.
    (most - least).max_element() > EDGE * most.max_element()
}

/// Returns true if a pixel and its neighbourhood of 6 pixels are lit.
fn is_lit_around(truth: &[Vec3], at: usize, mean: f32) -> bool {
    let (x, y) = (at as u32 % SIZE, at as u32 / SIZE);
    let around = |v: u32| v.saturating_sub(6)..(v + 7).min(SIZE);
    around(y).all(|y| around(x).all(|x| truth[(y * SIZE + x) as usize].max_element() > 0.15 * mean))
}

#[test]
fn shadows_end_where_the_cpus_do_and_lit_places_are_lit() {
    let Some(CornellBox { scene, surfaces, mut renderer, camera: floor }) = cornell_box() else { return };
    let color = [1.0; 3];
    let lights = [
        ("point", Light::Point { position: [0.2, 4.9, -1.2], intensity: 20.0, color, radius: 0.0 }),
        ("a flat point", Light::Point { position: [-2.5, 0.35, -0.4], intensity: 20.0, color, radius: 0.0 }),
        (
            "a flat spot",
            Light::Spot {
                position: [2.4, 0.5, -0.3],
                direction: [-1.0, -0.1, -0.7],
                outer_cone_deg: 50.0,
                inner_cone_deg: Some(49.0),
                intensity: 40.0,
                color,
                radius: 0.0,
            },
        ),
        (
            "directional",
            Light::Directional { direction: [0.5, -0.6, -1.0], intensity: 4.0, color, radius_deg: 0.0 },
        ),
        (
            "a flat directional",
            Light::Directional { direction: [0.3, -0.08, -1.0], intensity: 30.0, color, radius_deg: 0.0 },
        ),
    ];
    for (name, light) in lights {
        let exposure = Exposure { size: [SIZE; 2], samples: 64, seed: 5 };
        let lights = [light];
        let truth = render(&scene, &surfaces, &floor, &lights, exposure, Only::Direct, || ()).pixels;
        let (mean, stops) = mean_and_stops(&truth);
        renderer.set_lights(lights.to_vec()).unwrap();
        let ours = picture(&mut renderer, [SIZE; 2], stops);
        let most = 0.7 * (-stops).exp2();
        let compared: Vec<usize> = (0..truth.len())
            .filter(|at| truth[*at].max_element() < most && !is_near_an_edge(&truth, *at))
            .collect();
        let wrong: Vec<usize> = compared
            .iter()
            .copied()
            .filter(|at| {
                let (a, b) = (ours[*at], truth[*at]);
                (a - b).abs().max_element() > AGREE[0] * b.max_element() + AGREE[1] * mean
            })
            .collect();
        let dark = compared.iter().filter(|at| truth[**at].max_element() < 0.01 * mean).count();
        println!("{name}: {} compared, {dark} of them dark, {} differ", compared.len(), wrong.len());
        // Wide texels, at corners lit on both sides.
        renderer.set_largest_shadow_map(256);
        let coarse = picture(&mut renderer, [SIZE; 2], stops);
        renderer.set_largest_shadow_map(2048);
        let lit: Vec<usize> = (0..truth.len())
            .filter(|at| is_lit_around(&truth, *at, mean) && truth[*at].max_element() < most)
            .collect();
        let shares: Vec<f32> =
            lit.iter().map(|at| coarse[*at].element_sum() / truth[*at].element_sum()).collect();
        let darkest = shares.iter().copied().fold(1.0, f32::min);
        let darker = shares.iter().filter(|share| **share < 0.9).count();
        println!("{name}, wide texels: {} lit, {darker} darker by a tenth, {darkest} at worst", lit.len());
        assert!(
            lit.len() > 1000 && darker <= lit.len() / 50,
            "{name}: {darker} of {} are too dark",
            lit.len()
        );
        assert!(compared.len() > truth.len() / 2 && dark > 200, "{name}: too little to compare");
        let first = wrong.first().map(|at| (at % SIZE as usize, at / SIZE as usize, truth[*at], ours[*at]));
        assert!(wrong.len() <= compared.len() / ONE_IN, "{name}: {} differ, such as {first:?}", wrong.len());
    }
    renderer.gpu().check().unwrap();
}
