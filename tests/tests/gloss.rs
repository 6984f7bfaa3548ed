//! Reflections of metals in the viewer are the CPU's: by links and by matrices, under skies that turn, beside lamps and what
//! shines.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use common::{conductors, difference, radiance};
use glam::Vec3;
use rebounce::bake::bake;
use rebounce::transport::gloss::{GlossSettings, Transfer};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::light::Light;
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
