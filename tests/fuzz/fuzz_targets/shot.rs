//! A SHOT.json: a shot with usable numbers, or an error message.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rebounce::io::shot;
use rebounce_fuzz::bounded;

fuzz_target!(|text: &str| {
    match bounded(text.len(), 0, || shot::parse(text)) {
        Ok(shot) => {
            assert!(shot.size.iter().all(|&side| side > 0));
            let frame = shot.camera.frame([0.0; 3]);
            assert!(frame.direction(0.5, 0.5, shot.size[0], shot.size[1]).is_finite());
            for light in shot.lights.iter().map(|light| light.source([0.0; 3])) {
                assert!(light.intensity.is_finite() && light.direction.is_normalized());
            }
        }
        Err(problem) => assert!(!problem.is_empty()),
    }
});
