//! A SHOT.json: a shot whose numbers can be used, or what is wrong with it.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rebounce::shot;

fuzz_target!(|text: &str| {
    match shot::parse(text) {
        Ok(shot) => assert!(shot.size.iter().all(|&side| side > 0)),
        Err(problem) => assert!(!problem.is_empty()),
    }
});
