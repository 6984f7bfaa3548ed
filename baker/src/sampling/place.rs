//! Placement of the points of all levels.

use super::candidates::Candidates;
use super::emitter::ParticleEmitter;
use super::fill::fill;
use super::focus::{Focus, WORTH_IT, regions};
use super::objects::{Object, Objects};
use super::patience::{Patience, SHARES};
use super::place_settings::PlaceSettings;
use super::poisson_disk::DartBoard;
use super::{PointLevel, Points, SurfacePoint};
use crate::geometry::{Ray, Surfaces};
use crate::job::watch::{Stopped, Watch};
use crate::morton;
use crate::random::Stream;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::elementary::Elementary;
use rebounce_shared::interpolation::MAX_POINTS;
use rebounce_shared::rbn::MAX_LEVELS;

/// Reason for a failed placement of points.
#[derive(Debug, thiserror::Error)]
pub enum PlaceError {
    /// Particles from the viewpoint met no reflecting surface.
    #[error(
        "no surface can be seen from the viewpoint ({0}, {1}, {2}): give one inside the scene with --viewpoint x,y,z (are the surfaces one-sided and facing away?)"
    )]
    NothingSeen(f32, f32, f32),
    /// The number of points exceeds the limit of a file.
    #[error(
        "over {MAX_POINTS} basis functions: bake with fewer --functions, fewer --levels or a larger --coarse-radius"
    )]
    TooMany,
    /// The radius of level 0 is not positive, or too large for two points.
    #[error(
        "a --coarse-radius of {0} is none for a scene that is {1} across: give one between, or --functions"
    )]
    Radius(f32, f32),
    /// Stopped by the caller's watch.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// Candidates that are filtered in parallel before throwing: on a coarse level, candidates of a larger set would mainly
/// be in conflict with points of the same set, and the test for tight places costs rays.
const THROWN: usize = 1024;
/// Number of candidates after which a level without points stays empty.
const MOST_TRIED: u64 = 1_000_000;
/// Rays for the harmonic mean distance.
const HARMONIC_RAYS: u32 = 32;

/// Places the points of all levels for the surfaces seen by an emitter. A unit of `watch` is a point.
///
/// # Errors
/// [`PlaceError`].
pub fn place<S: Surfaces + ?Sized>(
    surfaces: &S,
    emitter: &ParticleEmitter,
    settings: &PlaceSettings,
    watch: &dyn Watch,
) -> Result<Points, PlaceError> {
    let mut placer = Placer::new(surfaces, emitter, settings)?;
    for _ in 0..placer.levels() {
        placer.level(watch)?;
    }
    Ok(placer.points)
}

/// State of the placement after a level. The next levels depend on this state and on the level's points only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedMark {
    /// Poisson-disk radius of level 0, scene units.
    pub coarse_radius: f32,
    /// Index of the first particle not yet traced.
    pub next_particle: u64,
}

/// Places points level by level, coarsest first.
pub struct Placer<'a, S: Surfaces + ?Sized> {
    surfaces: &'a S,
    settings: &'a PlaceSettings,
    source: Candidates<'a, S>,
    /// Candidates for the next level, already traced.
    pool: Vec<SurfacePoint>,
    coarse_radius: f32,
    /// Locally needed radii; `None` with a uniform radius.
    focus: Option<Focus>,
    /// Objects with candidates of their own.
    objects: Vec<Object>,
    /// Whether there are surfaces of no object.
    has_others: bool,
    /// Total number of levels.
    levels: usize,
    points: Points,
}

