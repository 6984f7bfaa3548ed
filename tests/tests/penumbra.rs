//! Penumbrae of lights with a size: the page's are the CPU's.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use common::{CornellBox, cornell_box, mean_and_stops, picture};
use glam::Vec3;
use rebounce::io::picture::Only;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::render;
use rebounce_shared::light::{Light, SIZE as SIZE_OF_LIGHT};

const SIZE: u32 = 72;
/// Minimum difference from a point light, relative to the brighter value, that counts as penumbra.
const SEEN: f32 = 0.1;
/// Maximum RMS difference to the CPU within the penumbra, as a share of the RMS difference between point and area
/// light on the CPU.
const MOST: f32 = 0.45;

/// Returns the light without a size.
fn point(light: &Light) -> Light {
    light.with(SIZE_OF_LIGHT.at, &[0.0])
}

#[test]
fn penumbrae_are_as_wide_as_the_cpus() {
    let Some(CornellBox { scene, surfaces, mut renderer, camera }) = cornell_box() else { return };
    let color = [1.0; 3];
    let lights = [
        ("point", Light::Point { position: [0.2, 4.7, -1.2], intensity: 20.0, color, radius: 0.25 }),
        (
            "spot",
            Light::Spot {
                position: [-1.5, 4.5, -1.5],
                direction: [0.4, -1.0, -0.4],
                outer_cone_deg: 55.0,
                inner_cone_deg: Some(40.0),
                intensity: 20.0,
                color,
                radius: 0.25,
            },
        ),
        ("sun", Light::Directional { direction: [0.4, -0.8, -1.0], intensity: 4.0, color, radius_deg: 1.0 }),
    ];
    for (name, light) in lights {
        let exposure = Exposure { size: [SIZE; 2], samples: 256, seed: 5 };
        let truth =
            |light: Light| render(&scene, &surfaces, &camera, &[light], exposure, Only::Direct, || ()).pixels;
        let (soft, sharp) = (truth(light.clone()), truth(point(&light)));
        let (_, stops) = mean_and_stops(&soft);
        let most = Vec3::splat(0.7 * (-stops).exp2());
        renderer.set_lights(vec![light]).unwrap();
        let ours = picture(&mut renderer, [SIZE; 2], stops);
        // Pixels in the penumbra.
        let penumbra: Vec<usize> = (0..soft.len())
            .filter(|at| {
                (soft[*at] - sharp[*at]).length() > SEEN * sharp[*at].length().max(soft[*at].length())
            })
            .collect();
        let rms = |picture: &[Vec3]| {
            let off = |at: &usize| (picture[*at].min(most) - soft[*at].min(most)).length_squared();
            (penumbra.iter().map(off).sum::<f32>() / penumbra.len() as f32).sqrt()
        };
        let share = rms(&ours) / rms(&sharp);
        println!("{name}: {} pixels of penumbra, off by {share:.3} of what a point is", penumbra.len());
        assert!(penumbra.len() > soft.len() / 50, "{name}: too little to compare");
        assert!(share < MOST, "{name}: off by {share} of what a point is");
    }
    renderer.gpu().check().unwrap();
}
