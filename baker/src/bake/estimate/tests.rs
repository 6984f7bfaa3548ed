//! The estimate over whole bakes: what it is told as a bake goes on, at the times that real bakes took for their parts.

use super::*;
use crate::bake::Preset;

/// What a bake was: counts, and processor seconds of its parts, by level where there are levels.
#[derive(Clone, Debug)]
struct Course {
    name: &'static str,
    preset: Preset,
    triangles: usize,
    points: &'static [usize],
    rays: &'static [u64],
    /// Columns, and entries of the coarse rows.
    bounces: [f64; 2],
    prepare: f64,
    placing: &'static [f64],
    /// Walls, relations, colours.
    shaping: [f64; 3],
    links: &'static [f64],
    bouncing: f64,
    rest: f64,
}

/// Measured with one thread on two cores, while a job kept the other one busy.
const COURSES: &[Course] = &[
    Course {
        name: "apartment",
        preset: Preset::Draft,
        triangles: 6516,
        points: &[213, 772, 2497, 8369, 30004],
        rays: &[436224, 1581056, 2556928, 8567808, 15337472],
        bounces: [2698.0, 307825.0],
        prepare: 0.19,
        placing: &[0.02, 0.08, 0.15, 0.36, 0.89],
        shaping: [0.20, 0.04, 0.33],
        links: &[0.14, 0.48, 0.84, 1.88, 3.40],
        bouncing: 1.00,
        rest: 0.06,
    },
    Course {
        name: "Cornell box",
        preset: Preset::Draft,
        triangles: 30,
        points: &[158, 553, 2035, 7908, 31081],
        rays: &[323584, 1132544, 2083840, 8097792, 15903232],
        bounces: [2035.0, 667495.0],
        prepare: 0.09,
        placing: &[0.01, 0.02, 0.05, 0.19, 0.55],
        shaping: [0.17, 0.03, 0.22],
        links: &[0.07, 0.23, 0.46, 1.26, 2.36],
        bouncing: 2.10,
        rest: 0.04,
    },
    Course {
        name: "country kitchen",
        preset: Preset::Draft,
        triangles: 1021596,
        points: &[182, 617, 2062, 6708, 25681],
        rays: &[372736, 1263616, 2111488, 6867968, 13213184],
        bounces: [2239.0, 493902.0],
        prepare: 1.01,
        placing: &[0.02, 0.08, 0.15, 0.33, 0.81],
        shaping: [0.21, 0.03, 1.65],
        links: &[0.16, 0.55, 1.01, 2.01, 4.19],
        bouncing: 1.86,
        rest: 0.48,
    },
    Course {
        name: "kitchen",
        preset: Preset::Draft,
        triangles: 56914,
        points: &[162, 571, 1658, 5480, 20433],
        rays: &[331776, 1169408, 1697792, 5600256, 10404352],
        bounces: [1840.0, 284245.0],
        prepare: 0.19,
        placing: &[0.03, 0.10, 0.16, 0.38, 0.65],
        shaping: [0.17, 0.04, 0.55],
        links: &[0.15, 0.55, 0.88, 1.91, 3.57],
        bouncing: 0.62,
        rest: 0.08,
    },
    Course {
        name: "library",
        preset: Preset::Draft,
        triangles: 4488,
        points: &[174, 550, 1952, 6887, 24485],
        rays: &[356352, 1126400, 1998848, 7052288, 12533248],
        bounces: [2116.0, 445990.0],
        prepare: 0.14,
        placing: &[0.02, 0.05, 0.10, 0.26, 0.57],
        shaping: [0.20, 0.04, 0.26],
        links: &[0.12, 0.39, 0.79, 1.73, 3.08],
        bouncing: 1.27,
        rest: 0.06,
    },
    Course {
        name: "Sponza (Crytek)",
        preset: Preset::Draft,
        triangles: 262266,
        points: &[157, 620, 1913, 5692, 20442],
        rays: &[321536, 1269760, 1958912, 5828608, 10466304],
        bounces: [2026.0, 206123.0],
        prepare: 0.56,
        placing: &[0.03, 0.13, 0.23, 0.40, 0.95],
        shaping: [0.30, 0.04, 0.64],
        links: &[0.19, 0.78, 1.26, 2.39, 4.45],
        bouncing: 0.29,
        rest: 0.17,
    },
    Course {
        name: "Sponza (Dabrovic)",
        preset: Preset::Draft,
        triangles: 66445,
        points: &[231, 708, 1926, 5633, 17748],
        rays: &[473088, 1449984, 1972224, 5768192, 9085440],
        bounces: [2197.0, 284037.0],
        prepare: 0.40,
        placing: &[0.04, 0.11, 0.21, 0.46, 0.66],
        shaping: [0.22, 0.04, 0.65],
        links: &[0.23, 0.77, 1.20, 2.21, 3.60],
        bouncing: 1.14,
        rest: 0.12,
    },
    Course {
        name: "living room",
        preset: Preset::Standard,
        triangles: 1551,
        points: &[253, 874, 3095, 11607, 45064, 173363],
        rays: &[1036288, 3579904, 6338560, 11885568, 22920192, 81850368],
        bounces: [3122.0, 504761.0],
        prepare: 0.12,
        placing: &[0.01, 0.04, 0.10, 0.32, 1.16, 2.86],
        shaping: [0.87, 0.29, 1.09],
        links: &[0.23, 0.82, 1.53, 2.11, 4.37, 13.92],
        bouncing: 1.85,
        rest: 0.18,
    },
    Course {
        name: "Sponza (Dabrovic)",
        preset: Preset::Standard,
        triangles: 66445,
        points: &[389, 1144, 2854, 9036, 29124, 107828],
        rays: &[1593344, 4685824, 5844992, 9249792, 14901760, 55166464],
        bounces: [3312.0, 500115.0],
        prepare: 0.37,
        placing: &[0.05, 0.17, 0.20, 0.50, 1.20, 2.46],
        shaping: [0.98, 0.18, 2.18],
        links: &[0.67, 2.22, 2.89, 3.45, 5.83, 19.19],
        bouncing: 2.37,
        rest: 0.27,
    },
    Course {
        name: "country kitchen",
        preset: Preset::Standard,
        triangles: 1021596,
        points: &[293, 930, 2921, 10089, 34799, 128169],
        rays: &[1200128, 3809280, 5982208, 10441728, 17818112, 65747456],
        bounces: [3162.0, 787035.0],
        prepare: 0.99,
        placing: &[0.03, 0.13, 0.17, 0.49, 1.16, 2.74],
        shaping: [0.86, 0.17, 3.15],
        links: &[0.49, 1.55, 2.56, 3.23, 5.66, 18.68],
        bouncing: 3.96,
        rest: 0.62,
    },
];

