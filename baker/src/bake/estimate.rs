//! How long what is left of a bake takes. How much work there is, the settings, the points and the links so far say long
//! before it is done; what a unit of it costs on this scene and this machine is measured, in processor time, which does
//! not count what else the machine does. What that means in seconds of the clock is measured beside it.

use super::{BakeSettings, Stage};
use crate::geometry::mesh::MOST_PRIMITIVES;
use crate::sampling::expected_counts;

/// Seconds of one processor for a unit of work: what furnished rooms and halls take, as long as nothing is measured.
mod cost {
    /// Preparing: in all, and of a triangle.
    pub const PREPARED: [f64; 2] = [0.1, 1.6e-6];
    pub const SKETCH: f64 = 1.5;
    /// Of a point on the finest level, and how much more of one on the level above each: it must not be tight there.
    pub const POINT: [f64; 2] = [23.5e-6, 1.45];
    pub const WALL: f64 = 2.65e-6;
    pub const RELATION: f64 = 1.2e-6;
    pub const COLOUR: f64 = 3.3e-6;
    pub const TILE: f64 = 0.9e-6;
    /// On the coarsest level.
    pub const COARSE_RAY: f64 = 0.166e-6;
    /// For a ray of the coarse levels, whose hits are put together by coarse point.
    pub const AMONG: f64 = 0.018e-6;
    /// For an entry of the coarse rows and a column.
    pub const BOUNCE: f64 = 0.6e-9;
    /// Putting the file together, and packing and writing it, which follows: in all, of a triangle, and of a point.
    pub const ASSEMBLED: [f64; 3] = [0.04, 0.35e-6, 0.9e-6];
}

/// What a ray of the first finer level, which later bounces do not travel from, costs over one of the coarsest, whose few points
/// have few senders each: with so many functions, and how much more with e times as many. Measured: 0.96 to 1.12 at `draft`,
/// 1.18 to 1.34 at `standard`.
const FINE: (f64, f64, f64) = (1.03, 30e3, 0.106);
/// What a ray of a level costs over one of the level before where a point has half as many, as what is done for each of its
/// links then is, and where it has as many: among the coarse levels, and among the finer ones, whose rays go more alike as
/// points are half as far apart. Measured: 1.10 to 1.25, 0.95 to 1.02; 0.94 to 1.08, 0.77 to 0.83.
const NEXT: [[f64; 2]; 2] = [[1.15, 1.02], [1.04, 0.85]];
/// Tiles of a point, and of a triangle that rays are cast at: 8 to 19 of a point in all.
const TILES: (f64, f64) = (11.0, 0.4);
/// How many coarse points one receives from: 100 in an apartment, 360 in an empty room; and the share of them at most.
const ROW: (f64, f64) = (170.0, 0.25);
/// What is expected of a part counts like this share of it, and so many seconds more, against what is measured.
const TRUST: (f64, f64) = (0.055, 0.025);
/// How much a part counts in what is expected of the next one of its kind, against those before.
const MEMORY: f64 = 0.6;
/// Seconds at full speed that a stretch of time counts against.
const STRETCH: f64 = 0.2;
/// What was measured counts half as much after so many seconds, and this share of the time so far: machines get busier
/// and quieter, and who shares a cache or a core with others pays in processor time, too.
const HALF_LIFE: (f64, f64) = (2.0, 0.2);

/// Work whose costs go together.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// And putting the file together.
    SettingUp,
    /// Rays and little else.
    Walls,
    CoarseLinks,
    FineLinks,
    /// No rays: what they found.
    Bounces,
}

/// A part of the bake.
#[derive(Clone, Debug)]
struct Part {
    stage: Stage,
    level: Option<usize>,
    kind: Kind,
    units: f64,
    /// Units done, and of these taken from an earlier run.
    done: f64,
    skipped: f64,
    /// Processor seconds that all its units take at pace 1.
    nominal: f64,
    /// Processor seconds since it began.
    spent: f64,
    /// Of late: processor seconds, and those that the units done then take at pace 1.
    late: [f64; 2],
    is_over: bool,
}

impl Part {
    /// Processor seconds that the units done in this run take at pace 1.
    fn worked(&self) -> f64 {
        self.nominal * ((self.done - self.skipped) / self.units.max(1.0)).clamp(0.0, 1.0)
    }

    /// The pace measured so far, on top of the one expected.
    fn pace(&self, expected: f64) -> f64 {
        if self.done <= self.skipped {
            return expected;
        }
        let trust = TRUST.0 * self.nominal + TRUST.1;
        (self.late[0] + trust * expected) / (self.late[1] + trust)
    }

