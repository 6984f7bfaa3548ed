//! Shadows of the viewer's maps against the CPU's rays: no acne on what is lit, however flat the light falls, no light
//! that creeps under what stands on a floor, no dark lines where two lit walls meet.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use common::{mean_and_stops, picture};
use glam::Vec3;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::picture::{Only, expose::Exposure};
use rebounce::render::render;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_tests::small::small;
use rebounce_viewer::settings::Mode;

const SIZE: u32 = 160;
/// Edges of shadows lie this near to where the CPU's are, pixels: some of them are two texels' filter wide.
const NEAR: u32 = 3;
/// Elsewhere pixels agree to this share of what the CPU has, and of the picture's mean.
const AGREE: [f32; 2] = [0.05, 0.05];
/// But for one in so many: where a floor meets a wall without thickness, behind which light passes, a texel may lie on
/// either.
const ONE_IN: usize = 1500;
/// Relative change within that distance that makes an edge.
const EDGE: f32 = 0.2;

/// Whether the picture changes at a pixel or up to `NEAR` of them away.
fn is_near_an_edge(truth: &[Vec3], at: usize) -> bool {
    let (x, y) = (at as u32 % SIZE, at as u32 / SIZE);
    let around = |v: u32| v.saturating_sub(NEAR)..(v + NEAR + 1).min(SIZE);
    let near = || around(y).flat_map(|y| around(x).map(move |x| truth[(y * SIZE + x) as usize]));
    let least = near().fold(Vec3::INFINITY, Vec3::min);
    let most = near().fold(Vec3::ZERO, Vec3::max);
    // Light that falls off across so few pixels changes less.
    (most - least).max_element() > EDGE * most.max_element()
}

/// Whether light reaches a pixel and all around it.
fn is_lit_around(truth: &[Vec3], at: usize, mean: f32) -> bool {
    let (x, y) = (at as u32 % SIZE, at as u32 / SIZE);
    let around = |v: u32| v.saturating_sub(6)..(v + 7).min(SIZE);
    around(y).all(|y| around(x).all(|x| truth[(y * SIZE + x) as usize].max_element() > 0.15 * mean))
}

#[test]
fn shadows_end_where_the_cpus_do_and_lit_places_are_lit() {
    let scene = small("builtin:cornell-box", 600).unwrap();
    let surfaces = TriangleSurfaces::from_baked(&scene).unwrap();
    let Some(mut renderer) = common::renderer(&scene) else { return };
    renderer.set_mode(Mode::Direct);
    // Down onto the floor and where the blocks stand on it.
    let floor =
        Camera { position: [0.0, 4.6, -0.4], target: [0.0, 0.3, -3.2], up: [0.0, 1.0, 0.0], yfov_deg: 60.0 };
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
        let exposure = Exposure { size: [SIZE; 2], samples: 256, seed: 5 };
        let lights = [light];
        let truth = render(&scene, &surfaces, &floor, &lights, exposure, Only::Direct, || ()).pixels;
        let (mean, stops) = mean_and_stops(&truth);
        renderer.set_camera(floor.clone()).unwrap();
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
        // Wide texels, and corners of what is lit on both sides.
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
