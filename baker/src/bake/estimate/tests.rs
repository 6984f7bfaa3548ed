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
    /// Walls, relations, colours, tiles.
    shaping: [f64; 4],
    tiles: usize,
    links: &'static [f64],
    bouncing: f64,
    rest: f64,
}

/// Measured with one thread on two cores, while another bake kept the other one busy.
const COURSES: &[Course] = &[
    Course {
        name: "apartment",
        preset: Preset::Draft,
        triangles: 6516,
        points: &[208, 689, 2351, 7880, 28611],
        rays: &[425984, 1411072, 2407424, 8069120, 14644736],
        bounces: [2556.0, 288861.0],
        prepare: 0.18,
        placing: &[0.02, 0.04, 0.10, 0.23, 0.51],
        shaping: [0.19, 0.04, 0.12, 0.26],
        tiles: 227897,
        links: &[0.09, 0.30, 0.55, 1.06, 1.98],
        bouncing: 0.55,
        rest: 0.07,
    },
    Course {
        name: "Cornell box",
        preset: Preset::Draft,
        triangles: 30,
        points: &[158, 532, 2034, 7792, 30748],
        rays: &[323584, 1089536, 2082816, 7979008, 15726592],
        bounces: [2038.0, 650031.0],
        prepare: 0.11,
        placing: &[0.01, 0.01, 0.04, 0.13, 0.39],
        shaping: [0.18, 0.04, 0.12, 0.14],
        tiles: 453916,
        links: &[0.05, 0.15, 0.31, 0.87, 1.63],
        bouncing: 0.87,
        rest: 0.05,
    },
    Course {
        name: "country kitchen",
        preset: Preset::Draft,
        triangles: 1021596,
        points: &[165, 541, 1726, 6233, 24312],
        rays: &[337920, 1107968, 1767424, 6381568, 12445696],
        bounces: [1935.0, 432746.0],
        prepare: 1.78,
        placing: &[0.02, 0.03, 0.07, 0.21, 0.46],
        shaping: [0.20, 0.03, 0.11, 0.85],
        tiles: 668820,
        links: &[0.10, 0.33, 0.60, 1.46, 2.88],
        bouncing: 0.69,
        rest: 0.43,
    },
    Course {
        name: "kitchen",
        preset: Preset::Draft,
        triangles: 56914,
        points: &[138, 449, 1498, 4914, 18883],
        rays: &[282624, 919552, 1533952, 5029888, 9626624],
        bounces: [1692.0, 250562.0],
        prepare: 0.25,
        placing: &[0.02, 0.04, 0.09, 0.20, 0.41],
        shaping: [0.16, 0.03, 0.09, 0.51],
        tiles: 490928,
        links: &[0.08, 0.26, 0.50, 1.09, 2.25],
        bouncing: 0.25,
        rest: 0.08,
    },
    Course {
        name: "library",
        preset: Preset::Draft,
        triangles: 4488,
        points: &[164, 506, 1852, 6762, 23695],
        rays: &[335872, 1036288, 1896448, 6924288, 12131328],
        bounces: [2004.0, 415558.0],
        prepare: 0.14,
        placing: &[0.01, 0.03, 0.06, 0.20, 0.38],
        shaping: [0.19, 0.04, 0.11, 0.18],
        tiles: 364564,
        links: &[0.07, 0.24, 0.51, 1.04, 1.91],
        bouncing: 0.56,
        rest: 0.06,
    },
    Course {
        name: "Sponza (Crytek)",
        preset: Preset::Draft,
        triangles: 262266,
        points: &[134, 508, 1624, 5446, 18751],
        rays: &[274432, 1040384, 1662976, 5576704, 9600512],
        bounces: [1788.0, 167405.0],
        prepare: 0.63,
        placing: &[0.02, 0.07, 0.12, 0.30, 0.45],
        shaping: [0.24, 0.04, 0.13, 0.44],
        tiles: 303511,
        links: &[0.10, 0.41, 0.79, 1.64, 2.85],
        bouncing: 0.12,
        rest: 0.18,
    },
    Course {
        name: "Sponza (Dabrovic)",
        preset: Preset::Draft,
        triangles: 66445,
        points: &[192, 644, 1783, 4705, 16176],
        rays: &[393216, 1318912, 1825792, 4817920, 8282112],
        bounces: [2007.0, 255554.0],
        prepare: 0.42,
        placing: &[0.02, 0.07, 0.12, 0.18, 0.30],
        shaping: [0.18, 0.03, 0.13, 0.56],
        tiles: 463908,
        links: &[0.11, 0.41, 0.73, 1.12, 2.06],
        bouncing: 0.45,
        rest: 0.16,
    },
    Course {
        name: "living room",
        preset: Preset::Standard,
        triangles: 1551,
        points: &[248, 835, 3079, 11248, 43896, 171743],
        rays: &[1015808, 3420160, 6305792, 11517952, 22460928, 87804928],
        bounces: [3079.0, 918576.0],
        prepare: 0.13,
        placing: &[0.01, 0.03, 0.07, 0.22, 0.85, 2.44],
        shaping: [0.75, 0.27, 0.57, 1.73],
        tiles: 1695778,
        links: &[0.14, 0.46, 0.94, 1.50, 3.21, 9.84],
        bouncing: 1.18,
        rest: 0.20,
    },
    Course {
        name: "Sponza (Dabrovic)",
        preset: Preset::Standard,
        triangles: 66445,
        points: &[384, 944, 2702, 7893, 27158, 99639],
        rays: &[1572864, 3866624, 5533696, 8082432, 13900800, 50980352],
        bounces: [3065.0, 454119.0],
        prepare: 0.45,
        placing: &[0.04, 0.08, 0.14, 0.30, 0.77, 1.54],
        shaping: [0.83, 0.17, 0.48, 2.00],
        tiles: 1760314,
        links: &[0.38, 1.04, 1.77, 1.96, 3.47, 10.90],
        bouncing: 1.27,
        rest: 0.29,
    },
    Course {
        name: "country kitchen",
        preset: Preset::Standard,
        triangles: 1021596,
        points: &[238, 727, 2669, 8933, 32641, 121603],
        rays: &[974848, 2977792, 5466112, 9147392, 16711168, 62247424],
        bounces: [2854.0, 694604.0],
        prepare: 1.71,
        placing: &[0.02, 0.05, 0.13, 0.25, 0.80, 1.81],
        shaping: [0.76, 0.18, 0.46, 2.29],
        tiles: 2058056,
        links: &[0.25, 0.81, 1.68, 2.09, 4.12, 12.59],
        bouncing: 1.59,
        rest: 0.54,
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
    run.estimate.expect_units((Stage::Tiles, None), course.tiles as f64);
    run.part(Stage::Tiles, None, course.tiles as f64, slow * course.shaping[3]);
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
    let left = run.estimate.left().processor_seconds;
    assert!((left - slow * course.rest).abs() < 0.05 * run.total, "{}: only the file is left", course.name);
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
    assert_eq!(estimate.known, [None; 5]);
}

#[test]
fn a_busy_machine_takes_longer_by_the_clock_alone() {
    let course = &COURSES[0];
    let (quiet, busy) = (follow(course, 1.0, 1.0), follow(course, 1.0, 3.0));
    for (quiet, busy) in quiet.found.iter().zip(&busy.found) {
        assert!((quiet.1 - busy.1).abs() < 1e-9, "the processors' time is the same");
    }
}
