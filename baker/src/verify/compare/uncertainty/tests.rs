//! Pictures of known error and noise: intervals must contain the truth.

use super::*;
use crate::io::picture::Picture;
use crate::random::Stream;
use crate::verify::compare::compare;
use glam::Vec3;

/// Not a multiple of the blocks' side.
const SIDE: u32 = 60;
const SEEDS: u64 = 100;

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Equal noise in every pixel.
    Even,
    /// One pixel in a hundred is far too bright, the others are a little too dark.
    Fireflies,
    /// Correlated noise of neighbouring pixels, as from reconstruction filters.
    Shared,
}

fn made(of: impl Fn(u32, u32) -> Vec3) -> Picture {
    let pixels = (0..SIDE * SIDE).map(|i| of(i % SIDE, i / SIDE)).collect();
    Picture { width: SIDE, height: SIDE, pixels }
}

/// A synthetic wall: bright to the left, darker to the right, with stripes.
fn truth() -> Picture {
    made(|x, y| Vec3::new(1.0, 0.8, 0.6) * (2.0 - x as f32 / SIDE as f32 + 0.3 * (y as f32 * 0.4).sin()))
}

/// Adds noise of mean 0 and of `strength` relative to the light.
fn with_noise(of: &Picture, kind: Kind, strength: f32, seed: u64) -> Picture {
    let one = |x: u32, y: u32| {
        let mut stream = Stream::new(seed, u64::from(y * (SIDE + 1) + x));
        let even = (2.0 * stream.unit() - 1.0) * 3.0_f32.sqrt();
        match kind {
            Kind::Fireflies => (if stream.unit() < 0.01 { 9.9 } else { -0.1 }) + 0.1 * even,
            Kind::Even | Kind::Shared => even,
        }
    };
    let noise = |x, y| match kind {
        Kind::Shared => (one(x, y) + one(x + 1, y) + one(x, y + 1) + one(x + 1, y + 1)) / 2.0,
        _ => one(x, y),
    };
    made(|x, y| of.pixels[(y * SIDE + x) as usize] * (1.0 + strength * noise(x, y)))
}

/// Adds an error: a blotch too bright by 3 × `error`, and the rest too dark.
fn with_error(of: &Picture, error: f32) -> Picture {
    let shape = |x: u32, y: u32| if x < 12 && y < 12 { 3.0 * error } else { -0.6 * error };
    made(|x, y| of.pixels[(y * SIDE + x) as usize] * (1.0 + shape(x, y)))
}

fn estimates(picture: &Picture, kind: Kind, strength: f32) -> Vec<ErrorEstimate> {
    let truth = truth();
    let of = |seed: u64| {
        let [a, b] = [2 * seed, 2 * seed + 1].map(|seed| with_noise(&truth, kind, strength, seed));
        compare(picture, &a, Some(&b)).unwrap().error
    };
    (0..SEEDS).map(of).collect()
}

#[test]
fn intervals_hold_the_truth() {
    for kind in [Kind::Even, Kind::Fireflies, Kind::Shared] {
        for strength in [0.02, 0.2, 1.0] {
            for error in [0.0, 0.02, 0.1, 0.3] {
                let picture = with_error(&truth(), error);
                let known = compare(&picture, &truth(), None).unwrap().error.figure();
                let found = estimates(&picture, kind, strength);
                let holds = |e: &&ErrorEstimate| e.at_least.unwrap() <= known && known <= e.at_most.unwrap();
                let held = found.iter().filter(holds).count() as u64;
                assert!(held * 10 >= SEEDS * 9, "{kind:?} {strength}, error {known:.4}: {held} of {SEEDS}");
                // No estimate is ever perfect.
                assert!(found.iter().all(|e| e.value != Some(0.0) && e.at_most.unwrap() > 0.0));
                assert!(found.iter().all(|e| !e.said(3).contains("error 0.000")));
            }
        }
    }
}

#[test]
fn what_noise_hides_is_too_noisy_to_tell_and_what_it_does_not_is_told() {
    let count = |found: &[ErrorEstimate], is: fn(&ErrorEstimate) -> bool| {
        found.iter().filter(|e| is(e)).count() as u64
    };
    for kind in [Kind::Even, Kind::Fireflies, Kind::Shared] {
        let hidden = estimates(&with_error(&truth(), 0.002), kind, 1.0);
        assert!(count(&hidden, |e| e.value.is_none()) * 10 >= SEEDS * 9, "{kind:?}");
        assert!(hidden.iter().all(|e| e.is_within(1.0) == Answer::Within));
        assert!(count(&hidden, |e| e.is_within(0.002) == Answer::TooNoisy) * 10 >= SEEDS * 9);
        // Strong noise hides little of a large error.
        let large = with_error(&truth(), 0.3);
        let known = compare(&large, &truth(), None).unwrap().error.figure();
        let plain = estimates(&large, kind, 0.2);
        assert!(
            plain.iter().all(|e| e.value.is_some_and(|value| (value / known - 1.0).abs() < 0.1)),
            "{kind:?}"
        );
        assert!(plain.iter().all(|e| e.is_within(0.7 * known) == Answer::Over));
        assert!(plain.iter().all(|e| e.is_within(1.3 * known) == Answer::Within));
    }
}

#[test]
fn four_times_the_samples_halve_the_interval_of_what_they_hide() {
    let width = |strength: f32| {
        let found = estimates(&with_error(&truth(), 0.0), Kind::Even, strength);
        found.iter().map(|e| e.at_most.unwrap()).sum::<f64>()
    };
    let shrunk = width(0.1) / width(0.2);
    assert!((shrunk - 0.5).abs() < 0.05, "{shrunk}");
}

#[test]
fn of_one_reference_the_noise_is_part_of_the_error() {
    let reference = with_noise(&truth(), Kind::Even, 0.2, 1);
    let error = compare(&truth(), &reference, None).unwrap().error;
    assert!(error.value.unwrap() > 0.15 && error.at_least.is_none() && error.at_most.is_none(), "{error:?}");
    assert_eq!((error.is_within(0.5), error.is_within(0.1)), (Answer::Within, Answer::Over));
}

#[test]
fn a_small_error_is_not_shown_as_none() {
    let clear = ErrorEstimate { value: Some(0.000_04), at_least: Some(0.000_03), at_most: Some(0.000_05) };
    assert_eq!(clear.said(3), "error 4.0e-5 (3.0e-5 to 5.0e-5)");
    let hidden = ErrorEstimate { value: None, at_least: Some(0.0), at_most: Some(0.021_26) };
    assert_eq!(hidden.said(3), "error too noisy to tell, at most 0.021");
    assert_eq!((hidden.figure(), ErrorEstimate::with_noise(0.0).said(3).as_str()), (0.021_26, "error 0.000"));
    assert_eq!((hidden.is_within(0.03), hidden.is_within(0.02)), (Answer::Within, Answer::TooNoisy));
}
