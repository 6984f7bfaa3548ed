//! Reflections of metals in the viewer are the CPU's: by cube maps, by links and by matrices, under skies that turn, beside lamps
//! and what shines.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use common::{conductors, difference, radiance};
use glam::Vec3;
use rebounce::bake::bake;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Ray, Surfaces};
use rebounce::sampling::cube_maps::CubeMapSettings;
use rebounce::transport::gloss::{GlossSettings, Transfer};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::meta::Material;
use rebounce_tests::small::settings;

const SIZE: [u32; 2] = [64, 54];

/// The trophy with reflections by this transfer, as a page reads it.
fn trophy(transfer: Transfer) -> BakedScene {
    let mut settings = settings(3000);
    settings.gloss = Some(GlossSettings { transfer, ..GlossSettings::default() });
    let file = bake(&rebounce::io::load("builtin:trophy").unwrap(), &settings, &()).unwrap().0;
    assert!(!file.gloss.is_empty());
    BakedScene::from_bytes(&file.to_bytes().unwrap()).unwrap()
}

/// The Cornell box with its tall block of metal, and the front before a metal wall: metals are seen in metals.
fn metal_block() -> BakedScene {
    let mut scene = rebounce::io::load("builtin:cornell-box").unwrap();
    let metal = Material {
        name: "metal".into(),
        base_color: [0.9, 0.8, 0.6, 1.0],
        metallic: 1.0,
        roughness: 0.35,
        ..scene.materials[0].clone()
    };
    let first = scene.materials.len() as u32;
    scene.materials.extend([metal.clone(), Material { roughness: 0.6, emission: [0.3, 0.1, 0.0], ..metal }]);
    // Two triangles a quad: the blocks are last, the tall one after the short one.
    let end = scene.triangle_material.len();
    scene.triangle_material[end - 10..].fill(first);
    scene.triangle_material[end - 20..end - 18].fill(first + 1);
    let file = bake(&scene, &settings(3000), &()).unwrap().0;
    assert!(!file.cube_maps.is_empty() && file.cube_maps.texels.iter().any(|texel| texel.metal().is_some()));
    BakedScene::from_bytes(&file.to_bytes().unwrap()).unwrap()
}

#[test]
fn cube_maps_are_of_rooms_and_not_of_the_open() {
    let scene = rebounce::io::load("builtin:trophy").unwrap();
    let mut settings = settings(500);
    assert!(bake(&scene, &settings, &()).unwrap().0.cube_maps.is_empty());
    let gloss = settings.gloss.as_mut().unwrap();
    gloss.cube_maps = CubeMapSettings { count: 2, side: 8, most_open: 1.0, ..gloss.cube_maps };
    assert_eq!(bake(&scene, &settings, &()).unwrap().0.cube_maps.layout.places.len(), 2);
}

fn sky(rotation_deg: f64) -> Light {
    Light::Environment { file: None, rotation_deg, intensity: 1.0, color: [1.0, 0.9, 0.8] }
}

#[test]
fn reflections_are_those_of_the_cpu() {
    for transfer in [Transfer::Links, Transfer::Matrices] {
        let scene = trophy(transfer);
        let Some(mut renderer) = common::renderer(&scene) else { return };
        renderer.set_detail(false);
        renderer.set_conductors(true);
        let lamp =
            Light::Point { position: [1.5, 2.5, 1.5], intensity: 400.0, color: [1.0, 0.6, 0.3], radius: 0.0 };
        let mut seen: Vec<Vec<Vec3>> = Vec::new();
        for lights in [vec![sky(0.0)], vec![sky(140.0)], vec![sky(140.0), lamp]] {
            renderer.set_lights(lights.clone()).unwrap();
            let truth = conductors(&scene, &lights, SIZE);
            let (error, bias) = difference(&radiance(&mut renderer, SIZE), &truth);
            println!("{transfer:?}, {} lights: {error:.4}, bias {bias:+.4}", lights.len());
            assert!(error < 0.03 && bias.abs() < 0.01, "{transfer:?}: {error}, bias {bias}");
            assert!(
                seen.iter().all(|before| difference(before, &truth).0 > 0.05),
                "light changes the picture"
            );
            seen.push(truth);
        }
    }
}

/// Whether a pixel of the scene's camera shows metal alone.
fn metal_pixels(scene: &BakedScene) -> Vec<bool> {
    let surfaces = TriangleSurfaces::from_baked(scene).unwrap();
    let frame = scene.meta.cameras[0].frame(scene.meta.origin);
    let [width, height] = SIZE;
    let is_metal = |x: f32, y: f32| {
        let ray = Ray::visibility(frame.eye, frame.direction(x, y, width, height));
        surfaces.see(&ray, 0).is_some_and(|hit| hit.gloss.is_metal())
    };
    let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
    let shows =
        |i: u32| corners.iter().all(|(x, y)| is_metal((i % width) as f32 + x, (i / width) as f32 + y));
    (0..width * height).map(shows).collect()
}

#[test]
fn reflections_in_a_room_are_those_of_the_cpu() {
    let scene = metal_block();
    let Some(mut renderer) = common::renderer(&scene) else { return };
    renderer.set_detail(false);
    renderer.set_conductors(true);
    let shown = metal_pixels(&scene);
    // At the edges of shadows a pixel of the viewer is one sample.
    let of_metal = |picture: &[Vec3]| -> Vec<Vec3> {
        picture.iter().zip(&shown).filter(|(_, is_shown)| **is_shown).map(|(pixel, _)| *pixel).collect()
    };
    let own = scene.meta.lights[0].clone();
    let lamp =
        Light::Point { position: [-1.5, 3.5, -1.0], intensity: 60.0, color: [0.4, 0.6, 1.0], radius: 0.0 };
    let shining = Light::Emissive { group: 0, intensity: 2.0, color: [1.0, 0.9, 0.8] };
    let mut seen: Vec<Vec<Vec3>> = Vec::new();
    for lights in [vec![own.clone()], vec![lamp], vec![own, sky(30.0)], vec![shining]] {
        renderer.set_lights(lights.clone()).unwrap();
        let truth = of_metal(&conductors(&scene, &lights, SIZE));
        assert!(truth.len() > 200, "{} pixels", truth.len());
        let (error, bias) = difference(&of_metal(&radiance(&mut renderer, SIZE)), &truth);
        println!("{} lights: {error:.4}, bias {bias:+.4}", lights.len());
        assert!(error < 0.03 && bias.abs() < 0.01, "{error}, bias {bias}");
        assert!(seen.iter().all(|before| difference(before, &truth).0 > 0.05), "light changes the picture");
        seen.push(truth);
    }
}
