//! Estimate of the time left in a bake. The amount of work follows from the settings, the points and the links so far,
//! long before the end. The cost of a unit of work on the scene and the machine is measured in processor time,
//! unaffected by other load on the machine. The ratio of clock time to processor time is measured separately.

use super::{BakeSettings, Stage};
use crate::geometry::mesh::MOST_PRIMITIVES;
use crate::sampling::expected_counts;

/// Default costs in processor seconds per unit of work, valid until costs are measured. From furnished rooms and halls.
mod cost {
    /// Preparing: fixed cost, and cost per triangle.
    pub const PREPARED: [f64; 2] = [0.1, 1.6e-6];
    pub const SKETCH: f64 = 1.5;
    /// Placing: cost per point of the finest level, and the factor per coarser level (coarser levels also test for
    /// tight places).
    pub const POINT: [f64; 2] = [23.5e-6, 1.45];
    pub const WALL: f64 = 2.65e-6;
    pub const RELATION: f64 = 1.2e-6;
    pub const COLOUR: f64 = 3.3e-6;
    pub const TILE: f64 = 0.9e-6;
    /// Per ray of the coarsest level.
    pub const COARSE_RAY: f64 = 0.166e-6;
    /// Per ray of the coarse levels: sums the ray hits by coarse point.
    pub const AMONG: f64 = 0.018e-6;
    /// Per visibility ray to a source.
    pub const SOURCE_RAY: f64 = 0.2e-6;
    /// Per entry of the coarse rows and per column.
    pub const BOUNCE: f64 = 0.6e-9;
    /// Assembling the file, then packing and writing it: fixed cost, cost per triangle, cost per point.
    pub const ASSEMBLED: [f64; 3] = [0.04, 0.35e-6, 0.9e-6];
}

/// Cost of a ray of the first finer level (beyond the later-bounce levels) relative to a ray of the coarsest level,
/// whose few points have few senders each: ratio at a reference number of functions, the reference number, increase of
/// the ratio per factor e of functions. Measured: 0.96 to 1.12 at `draft`, 1.18 to 1.34 at `standard`.
const FINE: (f64, f64, f64) = (1.03, 30e3, 0.106);
/// Cost of a ray of a level relative to the previous level: with half as many rays per point (and so half as many rays
/// to spread the work per link over), and with as many. First row: coarse levels. Second row: finer levels, whose rays
/// become more coherent as the distance between points halves. Measured: 1.10 to 1.25, 0.95 to 1.02; 0.94 to 1.08, 0.77
/// to 0.83.
const NEXT: [[f64; 2]; 2] = [[1.15, 1.02], [1.04, 0.85]];
/// Tiles per point, and tiles per triangle for rays: 8 to 19 per point in total.
const TILES: (f64, f64) = (11.0, 0.4);
/// Number of senders in a coarse row: 100 in an apartment, 360 in an empty room; and its upper bound as a share of the
/// coarse points.
const ROW: (f64, f64) = (170.0, 0.25);
/// Weight of the expected pace against measurements, in processor seconds: a share of the part's nominal cost, plus a
/// constant.
const TRUST: (f64, f64) = (0.055, 0.025);
/// Weight of a finished part in the expected pace of its kind, against earlier parts.
const MEMORY: f64 = 0.6;
/// Weight of the initial clock stretch of 1 against measurements, seconds.
const STRETCH: f64 = 0.2;
/// Half-life of measurements, seconds: a constant, plus a share of the elapsed time. The load of a machine varies, and
/// a shared cache or core costs processor time, too.
const HALF_LIFE: (f64, f64) = (2.0, 0.2);

/// Kind of work: parts of a kind have one pace.
#[derive(Clone, Copy, Debug, PartialEq)]
enum WorkKind {
    /// Setting up, and assembling the file.
    SettingUp,
    /// Almost only rays.
    Walls,
    CoarseLinks,
    FineLinks,
    /// Processing of ray hits; no rays.
    Bounces,
}

