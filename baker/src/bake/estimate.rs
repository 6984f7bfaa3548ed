//! How long what is left of a bake takes: its work is known from the settings long before it is done, and how fast it
//! goes is measured.

use super::{BakeSettings, Stage};
use crate::points::expected_counts;

/// Seconds of one thread for a unit of work, measured on a furnished kitchen; only their ratios last, as they are
/// scaled by what is measured.
mod cost {
    pub const TRIANGLE: f64 = 2.0e-6;
    pub const SKETCH: f64 = 4.0;
    pub const POINT: f64 = 60e-6;
    pub const WALL: f64 = 10e-6;
    pub const RELATION: f64 = 4e-6;
    pub const COLOUR: f64 = 20e-6;
    pub const RAY: f64 = 2.6e-6;
    /// On the finest level, whose receivers have no children.
    pub const FINE_RAY: f64 = 1.7e-6;
    /// For an entry of the coarse rows and a column.
    pub const BOUNCE: f64 = 2.4e-9;
    pub const ASSEMBLED: f64 = 1e-6;
}

/// Entries that a coarse row has, at most.
const ROW: f64 = 900.0;
/// A measured pace counts fully against the one expected when it rests on some such many seconds.
const TRUST: f64 = 0.5;
/// How much of what was measured before counts when another part of the work begins.
const MEMORY: f64 = 0.15;

/// What was measured counts half as much after so many seconds, and after this share of the time since the start.
const HALF_LIFE: (f64, f64) = (5.0, 0.25);

/// A part of the bake.
#[derive(Clone, Debug)]
struct Part {
    stage: Stage,
    level: Option<usize>,
    units: f64,
    /// Units done, and of these taken from an earlier run.
    done: f64,
    skipped: f64,
    /// Seconds that all its units take at pace 1.
    nominal: f64,
    /// Seconds since it began.
    spent: f64,
    is_over: bool,
}

/// Work of one kind: how many seconds it took, and how many at pace 1.
#[derive(Clone, Copy, Debug, Default)]
struct Pace {
    actual: f64,
    nominal: f64,
    /// What was measured of the parts before.
    known: Option<f64>,
}

impl Pace {
    fn over(self, expected: f64) -> f64 {
        let expected = self.known.unwrap_or(expected);
        (self.actual + TRUST * expected) / (self.nominal + TRUST)
    }
}

/// Kinds of work whose paces go together.
const KINDS: usize = 3;

fn kind(stage: Stage) -> usize {
    match stage {
        Stage::Links => 1,
        Stage::Bounces => 2,
        _ => 0,
    }
}

/// The parts of a bake, their work, and how fast it goes.
pub(super) struct Estimate {
    parts: Vec<Part>,
    paces: [Pace; KINDS],
    threads: f64,
    levels: usize,
    elapsed: f64,
}

impl Estimate {
    /// What a bake with these settings will be.
    pub(super) fn new(settings: &BakeSettings, triangles: usize, sketches: bool, threads: usize) -> Self {
        let mut estimate = Self {
            parts: Vec::new(),
            paces: Default::default(),
            threads: threads.max(1) as f64,
            levels: settings.place.levels,
            elapsed: 0.0,
        };
        let mut add = |stage, level| {
            let part = Part {
                stage,
                level,
                units: 0.0,
                done: 0.0,
                skipped: 0.0,
                nominal: 0.0,
                spent: 0.0,
                is_over: false,
            };
            estimate.parts.push(part);
        };
        let levels = settings.place.levels;
        add(Stage::Prepare, None);
        if sketches {
            add(Stage::Sketch, None);
        }
        (0..levels).for_each(|level| add(Stage::Points, Some(level)));
        [Stage::Walls, Stage::Basis, Stage::Colours].into_iter().for_each(|stage| add(stage, None));
        for level in 0..levels {
            add(Stage::Links, Some(level));
            if level + 1 == settings.operator.later_levels && settings.operator.bounces != Some(1) {
                add(Stage::Bounces, None);
            }
        }
        add(Stage::Assemble, None);
        estimate.set(Stage::Prepare, None, triangles as f64, cost::TRIANGLE * triangles as f64);
        estimate.set(Stage::Sketch, None, 1.0, cost::SKETCH);
        estimate.set(Stage::Assemble, None, triangles as f64, cost::ASSEMBLED * triangles as f64);
        estimate.expect_points(settings, &expected_counts(&settings.place));
        estimate
    }

    /// What follows from the levels' numbers of points.
    pub(super) fn expect_points(&mut self, settings: &BakeSettings, counts: &[f64]) {
        for (level, count) in counts.iter().enumerate() {
            let rays = count * settings.operator.rays_on(level) as f64;
            self.set(Stage::Points, Some(level), *count, cost::POINT * count);
            self.expect_rays(level, rays);
        }
        let all: f64 = counts.iter().sum();
        self.set(Stage::Walls, None, 2.0 * all, 2.0 * cost::WALL * all);
        self.set(Stage::Basis, None, all, cost::RELATION * all);
        self.set(Stage::Colours, None, all, cost::COLOUR * all);
        let coarse: f64 = counts.iter().take(settings.operator.later_levels).sum();
        self.expect_bounces(coarse, coarse * coarse.min(ROW));
    }

    /// How many rays a level will cast.
    pub(super) fn expect_rays(&mut self, level: usize, rays: f64) {
        let cost = if level + 1 == self.levels { cost::FINE_RAY } else { cost::RAY };
        self.set(Stage::Links, Some(level), rays, cost * rays);
    }

