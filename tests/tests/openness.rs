//! Detail of the viewer, from the depth buffer, beside that of the CPU, by rays.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[allow(dead_code, reason = "not all tests tell radiance from pictures")]
mod common;

use glam::Vec3;
use rebounce::picture::{Only, expose::Exposure};
use rebounce::render::{Content, render};
use rebounce::triangles::TriangleSurfaces;
use rebounce_shared::rbn::Scene;
use rebounce_tests::small::small;

const SIZE: [u32; 2] = [160, 120];

/// Root of the mean square of the difference over that of the first picture.
fn apart(truth: &[Vec3], ours: &[Vec3]) -> f32 {
    let square = |pairs: &mut dyn Iterator<Item = Vec3>| pairs.map(|p| p.length_squared()).sum::<f32>();
    let difference = square(&mut truth.iter().zip(ours).map(|(a, b)| a - b));
    (difference / square(&mut truth.iter().copied())).sqrt()
}

/// Bounced light on the CPU, without and with detail, and in the viewer likewise.
fn pictures(scene: &Scene) -> Option<[[Vec<Vec3>; 2]; 2]> {
    let mut renderer = common::renderer(scene)?;
    let surfaces = TriangleSurfaces::from_baked(scene).unwrap();
    let (camera, lights) = (&scene.meta.cameras[0], &scene.meta.lights);
    let exposure = Exposure { size: SIZE, samples: 64, seed: 5 };
    let cpu = [false, true].map(|detail| {
        let content = Content { only: Only::Indirect, detail };
        render(scene, &surfaces, camera, lights, exposure, content, || ()).pixels
    });
    let viewer = [false, true].map(|detail| {
        renderer.set_detail(detail);
        let bytes = pollster::block_on(renderer.read_indirect(SIZE[0], SIZE[1]).unwrap().wait()).unwrap();
        bytemuck::pod_collect_to_vec::<u8, [f32; 4]>(&bytes).iter().map(|p| Vec3::from_slice(p)).collect()
    });
    Some([cpu, viewer])
}

#[test]
fn pictures_with_detail_are_those_of_the_cpu() {
    let scene = small("builtin:cornell-box", 12_000).unwrap();
    let Some([cpu, viewer]) = pictures(&scene) else { return };
    let [without, with] = [0, 1].map(|detail| apart(&cpu[detail], &viewer[detail]));
    let changed = apart(&cpu[0], &cpu[1]);
    println!("{without} apart without detail, {with} with it, which changes {changed}");
    assert!(with < 0.02 && changed > 0.005, "{with}, changes {changed}");
}
