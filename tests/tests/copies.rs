//! Instanced models in the viewer: a picture of instances equals a picture of separate geometry, and the CPU's
//! picture.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;
use crate::crowd;

use common::{mean_and_stops, picture};
use crowd::{Said, glb};
use glam::{Mat3, Vec3};
use rebounce::bake::bake;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::render;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_shared::octahedral::{pack_snorm16, unpack_snorm16};
use rebounce_shared::rbn::bulk::Vertex;
use rebounce_shared::rbn::meta::Alpha;
use rebounce_tests::small::settings;

const SIZE: [u32; 2] = [64, 48];

/// Returns the file with instances expanded to separate triangles.
fn alone(scene: &BakedScene) -> BakedScene {
    let mut out = BakedScene { instances: Vec::new(), copies: Vec::new(), ..scene.clone() };
    (out.vertices, out.indices) = Default::default();
    for (number, draw) in out.meta.draws.iter_mut().enumerate() {
        let range = draw.first_index as usize..(draw.first_index + draw.index_count) as usize;
        draw.first_index = out.indices.len() as u32;
        let mut add = |vertex: Vertex| {
            out.indices.push(out.vertices.len() as u32);
            out.vertices.push(vertex);
        };
        let corners = || scene.indices[range.clone()].iter().map(|i| scene.vertices[*i as usize]);
        if scene.copies_of(number).is_empty() {
            corners().for_each(&mut add);
        }
        for instance in &scene.instances[scene.copies_of(number)] {
            let place = instance.local_from_model();
            let normals = Mat3::from(place.matrix3).inverse().transpose();
            corners().for_each(|vertex| {
                let normal = (normals * unpack_snorm16(vertex.normal)).normalize();
                add(Vertex {
                    position: place.transform_point3(vertex.position.into()).to_array(),
                    normal: pack_snorm16(normal),
                    uv: vertex.uv,
                });
            });
        }
        draw.index_count = out.indices.len() as u32 - draw.first_index;
    }
    out
}

/// Returns the share of values that differ by more than a tenth, and the relative difference of the means.
fn different(a: &[Vec3], b: &[Vec3]) -> (f32, f32) {
    let mean = |all: &[Vec3]| all.iter().map(|p| p.element_sum()).sum::<f32>() / all.len() as f32;
    assert!(a.len() == b.len() && mean(b) > 0.0, "nothing to compare");
    let least = 0.01 * mean(b);
    let odd = |(a, b): &(&Vec3, &Vec3)| (**a - **b).abs().element_sum() > 0.1 * b.element_sum() + least;
    let share = a.iter().zip(b).filter(odd).count() as f32 / b.len() as f32;
    (share, mean(a) / mean(b) - 1.0)
}

#[test]
#[ignore = "takes much processor time: docs/dev/testing.md"]
fn a_picture_of_copies_is_one_of_things_of_their_own() {
    for alpha in [Alpha::Opaque, Alpha::Blend] {
        let mut room = rebounce::io::from_bytes("crowd", &glb(Said::Instances)).unwrap();
        (room.materials[1].alpha, room.materials[1].base_color[3]) = (alpha, 0.6);
        room.lights = vec![
            Light::Point { position: [1.0, 3.6, 0.5], intensity: 30.0, color: [1.0, 0.9, 0.8], radius: 0.0 },
            Light::Directional {
                direction: [0.3, -1.0, 0.4],
                intensity: 2.0,
                color: [0.7, 0.8, 1.0],
                radius_deg: 0.0,
            },
        ];
        let mut settings = settings(3000);
        settings.viewpoints = vec![[0.0, 3.5, 0.0]];
        let scene = bake(&room, &settings, &()).unwrap().0;
        assert!(scene.instances.len() > 100);
        let (position, target) = ([5.0, 3.0, 4.2], [-1.0, 1.0, -1.0]);
        let camera = Camera { position, target, up: [0.0, 1.0, 0.0], yfov_deg: 60.0 };
        let alone = alone(&scene);
        let (Some(mut copies), Some(mut others)) = (common::renderer(&scene), common::renderer(&alone))
        else {
            return;
        };
        let mut taken = [&mut copies, &mut others].map(|renderer| {
            renderer.set_camera(camera.clone()).unwrap();
            let bounced = common::indirect(renderer, SIZE);
            let (_, stops) = mean_and_stops(&bounced);
            (picture(renderer, SIZE, stops), bounced)
        });
        let [(ours, ours_bounced), (theirs, theirs_bounced)] = &mut taken;
        for (what, ours, theirs) in [("all", ours, theirs), ("bounced", &mut *ours_bounced, theirs_bounced)] {
            let (share, bias) = different(ours, theirs);
            println!("{alpha:?}, {what} light: {share} of the pixels differ, bias {bias}");
            assert!(share < 0.01 && bias.abs() < 0.002, "{alpha:?}, {what}: {share}, {bias}");
        }
        if alpha == Alpha::Opaque {
            let surfaces = TriangleSurfaces::from_baked(&scene).unwrap();
            let exposure = Exposure { size: SIZE, samples: 64, seed: 3 };
            let truth =
                render(&scene, &surfaces, &camera, &room.lights, exposure, Only::Indirect, || ()).pixels;
            let (_, bias) = different(ours_bounced, &truth);
            println!("bounced light against the CPU's: bias {bias}");
            assert!(bias.abs() < 0.01, "{bias}");
        }
        copies.gpu().check().unwrap();
    }
}