/// A stage of the bake, per level where the stage has levels.
#[derive(Clone, Debug)]
struct BakePart {
    stage: Stage,
    level: Option<usize>,
    kind: WorkKind,
    units: f64,
    /// Units done, including `skipped` units from an earlier run.
    done: f64,
    skipped: f64,
    /// Processor seconds of all units at pace 1.
    nominal: f64,
    /// Processor seconds since the part began.
    spent: f64,
    /// Recent work, with exponential decay: processor seconds spent, and processor seconds at pace 1.
    late: [f64; 2],
    is_over: bool,
}

impl BakePart {
    /// Returns the processor seconds at pace 1 of the units done in the current run.
    fn worked(&self) -> f64 {
        self.nominal * ((self.done - self.skipped) / self.units.max(1.0)).clamp(0.0, 1.0)
    }

    /// Returns the measured pace, blended with the expected pace.
    fn pace(&self, expected: f64) -> f64 {
        if self.done <= self.skipped {
            return expected;
        }
        let trust = TRUST.0 * self.nominal + TRUST.1;
        (self.late[0] + trust * expected) / (self.late[1] + trust)
    }

    /// Returns the processor seconds left.
    fn left(&self, expected: f64) -> f64 {
        match self.done > 0.0 {
            true => {
                let share = (1.0 - self.done / self.units.max(1.0)).clamp(0.0, 1.0);
                self.nominal * share * self.pace(expected)
            }
            false => (self.nominal * expected - self.spent).max(0.0),
        }
    }

    /// Returns clock seconds per processor second on `threads` undisturbed threads.
    fn ideal(&self, threads: f64) -> f64 {
        let shared = match self.stage {
            Stage::Bvh => 0.6,
            Stage::Hierarchy | Stage::Assemble => 0.0,
            _ => 1.0,
        };
        1.0 - shared + shared / threads
    }
}

/// Time left in a bake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Left {
    /// Clock seconds.
    pub seconds: f64,
    /// Processor seconds, summed over threads.
    pub processor_seconds: f64,
}

/// Returns the cost of a ray of each level, relative to the coarsest level; from the first level without later bounces
/// on, relative to the first level without later bounces.
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

/// Parts of a bake, their work, and the measured pace.
pub(super) struct Estimate {
    parts: Vec<BakePart>,
    /// Finished setting-up parts: processor seconds spent, and processor seconds at pace 1.
    set_up: [f64; 2],
    /// Measured paces, by [`WorkKind`].
    known: [Option<f64>; 5],
    /// Recent time, with exponential decay: clock seconds, and clock seconds of an idle machine.
    clock: [f64; 2],
    /// Time since the bake began: clock seconds, processor seconds.
    elapsed: [f64; 2],
    threads: f64,
    /// Triangles for rays.
    ray_triangles: f64,
    /// Relative cost of a ray, by level: see [`by_level`].
    by_level: Vec<f64>,
}