    /// How many columns later bounces have, and how many entries the coarse rows.
    pub(super) fn expect_bounces(&mut self, columns: f64, entries: f64) {
        self.set(Stage::Bounces, None, columns, cost::BOUNCE * columns * entries);
    }

    fn set(&mut self, stage: Stage, level: Option<usize>, units: f64, seconds: f64) {
        let threads = self.threads;
        if let Some(part) = self.part(stage, level).filter(|part| part.done == 0.0) {
            (part.units, part.nominal) = (units, seconds / threads);
        }
    }

    fn part(&mut self, stage: Stage, level: Option<usize>) -> Option<&mut Part> {
        self.parts.iter_mut().find(|part| part.stage == stage && part.level == level)
    }

    /// A part begins: what was measured of its kind counts less from now on.
    pub(super) fn begin(&mut self, stage: Stage) {
        let pace = &mut self.paces[kind(stage)];
        if pace.nominal > TRUST {
            pace.known = Some(pace.actual / pace.nominal);
            (pace.actual, pace.nominal) = (MEMORY * pace.actual, MEMORY * pace.nominal);
        }
    }

    /// Of the part under way so many units are done, `skipped` of them taken from an earlier run, and `seconds` went by
    /// since this was told last.
    pub(super) fn advance(
        &mut self,
        stage: Stage,
        level: Option<usize>,
        done: f64,
        skipped: f64,
        seconds: f64,
    ) {
        let Some(part) = self.part(stage, level) else { return };
        part.units = part.units.max(done);
        let worked = (done - skipped) - (part.done - part.skipped);
        let nominal = part.nominal * worked / part.units.max(1.0);
        // What went by before the first work was told of belongs to it; parts that tell of none measure nothing.
        let seconds_told = if part.done > 0.0 { seconds } else { seconds + part.spent };
        part.spent += seconds;
        (part.done, part.skipped) = (done, skipped);
        self.elapsed += seconds;
        if done == skipped {
            return;
        }
        let kept = 0.5f64.powf(seconds / (HALF_LIFE.0 + HALF_LIFE.1 * self.elapsed));
        let pace = &mut self.paces[kind(stage)];
        pace.actual = kept * pace.actual + seconds_told;
        pace.nominal = kept * pace.nominal + nominal.max(0.0);
    }

    /// A part is over, whatever its units.
    pub(super) fn end(&mut self, stage: Stage, level: Option<usize>) {
        if let Some(part) = self.part(stage, level) {
            part.is_over = true;
        }
    }

    /// Units of a part, as far as they are known.
    pub(super) fn units(&mut self, stage: Stage, level: Option<usize>) -> f64 {
        self.part(stage, level).map_or(0.0, |part| part.units)
    }

    /// Seconds that all that is left takes.
    pub(super) fn seconds_left(&self) -> f64 {
        let mut expected = 1.0;
        let paces = self.paces.map(|pace| {
            expected = pace.over(expected);
            expected
        });
        let left = |part: &Part| match part.done > 0.0 {
            true => {
                part.nominal
                    * (1.0 - part.done / part.units.max(1.0)).clamp(0.0, 1.0)
                    * paces[kind(part.stage)]
            }
            false => (part.nominal * paces[kind(part.stage)] - part.spent).max(0.0),
        };
        let open = self.parts.iter().filter(|part| !part.is_over);
        open.map(left).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::Preset;

    /// A machine on which each kind of work goes at a pace of its own: the estimate at each share of the way, over the
    /// truth.
    fn errors(paces: [f64; KINDS]) -> Vec<(f64, f64)> {
        let settings = BakeSettings::new(Preset::Standard).normalised();
        let mut estimate = Estimate::new(&settings, 100_000, false, 2);
        let parts = estimate.parts.clone();
        let seconds = |part: &Part| part.nominal * paces[kind(part.stage)];
        let total: f64 = parts.iter().map(seconds).sum();
        let (mut past, mut found) = (0.0, Vec::new());
        for part in &parts {
            let (units, step) = (part.units, seconds(part) / 100.0);
            estimate.begin(part.stage);
            for k in 1..=100 {
                estimate.advance(part.stage, part.level, units * k as f64 / 100.0, 0.0, step);
                past += step;
                found.push((past / total, estimate.seconds_left() / (total - past).max(1e-9 * total)));
            }
            estimate.end(part.stage, part.level);
        }
        assert!(estimate.seconds_left().abs() < 1e-6 * total);
        found
    }

    #[test]
    fn a_third_of_the_way_the_pace_is_known() {
        for paces in [[1.0; KINDS], [3.0; KINDS], [0.2, 1.5, 1.0], [2.0, 0.5, 0.5]] {
            for (share, ratio) in errors(paces).into_iter().filter(|e| e.0 > 1.0 / 3.0 && e.0 < 0.98) {
                assert!(
                    (0.75..1.25).contains(&ratio),
                    "{paces:?}: at {share} of the way {ratio} of the truth"
                );
            }
        }
    }

    #[test]
    fn what_was_done_before_takes_no_time_and_measures_nothing() {
        let settings = BakeSettings::new(Preset::Standard).normalised();
        let mut estimate = Estimate::new(&settings, 100_000, false, 2);
        let before = estimate.seconds_left();
        let units = estimate.units(Stage::Links, Some(5));
        let nominal = estimate.part(Stage::Links, Some(5)).unwrap().nominal;
        estimate.begin(Stage::Links);
        estimate.advance(Stage::Links, Some(5), 0.5 * units, 0.5 * units, 0.01);
        assert!((estimate.seconds_left() - (before - 0.5 * nominal)).abs() < 1e-6 * before);
    }
}
