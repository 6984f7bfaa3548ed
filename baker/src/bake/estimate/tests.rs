//! Tests of the estimate over complete bakes: replays recorded bakes with the measured times of their parts.

use super::*;
use crate::bake::Preset;
use serde::Deserialize;

/// Recorded bake, as written by `cargo xtask plot-estimate --record`.
#[derive(Clone, Debug, Deserialize)]
struct Course {
    scene: String,
    preset: String,
    triangles: usize,
    ray_triangles: u64,
    /// Points of each level.
    functions: Vec<usize>,
    /// Entries of the rows for later bounces.
    coarse_entries: u64,
    parts: Vec<Recorded>,
}

/// Part of a recorded bake: units of work and processor seconds.
#[derive(Clone, Debug, Deserialize)]
struct Recorded {
    stage: String,
    level: Option<usize>,
    units: f64,
    seconds: f64,
}

/// Recorded bakes. Measured with one thread on two cores.
fn courses() -> Vec<Course> {
    serde_json::from_str(include_str!("courses.json")).unwrap()
}

fn stage(label: &str) -> Stage {
    let all = [
        Stage::Bvh,
        Stage::Points,
        Stage::ClipPlanes,
        Stage::Hierarchy,
        Stage::Tints,
        Stage::HitCache,
        Stage::Links,
        Stage::CoarseMatrix,
        Stage::Multibounce,
        Stage::Assemble,
    ];
    all.into_iter().find(|stage| stage.label() == label).unwrap()
}

fn preset(name: &str) -> Preset {
    let all = [Preset::Draft, Preset::Standard, Preset::Fine];
    all.into_iter().find(|preset| preset.name() == name).unwrap()
}

/// Number of progress updates per part.
const STEPS: usize = 50;

/// State of a replayed bake.
struct Run {
    estimate: Estimate,
    /// Clock seconds per processor second.
    stretch: f64,
    past: f64,
    total: f64,
    /// At every update: share of the total time passed, and the ratio of estimated to true time left, for processor
    /// time and for clock time.
    found: Vec<(f64, f64, f64)>,
}

impl Run {
    fn part(&mut self, stage: Stage, level: Option<usize>, units: f64, seconds: f64) {
        for step in 1..=STEPS {
            let done = units * step as f64 / STEPS as f64;
            let primitive = seconds / STEPS as f64;
            self.estimate.advance((stage, level), done, 0.0, self.stretch * primitive, primitive);
            self.past += primitive;
            let (left, truth) = (self.estimate.left(), self.total - self.past);
            let truth = truth.max(1e-9 * self.total);
            self.found.push((
                self.past / self.total,
                left.processor_seconds / truth,
                left.seconds / (self.stretch * truth),
            ));
        }
        self.estimate.end(stage, level);
    }
}

/// Replays a bake on a machine slower by the factor `slow`, with `stretch` clock seconds per processor second.
fn follow(course: &Course, slow: f64, stretch: f64) -> Run {
    let settings = BakeSettings::new(preset(&course.preset)).normalised();
    let total: f64 = course.parts.iter().map(|part| part.seconds).sum();
    let estimate = Estimate::new(&settings, course.triangles, false, 1);
    let mut run = Run { estimate, stretch, past: 0.0, total: slow * total, found: Vec::new() };
    for Recorded { stage: label, level, units, seconds } in &course.parts {
        let (stage, level) = (stage(label), *level);
        match stage {
            Stage::HitCache => run.estimate.expect_units((stage, level), *units),
            Stage::Links => run.estimate.expect_rays(level.unwrap(), *units),
            Stage::Multibounce => run.estimate.expect_bounces(*units, course.coarse_entries as f64),
            Stage::Assemble => {
                let left = run.estimate.left().processor_seconds;
                let is_all = (left - slow * seconds).abs() < 0.05 * run.total;
                assert!(is_all, "{}: only the file is left", course.scene);
            }
            _ => {}
        }
        run.part(stage, level, *units, slow * seconds);
        match (stage, level) {
            (Stage::Bvh, _) => run.estimate.found_surfaces(&settings, course.ray_triangles),
            (Stage::Points, Some(level)) => {
                run.estimate.found_points(&settings, &course.functions[..=level]);
            }
            _ => {}
        }
    }
    run
}

#[test]
fn from_a_third_of_the_way_on_it_is_right_within_a_quarter() {
    for course in &courses() {
        for (slow, stretch) in [(1.0, 1.0), (3.0, 1.0), (0.4, 1.0), (1.0, 2.5)] {
            let run = follow(course, slow, stretch);
            for (share, processors, clock) in run.found.into_iter().filter(|e| e.0 > 1.0 / 3.0 && e.0 < 0.97)
            {
                let is_right = |ratio: f64| (0.75..1.25).contains(&ratio);
                assert!(
                    is_right(processors) && is_right(clock),
                    "{} {}, {slow} times as slow, stretched by {stretch}: at {share:.2} of the way {processors:.2} \
                     of the truth, {clock:.2} by the clock",
                    course.scene,
                    course.preset
                );
            }
        }
    }
}

#[test]
fn what_was_done_before_takes_no_time_and_measures_nothing() {
    let settings = BakeSettings::new(Preset::Standard).normalised();
    let mut estimate = Estimate::new(&settings, 100_000, false, 2);
    let before = estimate.left();
    let part = (Stage::Links, Some(5));
    let units = estimate.units(part.0, part.1);
    let nominal = estimate.part(part.0, part.1).unwrap().nominal;
    estimate.advance(part, 0.5 * units, 0.5 * units, 0.0, 0.0);
    let now = estimate.left();
    assert!((now.processor_seconds - (before.processor_seconds - 0.5 * nominal)).abs() < 1e-6 * nominal);
    estimate.end(part.0, part.1);
    assert_eq!(estimate.known, [None; 5]);
}

#[test]
fn a_busy_machine_takes_longer_by_the_clock_alone() {
    let course = &courses()[0];
    let (quiet, busy) = (follow(course, 1.0, 1.0), follow(course, 1.0, 3.0));
    for (quiet, busy) in quiet.found.iter().zip(&busy.found) {
        assert!((quiet.1 - busy.1).abs() < 1e-9, "the processors' time is the same");
    }
}