impl<'a, S: Surfaces + ?Sized> Placer<'a, S> {
    /// Traces a first pool of candidates and chooses the radii.
    ///
    /// # Errors
    /// [`PlaceError::NothingSeen`]; [`PlaceError::Radius`] or [`PlaceError::TooMany`] for an unsuitable radius in the
    /// settings.
    pub fn new(
        surfaces: &'a S,
        emitter: &'a ParticleEmitter,
        settings: &'a PlaceSettings,
    ) -> Result<Self, PlaceError> {
        let mut source = Candidates::new(surfaces, emitter, settings.seed);
        let mut pool = pool(&mut source);
        if pool.is_empty() {
            let first = emitter.viewpoints.first().copied().unwrap_or_default();
            return Err(PlaceError::NothingSeen(first.x, first.y, first.z));
        }
        let mut coarse_radius = match settings.coarse_radius {
            Some(radius) => check_radius(radius, surfaces.bounds(), &pool, settings)?,
            None => coarse_radius_for(&pool, settings),
        };
        let (mut focus, mut levels) = (None, settings.levels);
        let regions = regions(surfaces, emitter, settings.seed);
        if settings.coarse_radius.is_none() && !regions.is_empty() {
            let mut around = Candidates::new(surfaces, emitter, settings.seed).around(&regions);
            let places = self::pool(&mut around);
            let uniform = coarse_radius / (1u64 << (levels - 1)) as f32;
            let (low, high) = surfaces.main_part();
            let is_part = (low, high) != surfaces.bounds();
            let most = if is_part { (high - low).length() } else { uniform / WORTH_IT };
            let (count, coarser) = counted(settings);
            focus = Focus::new(regions, &places, count, coarser, most);
            if let Some(focus) = &focus {
                // Additional levels, so that the coarsest level is coarse enough for every place.
                let most = places.iter().map(|p| focus.needed(p.position)).fold(0.0, f32::max);
                let above = (most / focus.finest()).logarithm2().ceil().max(0.0) as usize + 1;
                levels = above.clamp(levels, MAX_LEVELS);
                coarse_radius = focus.finest() * (1u64 << (levels - 1)) as f32;
                (source, pool) = (around, places);
            }
        }
        let finest = coarse_radius / (1u64 << (levels - 1)) as f32;
        let Objects { all: objects, has_others } =
            Objects::new(surfaces, &emitter.viewpoints, settings, finest);
        let points = Points { scales: settings.scales(), ..Points::default() };
        Ok(Self {
            surfaces,
            settings,
            source,
            pool,
            coarse_radius,
            focus,
            levels,
            objects,
            has_others,
            points,
        })
    }

    /// Total number of levels: more than in the settings if radii differ from place to place.
    pub fn levels(&self) -> usize {
        self.levels
    }

    /// True if a particle's candidate may become a point of a level.
    fn fits(&self, level: usize, candidate: &SurfacePoint) -> bool {
        let radius = self.disk_radius(level) * self.points.scale(candidate.group);
        // The finest level of a place must cover the place.
        !self.is_on_object(candidate)
            && self.is_needed(level, candidate)
            && (level + 1 == self.levels
                || !self.is_needed(level + 1, candidate)
                || !is_tight(self.surfaces, candidate, radius))
    }

    /// True on an object, which has candidates of its own.
    fn is_on_object(&self, candidate: &SurfacePoint) -> bool {
        self.objects.iter().any(|object| object.group == candidate.group)
    }

    /// True if points of a level are needed at a place.
    fn is_needed(&self, level: usize, candidate: &SurfacePoint) -> bool {
        match &self.focus {
            Some(focus) if level > 0 => focus.needs(candidate.position, self.disk_radius(level)),
            _ => true,
        }
    }

    /// Levels placed so far.
    pub fn points(&self) -> &Points {
        &self.points
    }

    /// Levels placed so far.
    pub fn into_points(self) -> Points {
        self.points
    }

    /// State from which the next level continues.
    pub fn mark(&self) -> PlacedMark {
        PlacedMark { coarse_radius: self.coarse_radius, next_particle: self.source.next_particle() }
    }

    /// Adopts the next level's points from an earlier run; `mark` is the value of [`Self::mark`] after the level in the
    /// earlier run.
    pub fn take_over(&mut self, points: Vec<SurfacePoint>, mark: PlacedMark) {
        self.pool.clear();
        self.coarse_radius = mark.coarse_radius;
        self.source.go_on_at(mark.next_particle);
        self.push(points);
    }

