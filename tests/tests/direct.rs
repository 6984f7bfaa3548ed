//! The page's direct light against the CPU's: equal away from shadow edges, and edges at the CPU's places, in the sun
//! and under lamps.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use glam::Vec3;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::render;
use rebounce_tests::small::small;
use rebounce_viewer::settings::Mode;

const SIZE: [u32; 2] = [192, 108];
/// Maximum distance of a shadow's edge from the CPU's, pixels; pixels within this distance of the CPU's edges are not
/// compared.
const NEAR: u32 = 2;
/// Maximum relative RMS difference of the compared pixels.
const RMS: f32 = 0.03;
/// Relative change within `NEAR` pixels that counts as an edge.
const EDGE: f32 = 0.2;
/// Tolerance of a pixel beyond the other picture's range nearby, as a share of the picture's maximum.
const LOOSE: f32 = 0.1;
/// Reciprocal of the maximum share of astray pixels.
const ONE_IN: usize = 400;

/// Returns the minimum and maximum of the pixels near a pixel, by component.
fn range(picture: &[Vec3], at: usize) -> [Vec3; 2] {
    let [width, height] = SIZE;
    let (x, y) = (at as u32 % width, at as u32 / width);
    let around = |v: u32, end: u32| v.saturating_sub(NEAR)..(v + NEAR + 1).min(end);
    let mut out = [Vec3::INFINITY, Vec3::ZERO];
    for y in around(y, height) {
        for x in around(x, width) {
            let pixel = picture[(y * width + x) as usize];
            out = [out[0].min(pixel), out[1].max(pixel)];
        }
    }
    out
}

fn is_edge([least, most]: [Vec3; 2]) -> bool {
    (most - least).max_element() > EDGE * most.max_element()
}

/// Number of pixels of `a` outside the range of `b` nearby: the area between edges too far apart.
fn astray(a: &[Vec3], b: &[Vec3], loose: f32) -> usize {
    let is_astray = |at: &usize| {
        let [least, most] = range(b, *at);
        (a[*at] - least).min_element() < -loose || (a[*at] - most).max_element() > loose
    };
    (0..a.len()).filter(is_astray).count()
}

#[test]
fn direct_light_is_the_cpus_and_its_edges_lie_where_the_cpus_do() {
    let scene = small("builtin:apartment", 600).unwrap();
    let surfaces = TriangleSurfaces::from_baked(&scene).unwrap();
    let Some(mut renderer) = common::renderer(&scene) else { return };
    renderer.set_mode(Mode::Direct);
    // The living room in the sun, and with every lamp as well.
    let views = [(0, 0..1), (0, 0..6)];
    for (camera, lights) in views {
        let name = format!("camera {camera}, lights {lights:?}");
        let (camera, lights) = (&scene.meta.cameras[camera], &scene.meta.lights[lights]);
        let exposure = Exposure { size: SIZE, samples: 64, seed: 5 };
        let truth = render(&scene, &surfaces, camera, lights, exposure, Only::Direct, || ()).pixels;
        // The exposure keeps 99% of the pixels below the tone curve's shoulder, except spots beside a lamp.
        let mut values: Vec<f32> = truth.iter().map(|pixel| pixel.max_element()).collect();
        values.sort_by(f32::total_cmp);
        let brightest = values[values.len() - 1 - values.len() / 100];
        let stops = (0.6 / brightest).log2();
        let most = 0.7 * (-stops).exp2();
        renderer.set_camera(camera.clone()).unwrap();
        renderer.set_lights(lights.to_vec()).unwrap();
        let ours = common::picture(&mut renderer, SIZE, stops);
        let capped = |picture: &[Vec3]| picture.iter().map(|p| p.min(Vec3::splat(most))).collect::<Vec<_>>();
        let (truth, ours) = (capped(&truth), capped(&ours));
        let even: Vec<usize> = (0..truth.len()).filter(|at| !is_edge(range(&truth, *at))).collect();
        let sum = |of: &dyn Fn(usize) -> Vec3| even.iter().map(|at| of(*at).length_squared()).sum::<f32>();
        let rms = (sum(&|at| ours[at] - truth[at]) / sum(&|at| truth[at])).sqrt();
        let astray = [(&truth, &ours), (&ours, &truth)].map(|(a, b)| astray(a, b, LOOSE * brightest));
        println!("{name}: {} of {} compared, RMS {rms:.4}; astray {astray:?}", even.len(), truth.len());
        assert!(2 * even.len() > truth.len(), "{name}: too little to compare");
        assert!(rms < RMS, "{name}: {rms}");
        assert!(astray.iter().all(|count| *count <= truth.len() / ONE_IN), "{name}: {astray:?}");
    }
    renderer.gpu().check().unwrap();
}