    /// Processor seconds left.
    fn left(&self, expected: f64) -> f64 {
        match self.done > 0.0 {
            true => {
                let share = (1.0 - self.done / self.units.max(1.0)).clamp(0.0, 1.0);
                self.nominal * share * self.pace(expected)
            }
            false => (self.nominal * expected - self.spent).max(0.0),
        }
    }

    /// Seconds of the clock over processor seconds, on this many threads that nobody disturbs.
    fn ideal(&self, threads: f64) -> f64 {
        let shared = match self.stage {
            Stage::Prepare => 0.6,
            Stage::Basis | Stage::Assemble => 0.0,
            _ => 1.0,
        };
        1.0 - shared + shared / threads
    }
}

/// What is left of a bake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Left {
    /// Of the clock.
    pub seconds: f64,
    /// Of the processors, all threads together.
    pub processor_seconds: f64,
}

/// What a ray of each level costs over one of the coarsest level, or, if later bounces do not travel from it, over one of the
/// first such level.
fn by_level(settings: &BakeSettings) -> Vec<f64> {
    let rays = |level: usize| settings.operator.rays_on(level) as f64;
    let later_levels = settings.operator.later_levels;
    let mut share = 1.0;
    let over = |level: usize| {
        share *= match level {
            0 => 1.0,
            level if level == later_levels => 1.0 / share,
            level => {
                let [halved, as_many] = NEXT[(level > later_levels) as usize];
                halved * (as_many / halved).powf((rays(level) / rays(level - 1)).log2() + 1.0)
            }
        };
        share
    };
    (0..settings.place.levels).map(over).collect()
}

/// The parts of a bake, their work, and how fast it goes.
pub(super) struct Estimate {
    parts: Vec<Part>,
    /// Costs over those expected of what was done of setting up: seconds, and seconds at pace 1.
    set_up: [f64; 2],
    /// Paces measured, by kind.
    known: [Option<f64>; 5],
    /// Seconds of the clock, and those that an idle machine would have taken.
    clock: [f64; 2],
    /// Since the bake began: of the clock, of the processors.
    elapsed: [f64; 2],
    threads: f64,
    /// Triangles that rays are cast at.
    ray_triangles: f64,
    /// What a ray of each level costs: see [`by_level`].
    by_level: Vec<f64>,
}

impl Estimate {
    /// What a bake with these settings will be.
    pub(super) fn new(settings: &BakeSettings, triangles: usize, sketches: bool, threads: usize) -> Self {
        let mut estimate = Self {
            parts: Vec::new(),
            set_up: [0.0; 2],
            known: [None; 5],
            clock: [0.0; 2],
            elapsed: [0.0; 2],
            threads: threads.max(1) as f64,
            ray_triangles: triangles as f64,
            by_level: by_level(settings),
        };
        let later_levels = settings.operator.later_levels;
        let mut add = |stage, level: Option<usize>| {
            let kind = match (stage, level) {
                (Stage::Links, Some(level)) if level < later_levels => Kind::CoarseLinks,
                (Stage::Links, _) => Kind::FineLinks,
                (Stage::Among | Stage::Bounces, _) => Kind::Bounces,
                (Stage::Walls, _) => Kind::Walls,
                _ => Kind::SettingUp,
            };
            let (units, done, skipped, nominal, spent) = (0.0, 0.0, 0.0, 0.0, 0.0);
            let (late, is_over) = ([0.0; 2], false);
            estimate.parts.push(Part {
                stage,
                level,
                kind,
                units,
                done,
                skipped,
                nominal,
                spent,
                late,
                is_over,
            });
        };
        let levels = settings.place.levels;
        add(Stage::Prepare, None);
        if sketches {
            add(Stage::Sketch, None);
        }
        (0..levels).for_each(|level| add(Stage::Points, Some(level)));
        [Stage::Walls, Stage::Basis, Stage::Colours, Stage::Tiles]
            .into_iter()
            .for_each(|stage| add(stage, None));
        for level in 0..levels {
            add(Stage::Links, Some(level));
            if level + 1 == later_levels && settings.operator.bounces != Some(1) {
                add(Stage::Among, None);
                add(Stage::Bounces, None);
            }
        }
        add(Stage::Assemble, None);
        let prepared = cost::PREPARED[0] + cost::PREPARED[1] * triangles as f64;
        estimate.set(Stage::Prepare, None, triangles as f64, prepared);
        estimate.set(Stage::Sketch, None, 1.0, cost::SKETCH);
        estimate.set(
            Stage::Assemble,
            None,
            triangles as f64,
            cost::ASSEMBLED[0] + cost::ASSEMBLED[1] * triangles as f64,
        );
        estimate.expect_points(settings, &expected_counts(&settings.place));
        estimate
    }

