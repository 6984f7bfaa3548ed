//! Files for an environment in the viewer look as on the CPU: under skies that turn, beside lamps, and in parts.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use common::{conductors, difference, radiance};
use glam::Vec3;
use rebounce::bake::bake;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::light::Light;
use rebounce_tests::small::settings;

const SIZE: [u32; 2] = [64, 54];

fn trophy() -> BakedScene {
    let settings = settings(3000).for_environment().normalised();
    let file = bake(&rebounce::io::load("builtin:trophy").unwrap(), &settings, &()).unwrap().0;
    assert!(file.is_for_environment() && !file.gloss.is_empty());
    BakedScene::from_bytes(&file.to_bytes().unwrap()).unwrap()
}

#[test]
fn an_object_looks_as_on_the_cpu_after_every_change_of_light() {
    let scene = trophy();
    let Some(mut renderer) = common::renderer(&scene) else { return };
    renderer.set_detail(false);
    renderer.set_conductors(true);
    let sky = |rotation_deg: f64| Light::Environment {
        file: None,
        rotation_deg,
        intensity: 1.0,
        color: [1.0, 0.9, 0.8],
    };
    let lamp =
        Light::Point { position: [1.5, 2.5, 1.5], intensity: 400.0, color: [1.0, 0.6, 0.3], radius: 0.0 };
    let sun = Light::Directional {
        direction: [-0.5, -0.8, -0.3],
        intensity: 6.0,
        color: [1.0, 0.9, 0.8],
        radius_deg: 0.0,
    };
    let mut seen: Vec<Vec<Vec3>> = Vec::new();
    for lights in [vec![sky(0.0)], vec![sky(140.0)], vec![sky(140.0), lamp], vec![sun], vec![sky(0.0)]] {
        renderer.set_lights(lights.clone()).unwrap();
        let truth = conductors(&scene, &lights, SIZE);
        let (error, bias) = difference(&radiance(&mut renderer, SIZE), &truth);
        println!("{} lights: {error:.4}, bias {bias:+.4}", lights.len());
        assert!(error < 0.03 && bias.abs() < 0.01, "{error}, bias {bias}");
        let last = seen.last();
        assert!(last.is_none_or(|before| difference(before, &truth).0 > 0.05), "light changes the picture");
        seen.push(truth);
    }
    // Without any light all is dark, and light comes back.
    renderer.set_lights(Vec::new()).unwrap();
    assert!(radiance(&mut renderer, SIZE).iter().all(|pixel| pixel.max_element() < 1e-4));
    renderer.set_lights(vec![sky(0.0)]).unwrap();
    assert!(difference(&radiance(&mut renderer, SIZE), &seen[0]).0 < 0.03);
}
