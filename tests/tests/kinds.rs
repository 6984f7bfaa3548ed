//! Every punctual kind of light in the table: the page's direct light is the CPU's.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use common::{CornellBox, cornell_box, difference, picture};
use rebounce::io::picture::Only;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::render;
use rebounce_shared::light::{
    Absent, DIRECTION, INTENSITY, KINDS, Light, LightDescription, LightKind, NUMBERS, POSITION,
};

const SIZE: u32 = 128;
/// Maximum RMS difference, relative: shadows' edges differ by parts of a pixel.
const MOST: f32 = 0.03;

/// Returns a light of a kind within the box, or from the box's open side.
fn example(number: usize, kind: &LightDescription) -> Light {
    let mut numbers = [0.0; NUMBERS];
    numbers[0] = number as f64;
    for (field, _) in kind.fields {
        let value = match (field.at, field.fresh, field.absent) {
            (at, ..) if at == POSITION.at => vec![0.2, 4.5, -1.2],
            (at, ..) if at == DIRECTION.at => vec![0.4, -0.8, -1.0],
            (at, ..) if at == INTENSITY.at => vec![20.0],
            (_, Some(fresh), _) => fresh.to_vec(),
            (_, None, Absent::Vector(vector)) => vector.to_vec(),
            (_, None, Absent::Number(number)) => vec![number],
            (_, None, Absent::Nothing) => vec![f64::NAN],
            (_, None, Absent::Refused) => vec![0.5; field.width],
        };
        numbers[field.at..field.at + field.width].copy_from_slice(&value);
    }
    Light::from_numbers(&numbers).unwrap()
}

#[test]
fn the_pages_light_of_every_kind_is_the_cpus() {
    let Some(CornellBox { scene, surfaces, mut renderer, camera }) = cornell_box() else { return };
    for (number, kind) in KINDS.iter().enumerate().take(LightKind::Directional as usize + 1) {
        let lights = [example(number, kind)];
        let exposure = Exposure { size: [SIZE; 2], samples: 16, seed: 5 };
        let truth = render(&scene, &surfaces, &camera, &lights, exposure, Only::Direct, || ()).pixels;
        let lit = truth.iter().filter(|pixel| pixel.max_element() > 0.0).count();
        assert!(5 * lit > truth.len(), "{}: {lit} of {} pixels are lit", kind.name, truth.len());
        renderer.set_lights(lights.to_vec()).unwrap();
        // The brightest pixel stays below the tone curve's shoulder.
        let brightest = truth.iter().fold(0f32, |most, pixel| most.max(pixel.max_element()));
        let ours = picture(&mut renderer, [SIZE; 2], (0.6 / brightest).log2());
        let (error, bias) = difference(&ours, &truth);
        println!("{}: {lit} lit, RMS {error:.3}, bias {bias:.4}", kind.name);
        assert!(error < MOST, "{}: {error}", kind.name);
    }
    renderer.gpu().check().unwrap();
}