    /// So many triangles are left for rays, those of each copy counted.
    pub(super) fn found_surfaces(&mut self, settings: &BakeSettings, ray_triangles: u64) {
        self.ray_triangles = ray_triangles.min(MOST_PRIMITIVES) as f64;
        self.expect_points(settings, &expected_counts(&settings.place));
    }

    /// There will be the levels that these settings have.
    pub(super) fn found_levels(&mut self, settings: &BakeSettings) {
        let triangles = self.units(Stage::Assemble, None) as usize;
        let fresh = Self::new(settings, triangles, false, self.threads as usize);
        self.parts.retain(|part| matches!(part.stage, Stage::Prepare | Stage::Sketch));
        self.parts.extend(fresh.parts.into_iter().filter(|part| part.stage != Stage::Prepare));
        self.by_level = fresh.by_level;
        self.expect_points(settings, &expected_counts(&settings.place));
    }

    /// So many points are on the coarsest levels; the others will grow alike.
    pub(super) fn found_points(&mut self, settings: &BakeSettings, found: &[usize]) {
        let mut counts = expected_counts(&settings.place);
        let Some(last) = found.len().checked_sub(1).filter(|last| *last < counts.len()) else { return };
        let scale = found[last] as f64 / counts[last];
        counts.iter_mut().for_each(|count| *count *= scale);
        counts.iter_mut().zip(found).for_each(|(count, found)| *count = *found as f64);
        self.expect_points(settings, &counts);
    }

    /// What follows from the levels' numbers of points.
    fn expect_points(&mut self, settings: &BakeSettings, counts: &[f64]) {
        let all: f64 = counts.iter().sum();
        self.set(Stage::Walls, None, 2.0 * all, 2.0 * cost::WALL * all);
        self.set(Stage::Basis, None, all, cost::RELATION * all);
        for (level, count) in counts.iter().enumerate() {
            let above = (counts.len() - 1 - level) as i32;
            self.set(Stage::Points, Some(level), *count, cost::POINT[0] * cost::POINT[1].powi(above) * count);
            self.expect_rays(level, count * settings.operator.rays_on(level) as f64);
        }
        let triangles = self.units(Stage::Assemble, None);
        self.set(Stage::Colours, None, all, cost::COLOUR * all);
        let tiles = TILES.0 * all + TILES.1 * self.ray_triangles;
        self.set(Stage::Tiles, None, tiles, cost::TILE * tiles);
        let [file, of_triangle, of_point] = cost::ASSEMBLED;
        let assembled = file + of_triangle * triangles + of_point * all;
        self.set(Stage::Assemble, None, triangles, assembled);
        let coarse: f64 = counts.iter().take(settings.operator.later_levels).sum();
        let rays = |(level, count): (usize, &f64)| count * settings.operator.rays_on(level) as f64;
        let coarse_rays: f64 = counts.iter().enumerate().take(settings.operator.later_levels).map(rays).sum();
        self.set(Stage::Among, None, coarse, cost::AMONG * coarse_rays);
        self.expect_bounces(coarse, coarse * ROW.0.min(ROW.1 * coarse));
    }

    /// So many units a part will have, each of them as much work as was thought.
    pub(super) fn expect_units(&mut self, (stage, level): (Stage, Option<usize>), units: f64) {
        if let Some(part) = self.part(stage, level) {
            let nominal = part.nominal * units / part.units.max(1.0);
            self.set(stage, level, units, nominal);
        }
    }

    /// How many rays a level will cast.
    pub(super) fn expect_rays(&mut self, level: usize, rays: f64) {
        let is_coarse = |part: &Part| part.kind == Kind::CoarseLinks && part.level == Some(level);
        let of_kind = match self.parts.iter().any(is_coarse) {
            true => 1.0,
            false => {
                let functions = self.units(Stage::Basis, None).max(1.0);
                (FINE.0 + FINE.2 * (functions / FINE.1).ln()).clamp(0.5, 2.0)
            }
        };
        let share = of_kind * self.by_level.get(level).copied().unwrap_or(1.0);
        self.set(Stage::Links, Some(level), rays, share * cost::COARSE_RAY * rays);
    }

    /// How many columns later bounces have, and how many entries the coarse rows.
    pub(super) fn expect_bounces(&mut self, columns: f64, entries: f64) {
        self.set(Stage::Bounces, None, columns, cost::BOUNCE * columns * entries);
    }