/// Pieces that a part is told of.
const STEPS: usize = 50;

/// A bake under way.
struct Run {
    estimate: Estimate,
    /// The clock's seconds over the processors'.
    stretch: f64,
    past: f64,
    total: f64,
    /// Shares of the way, and the time left then, estimated over true: the processors' and the clock's.
    found: Vec<(f64, f64, f64)>,
}

impl Run {
    fn part(&mut self, stage: Stage, level: Option<usize>, units: f64, seconds: f64) {
        for step in 1..=STEPS {
            let done = units * step as f64 / STEPS as f64;
            let piece = seconds / STEPS as f64;
            self.estimate.advance((stage, level), done, 0.0, self.stretch * piece, piece);
            self.past += piece;
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

/// Follows a bake on a machine that is so many times as slow, and that others take this much of.
fn follow(course: &Course, slow: f64, stretch: f64) -> Run {
    let settings = BakeSettings::new(course.preset).normalised();
    let sum = |seconds: &[f64]| seconds.iter().sum::<f64>();
    let total = course.prepare
        + sum(course.placing)
        + sum(&course.shaping)
        + sum(course.links)
        + course.bouncing
        + course.rest;
    let estimate = Estimate::new(&settings, course.triangles, false, 1);
    let mut run = Run { estimate, stretch, past: 0.0, total: slow * total, found: Vec::new() };
    run.part(Stage::Prepare, None, course.triangles as f64, slow * course.prepare);
    for (level, seconds) in course.placing.iter().enumerate() {
        run.part(Stage::Points, Some(level), course.points[level] as f64, slow * seconds);
        run.estimate.found_points(&settings, &course.points[..=level]);
    }
    let all = course.points.iter().sum::<usize>() as f64;
    run.part(Stage::Walls, None, 2.0 * all, slow * course.shaping[0]);
    run.part(Stage::Basis, None, all, slow * course.shaping[1]);
    run.part(Stage::Colours, None, all, slow * course.shaping[2]);
    let later = settings.operator.later_levels;
    for (level, seconds) in course.links.iter().enumerate() {
        let rays = course.rays[level] as f64;
        run.estimate.expect_rays(level, rays);
        run.part(Stage::Links, Some(level), rays, slow * seconds);
        if level < later {
            run.estimate.expect_bounces(course.bounces[0], course.bounces[1]);
        }
        if level + 1 == later {
            run.part(Stage::Bounces, None, course.bounces[0], slow * course.bouncing);
        }
    }
    assert!(run.estimate.left().processor_seconds < 0.05 * run.total, "{}: nothing is left", course.name);
    run
}

#[test]
fn from_a_third_of_the_way_on_it_is_right_within_a_quarter() {
    for course in COURSES {
        for (slow, stretch) in [(1.0, 1.0), (3.0, 1.0), (0.4, 1.0), (1.0, 2.5)] {
            let run = follow(course, slow, stretch);
            for (share, processors, clock) in run.found.into_iter().filter(|e| e.0 > 1.0 / 3.0 && e.0 < 0.97)
            {
                let is_right = |ratio: f64| (0.75..1.25).contains(&ratio);
                assert!(
                    is_right(processors) && is_right(clock),
                    "{} {:?}, {slow} times as slow, stretched by {stretch}: at {share:.2} of the way {processors:.2} \
                     of the truth, {clock:.2} by the clock",
                    course.name,
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
    assert_eq!(estimate.known, [None; 4]);
}

#[test]
fn a_busy_machine_takes_longer_by_the_clock_alone() {
    let course = &COURSES[0];
    let (quiet, busy) = (follow(course, 1.0, 1.0), follow(course, 1.0, 3.0));
    for (quiet, busy) in quiet.found.iter().zip(&busy.found) {
        assert!((quiet.1 - busy.1).abs() < 1e-9, "the processors' time is the same");
    }
}
