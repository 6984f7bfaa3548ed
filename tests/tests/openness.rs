//! Comparison of detail in the viewer (from the depth buffer) and on the CPU (by rays).
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use glam::Vec3;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::{Content, render};
use rebounce_shared::baked::BakedScene;
use rebounce_tests::small::small;

const SIZE: [u32; 2] = [160, 120];

/// Returns bounced light on the CPU, without and with detail, then the same for the viewer; `None` without an
/// adapter.
fn pictures(scene: &BakedScene) -> Option<[[Vec<Vec3>; 2]; 2]> {
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
        common::indirect(&mut renderer, SIZE)
    });
    Some([cpu, viewer])
}

#[test]
fn pictures_with_detail_are_those_of_the_cpu() {
    let scene = small("builtin:cornell-box", 12_000).unwrap();
    let Some([cpu, viewer]) = pictures(&scene) else { return };
    let [without, with] = [0, 1].map(|detail| common::difference(&viewer[detail], &cpu[detail]).0);
    let changed = common::difference(&cpu[1], &cpu[0]).0;
    println!("{without} apart without detail, {with} with it, which changes {changed}");
    assert!(with < 0.02 && changed > 0.005, "{with}, changes {changed}");
}