    fn set(&mut self, stage: Stage, level: Option<usize>, units: f64, nominal: f64) {
        if let Some(part) = self.part(stage, level).filter(|part| part.done == 0.0) {
            (part.units, part.nominal) = (units, nominal);
        }
    }

    fn part(&mut self, stage: Stage, level: Option<usize>) -> Option<&mut Part> {
        self.parts.iter_mut().find(|part| part.stage == stage && part.level == level)
    }

    /// Of the part under way so many units are done, `skipped` of them taken from an earlier run, and so many seconds
    /// of the clock and of the processors went by since this was told last.
    pub(super) fn advance(
        &mut self,
        (stage, level): (Stage, Option<usize>),
        done: f64,
        skipped: f64,
        seconds: f64,
        processor_seconds: f64,
    ) {
        let (threads, processors) = (self.threads, self.elapsed[1]);
        let Some(part) = self.part(stage, level) else { return };
        part.units = part.units.max(done);
        let before = part.worked();
        (part.done, part.skipped) = (done, skipped);
        part.spent += processor_seconds;
        let worked = part.worked() - before;
        // What went by before the first work was told of belongs to it.
        let told = if before > 0.0 { processor_seconds } else { part.spent };
        if worked > 0.0 || before > 0.0 {
            let kept = 0.5f64.powf(processor_seconds / (HALF_LIFE.0 + HALF_LIFE.1 * processors));
            part.late = [kept * part.late[0] + told, kept * part.late[1] + worked.max(0.0)];
        }
        let ideal = processor_seconds * part.ideal(threads);
        self.elapsed = [self.elapsed[0] + seconds, self.elapsed[1] + processor_seconds];
        let kept = 0.5f64.powf(seconds / (HALF_LIFE.0 + HALF_LIFE.1 * self.elapsed[0]));
        self.clock = [kept * self.clock[0] + seconds, kept * self.clock[1] + ideal];
    }

    /// A part is over, whatever its units.
    pub(super) fn end(&mut self, stage: Stage, level: Option<usize>) {
        let Some(part) = self.part(stage, level) else { return };
        part.is_over = true;
        let (kind, spent, worked) = (part.kind, part.spent, part.worked());
        if kind == Kind::SettingUp {
            if worked > 0.0 {
                self.set_up = [self.set_up[0] + spent, self.set_up[1] + worked];
            }
        } else if worked > 0.02 {
            let known = &mut self.known[kind as usize];
            let pace = spent / worked;
            *known = Some(known.map_or(pace, |before| MEMORY * pace + (1.0 - MEMORY) * before));
        }
    }

    /// Units of a part, as far as they are known.
    pub(super) fn units(&mut self, stage: Stage, level: Option<usize>) -> f64 {
        self.part(stage, level).map_or(0.0, |part| part.units)
    }

    /// Paces of each kind of work: the one expected before the part under way, and with what is measured of that. Where
    /// nothing is, other kinds say it: links are as costly as looking for walls was. (Before that, as setting up, but for what is
    /// under way of it: the first points of a level come fast, the last ones slowly.)
    fn paces(&self) -> [[f64; 2]; 5] {
        let with = |kind: Kind, expected: f64| {
            let is_under_way = |part: &&Part| part.kind == kind && !part.is_over && part.done > part.skipped;
            let part = self.parts.iter().find(is_under_way);
            [expected, part.map_or(expected, |part| part.pace(expected))]
        };
        let of = |kind: Kind, other: f64| with(kind, self.known[kind as usize].unwrap_or(other));
        let trust = TRUST.0 + TRUST.1;
        let set_up = with(Kind::SettingUp, (self.set_up[0] + trust) / (self.set_up[1] + trust));
        let walls = of(Kind::Walls, set_up[0]);
        let coarse = of(Kind::CoarseLinks, walls[1]);
        let fine = of(Kind::FineLinks, coarse[1]);
        let bounces = of(Kind::Bounces, coarse[1]);
        [set_up, walls, coarse, fine, bounces]
    }

    /// What all that is left takes.
    pub(super) fn left(&self) -> Left {
        let paces = self.paces();
        let stretch = (self.clock[0] + STRETCH) / (self.clock[1] + STRETCH);
        let mut left = Left { seconds: 0.0, processor_seconds: 0.0 };
        for part in self.parts.iter().filter(|part| !part.is_over) {
            // A part under way adds what is measured of it by itself.
            let [before, now] = paces[part.kind as usize];
            let seconds = part.left(if part.done > part.skipped { before } else { now });
            left.processor_seconds += seconds;
            left.seconds += seconds * part.ideal(self.threads) * stretch;
        }
        left
    }
}

#[cfg(test)]
mod tests;