impl Estimate {
    /// Creates the estimate of a bake with these settings. `triangles` is the triangle count of the scene.
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
                (Stage::Links, Some(level)) if level < later_levels => WorkKind::CoarseLinks,
                (Stage::Links | Stage::Sources, _) => WorkKind::FineLinks,
                (Stage::CoarseMatrix | Stage::Multibounce, _) => WorkKind::Bounces,
                (Stage::ClipPlanes, _) => WorkKind::Walls,
                _ => WorkKind::SettingUp,
            };
            let (units, done, skipped, nominal, spent) = (0.0, 0.0, 0.0, 0.0, 0.0);
            let (late, is_over) = ([0.0; 2], false);
            estimate.parts.push(BakePart {
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
        add(Stage::Bvh, None);
        if sketches {
            add(Stage::Sketch, None);
        }
        (0..levels).for_each(|level| add(Stage::Points, Some(level)));
        [Stage::ClipPlanes, Stage::Hierarchy, Stage::Tints, Stage::HitCache]
            .into_iter()
            .for_each(|stage| add(stage, None));
        for level in 0..levels {
            add(Stage::Links, Some(level));
            if level + 1 == later_levels && settings.operator.bounces != Some(1) {
                add(Stage::CoarseMatrix, None);
                add(Stage::Multibounce, None);
            }
        }
        add(Stage::Sources, None);
        add(Stage::Assemble, None);
        add(Stage::Gloss, None);
        let prepared = cost::PREPARED[0] + cost::PREPARED[1] * triangles as f64;
        estimate.set(Stage::Bvh, None, triangles as f64, prepared);
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

    /// Sets the number of triangles for rays, copies included.
    pub(super) fn found_surfaces(&mut self, settings: &BakeSettings, ray_triangles: u64) {
        self.ray_triangles = ray_triangles.min(MOST_PRIMITIVES) as f64;
        self.expect_points(settings, &expected_counts(&settings.place));
    }

    /// Replaces the parts by the parts of the levels in `settings`.
    pub(super) fn found_levels(&mut self, settings: &BakeSettings) {
        let triangles = self.units(Stage::Assemble, None) as usize;
        let fresh = Self::new(settings, triangles, false, self.threads as usize);
        self.parts.retain(|part| matches!(part.stage, Stage::Bvh | Stage::Sketch));
        self.parts.extend(fresh.parts.into_iter().filter(|part| part.stage != Stage::Bvh));
        self.by_level = fresh.by_level;
        self.expect_points(settings, &expected_counts(&settings.place));
    }

    /// Sets the point counts of the coarsest levels; finer levels are scaled by the ratio of the last found level.
    pub(super) fn found_points(&mut self, settings: &BakeSettings, found: &[usize]) {
        let mut counts = expected_counts(&settings.place);
        let Some(last) = found.len().checked_sub(1).filter(|last| *last < counts.len()) else { return };
        let scale = found[last] as f64 / counts[last];
        counts.iter_mut().for_each(|count| *count *= scale);
        counts.iter_mut().zip(found).for_each(|(count, found)| *count = *found as f64);
        self.expect_points(settings, &counts);
    }

    /// Updates units and costs from the number of points per level.
    fn expect_points(&mut self, settings: &BakeSettings, counts: &[f64]) {
        let all: f64 = counts.iter().sum();
        self.set(Stage::ClipPlanes, None, 2.0 * all, 2.0 * cost::WALL * all);
        self.set(Stage::Hierarchy, None, all, cost::RELATION * all);
        for (level, count) in counts.iter().enumerate() {
            let above = (counts.len() - 1 - level) as i32;
            self.set(Stage::Points, Some(level), *count, cost::POINT[0] * cost::POINT[1].powi(above) * count);
            self.expect_rays(level, count * settings.operator.rays_on(level) as f64);
        }
        let triangles = self.units(Stage::Assemble, None);
        self.set(Stage::Tints, None, all, cost::COLOUR * all);
        let tiles = TILES.0 * all + TILES.1 * self.ray_triangles;
        self.set(Stage::HitCache, None, tiles, cost::TILE * tiles);
        let [file, of_triangle, of_point] = cost::ASSEMBLED;
        let assembled = file + of_triangle * triangles + of_point * all;
        self.set(Stage::Assemble, None, triangles, assembled);
        let coarse: f64 = counts.iter().take(settings.operator.later_levels).sum();
        let rays = |(level, count): (usize, &f64)| count * settings.operator.rays_on(level) as f64;
        let coarse_rays: f64 = counts.iter().enumerate().take(settings.operator.later_levels).map(rays).sum();
        self.set(Stage::CoarseMatrix, None, coarse, cost::AMONG * coarse_rays);
        self.expect_bounces(coarse, coarse * ROW.0.min(ROW.1 * coarse));
    }

    /// Sets the number of units of a part; the expected cost per unit stays.
    pub(super) fn expect_units(&mut self, (stage, level): (Stage, Option<usize>), units: f64) {
        if let Some(part) = self.part(stage, level) {
            let nominal = part.nominal * units / part.units.max(1.0);
            self.set(stage, level, units, nominal);
        }
    }

    /// Sets the number of rays of a level.
    pub(super) fn expect_rays(&mut self, level: usize, rays: f64) {
        let is_coarse = |part: &BakePart| part.kind == WorkKind::CoarseLinks && part.level == Some(level);
        let of_kind = match self.parts.iter().any(is_coarse) {
            true => 1.0,
            false => {
                let functions = self.units(Stage::Hierarchy, None).max(1.0);
                (FINE.0 + FINE.2 * (functions / FINE.1).ln()).clamp(0.5, 2.0)
            }
        };
        let share = of_kind * self.by_level.get(level).copied().unwrap_or(1.0);
        self.set(Stage::Links, Some(level), rays, share * cost::COARSE_RAY * rays);
    }

    /// Sets the number of points and rays of the sources.
    pub(super) fn expect_sources(&mut self, points: usize, rays: u64) {
        self.set(Stage::Sources, None, points as f64, cost::SOURCE_RAY * rays as f64);
    }

    /// Sets the number of columns of later bounces, and the number of entries of the coarse rows.
    pub(super) fn expect_bounces(&mut self, columns: f64, entries: f64) {
        self.set(Stage::Multibounce, None, columns, cost::BOUNCE * columns * entries);
    }

    fn set(&mut self, stage: Stage, level: Option<usize>, units: f64, nominal: f64) {
        if let Some(part) = self.part(stage, level).filter(|part| part.done == 0.0) {
            (part.units, part.nominal) = (units, nominal);
        }
    }

    fn part(&mut self, stage: Stage, level: Option<usize>) -> Option<&mut BakePart> {
        self.parts.iter_mut().find(|part| part.stage == stage && part.level == level)
    }

    /// Records progress of the current part: `done` units in total, `skipped` of them from an earlier run; clock
    /// seconds and processor seconds since the previous call.
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
        // Time before the first finished unit belongs to the first units.
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

    /// Marks a part as finished, regardless of its units.
    pub(super) fn end(&mut self, stage: Stage, level: Option<usize>) {
        let Some(part) = self.part(stage, level) else { return };
        part.is_over = true;
        let (kind, spent, worked) = (part.kind, part.spent, part.worked());
        if kind == WorkKind::SettingUp {
            if worked > 0.0 {
                self.set_up = [self.set_up[0] + spent, self.set_up[1] + worked];
            }
        } else if worked > 0.02 {
            let known = &mut self.known[kind as usize];
            let pace = spent / worked;
            *known = Some(known.map_or(pace, |before| MEMORY * pace + (1.0 - MEMORY) * before));
        }
    }

    /// Returns the units of a part, as far as known.
    pub(super) fn units(&mut self, stage: Stage, level: Option<usize>) -> f64 {
        self.part(stage, level).map_or(0.0, |part| part.units)
    }

    /// Returns two paces per kind of work: the expected pace before the current part, and the pace including
    /// measurements of the current part. A kind without measurements uses another kind: links cost as much as looking
    /// for walls did. (Looking for walls uses the setting-up pace without the current part: the first points of a level
    /// come fast, the last points slowly.)
    fn paces(&self) -> [[f64; 2]; 5] {
        let with = |kind: WorkKind, expected: f64| {
            let is_under_way =
                |part: &&BakePart| part.kind == kind && !part.is_over && part.done > part.skipped;
            let part = self.parts.iter().find(is_under_way);
            [expected, part.map_or(expected, |part| part.pace(expected))]
        };
        let of = |kind: WorkKind, other: f64| with(kind, self.known[kind as usize].unwrap_or(other));
        let trust = TRUST.0 + TRUST.1;
        let set_up = with(WorkKind::SettingUp, (self.set_up[0] + trust) / (self.set_up[1] + trust));
        let walls = of(WorkKind::Walls, set_up[0]);
        let coarse = of(WorkKind::CoarseLinks, walls[1]);
        let fine = of(WorkKind::FineLinks, coarse[1]);
        let bounces = of(WorkKind::Bounces, coarse[1]);
        [set_up, walls, coarse, fine, bounces]
    }

    /// Returns the time left of all unfinished parts.
    pub(super) fn left(&self) -> Left {
        let paces = self.paces();
        let stretch = (self.clock[0] + STRETCH) / (self.clock[1] + STRETCH);
        let mut left = Left { seconds: 0.0, processor_seconds: 0.0 };
        for part in self.parts.iter().filter(|part| !part.is_over) {
            // A current part blends in its own measurements.
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