    /// Places the next level. A unit of `watch` is a point.
    ///
    /// # Errors
    /// [`PlaceError`].
    pub fn level(&mut self, watch: &dyn Watch) -> Result<(), PlaceError> {
        let l = self.points.levels.len();
        let mut parts = vec![if self.has_others { self.thrown(l, watch)? } else { Vec::new() }];
        for object in &self.objects {
            let board = DartBoard::with_scales(self.disk_radius(l), &self.points.scales);
            let needed = |candidate: &SurfacePoint| self.is_needed(l, candidate);
            let points = object.thrown(self.surfaces, board, (l, self.settings), needed);
            watch.step(points.len() as u64)?;
            parts.push(points);
        }
        let (low, high) = self.surfaces.bounds();
        for points in &mut parts {
            points.sort_by_cached_key(|p| morton::code(p.position, low, high));
        }
        let points = parts.concat();
        self.within_limit(points.len())?;
        self.push(points);
        Ok(())
    }

    /// Throws particles' candidates on the surfaces that are of no object.
    fn thrown(&mut self, l: usize, watch: &dyn Watch) -> Result<Vec<SurfacePoint>, PlaceError> {
        let (surfaces, settings) = (self.surfaces, self.settings);
        let mut board = DartBoard::with_scales(self.disk_radius(l), &self.points.scales);
        let mut patience = Patience::new(settings.patience);
        let mut batch = std::mem::take(&mut self.pool);
        'level: loop {
            let before = board.len();
            for part in batch.chunks(THROWN) {
                // In parallel, filter out hopeless candidates; then, in order, throw the remaining candidates.
                let looked_at = |candidate: &SurfacePoint| {
                    let is_free = board.is_free(candidate);
                    let is_hopeful = is_free && self.fits(l, candidate);
                    let is_elsewhere = is_free && !is_hopeful && self.focus.is_some();
                    (is_hopeful, if is_elsewhere || self.is_on_object(candidate) { 1 } else { SHARES })
                };
                let hopeful: Vec<(bool, u64)> = part.par_iter().map(looked_at).collect();
                for (candidate, (hopeful, shares)) in part.iter().zip(hopeful) {
                    patience.tried += shares;
                    if hopeful && board.is_free(candidate) {
                        patience.inserted(board.len());
                        board.insert(*candidate);
                    } else if patience.is_over(board.len()) {
                        break 'level;
                    }
                }
            }
            watch.step((board.len() - before) as u64)?;
            self.within_limit(board.len())?;
            if patience.tried > SHARES * MOST_TRIED && board.is_empty() {
                break;
            }
            batch = self.source.batch();
        }
        let thrown = board.len();
        let fits = |candidate: &SurfacePoint| self.fits(l, candidate);
        fill(surfaces, &mut board, settings.seed, fits, watch)?;
        watch.step((board.len() - thrown) as u64)?;
        self.within_limit(board.len())?;
        Ok(board.into_points())
    }

    /// Checks that `more` points stay within the limit of a file.
    fn within_limit(&self, more: usize) -> Result<(), PlaceError> {
        if self.points.points.len() + more > MAX_POINTS { Err(PlaceError::TooMany) } else { Ok(()) }
    }

    fn disk_radius(&self, level: usize) -> f32 {
        self.coarse_radius / (1u64 << level) as f32
    }

    fn push(&mut self, points: Vec<SurfacePoint>) {
        let l = self.points.levels.len();
        let finest = l + 1 == self.levels;
        let overlap = if finest { self.settings.fine_overlap } else { self.settings.coarse_overlap };
        self.points.levels.push(PointLevel {
            first: self.points.points.len(),
            count: points.len(),
            disk_radius: self.disk_radius(l),
            support_radius: overlap * self.disk_radius(l),
        });
        self.points.points.extend(points);
    }
}

/// Functions of a level over functions of the next coarser level: under 4, because coarse functions cover the small
/// objects in rooms less well. Measured on furnished rooms and halls: 3.5 to 4.
const GROWTH: f32 = 3.6;
/// Approximate number of points on each level.
pub fn expected_counts(settings: &PlaceSettings) -> Vec<f64> {
    let finest = settings.levels.saturating_sub(1);
    let count = |level: usize| settings.functions as f64 / (GROWTH as f64).powi((finest - level) as i32);
    (0..settings.levels).map(count).collect()
}

/// Level on which functions are counted to choose the radii: fine enough to measure the surface's area, coarse enough
/// for a pool of candidates to fill the level.
const COUNTED_LEVEL: usize = 2;

/// Radius of level 0 for about the wanted number of functions on the finest level.
fn coarse_radius_for(pool: &[SurfacePoint], settings: &PlaceSettings) -> f32 {
    let (count, coarser) = counted(settings);
    let finest = (1u64 << settings.levels.saturating_sub(1)) as f32;
    radius_for(pool, count) * (finest / coarser)
}

/// Approximate number of functions on the counted level, and the level's disk radius over the finest disk radius.
fn counted(settings: &PlaceSettings) -> (usize, f32) {
    let above = settings.levels.saturating_sub(1).saturating_sub(COUNTED_LEVEL) as i32;
    let count = settings.functions as f32 / GROWTH.powi(above);
    (count.max(1.0) as usize, 2f32.powi(above))
}

/// Traces a pool of candidates as a sample of the scene's surfaces.
fn pool<S: Surfaces + ?Sized>(source: &mut Candidates<S>) -> Vec<SurfacePoint> {
    let mut pool = Vec::new();
    for _ in 0..64 {
        pool.extend(source.batch());
        if pool.len() > 40_000 {
            break;
        }
    }
    pool
}

/// Checks a given radius of level 0: smaller than the scene, and large enough for the limit of points.
fn check_radius(
    radius: f32,
    (low, high): (Vec3, Vec3),
    pool: &[SurfacePoint],
    settings: &PlaceSettings,
) -> Result<f32, PlaceError> {
    let diagonal = (high - low).length();
    if !(radius > 0.0 && radius < diagonal) {
        return Err(PlaceError::Radius(radius, diagonal));
    }
    // The number of functions grows inversely to the area of a disk.
    let few = PlaceSettings { functions: FEW, ..settings.clone() };
    let times = (coarse_radius_for(pool, &few) as f64 / radius as f64).powi(2);
    // The expected number is approximate: near the limit, placing decides.
    if FEW as f64 * times > 4.0 * MAX_POINTS as f64 { Err(PlaceError::TooMany) } else { Ok(radius) }
}

/// Number of functions from which other numbers of functions are extrapolated.
const FEW: usize = 10_000;

/// Disk radius at which throwing these candidates leaves about `count` points.
fn radius_for(pool: &[SurfacePoint], count: usize) -> f32 {
    let (low, high) = pool
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(p.position), h.max(p.position)));
    let diagonal = (high - low).length().max(f32::MIN_POSITIVE);
    let thrown = |radius: f32| {
        let mut board = DartBoard::new(radius);
        for candidate in pool {
            if board.is_free(candidate) {
                board.insert(*candidate);
                if board.len() > 4 * count {
                    break;
                }
            }
        }
        board.len()
    };
    // Bisection of the radius on a logarithmic scale: the count falls as the radius grows.
    let (mut small, mut large) = (diagonal * 1e-3, diagonal);
    // With a small object far away from the rest, disks are smaller still.
    while thrown(small) < count.min(pool.len() / 4) && small > diagonal * 1e-7 {
        (small, large) = (small * 1e-2, small);
    }
    for _ in 0..12 {
        let middle = (small * large).sqrt();
        if thrown(middle) > count { small = middle } else { large = middle }
    }
    large
}

/// True in places too tight for functions of this size: the harmonic mean distance to nearby
/// geometry, by rays of length 3R, is under R/6 (paper, section 2.3).
fn is_tight<S: Surfaces + ?Sized>(surfaces: &S, point: &SurfacePoint, disk_radius: f32) -> bool {
    let length = 3.0 * disk_radius;
    let p = point.position;
    let name = (p.x.to_bits() as u64) ^ (p.y.to_bits() as u64) << 20 ^ (p.z.to_bits() as u64) << 40;
    let mut stream = Stream::new(name, 1);
    let mut inverse_sum = 0.0;
    for i in 0..HARMONIC_RAYS {
        let mut direction = stream.sphere();
        if direction.dot(point.geometric_normal) < 0.0 {
            direction = -direction;
        }
        let origin = point.position + point.geometric_normal * surfaces.epsilon_at(point.position);
        let ray = Ray { origin, direction, max_distance: length, spread: Ray::VISIBILITY };
        let distance = surfaces.cast(&ray, i).map_or(length, |hit| hit.distance);
        inverse_sum += 1.0 / distance.max(1e-4 * length);
    }
    (HARMONIC_RAYS as f32) / inverse_sum < disk_radius / 6.0
}
