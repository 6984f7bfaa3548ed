//! All levels of points.

use super::candidates::Candidates;
use super::dart::DartBoard;
use super::fill::fill;
use super::{PointLevel, Points, SurfacePoint, morton};
use crate::random::Stream;
use crate::surface::{Ray, Surfaces};
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::interpolation::MAX_POINTS;

/// How points are placed.
#[derive(Clone, Debug)]
pub struct PlaceSettings {
    /// Number of levels.
    pub levels: usize,
    /// Poisson-disk radius of level 0, scene units; `None`: chosen for `functions`.
    pub coarse_radius: Option<f32>,
    /// About how many functions the finest level shall have.
    pub functions: usize,
    /// Support over disk radius on all levels but the finest.
    pub coarse_overlap: f32,
    /// Support over disk radius on the finest level.
    pub fine_overlap: f32,
    /// Failures in a row that end a level.
    pub failures: usize,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Default for PlaceSettings {
    /// The paper's numbers.
    fn default() -> Self {
        Self {
            levels: 6,
            coarse_radius: None,
            functions: 120_000,
            coarse_overlap: 1.5,
            fine_overlap: 2.0,
            failures: 2000,
            seed: 1,
        }
    }
}

/// Why points could not be placed.
#[derive(Debug, thiserror::Error)]
pub enum PlaceError {
    /// Particles from the viewpoint met no reflecting surface.
    #[error(
        "no surface can be seen from the viewpoint ({0}, {1}, {2}): give one inside the scene with --viewpoint x,y,z (are the surfaces one-sided and facing away?)"
    )]
    NothingSeen(f32, f32, f32),
    /// More points than a file can hold.
    #[error("over {MAX_POINTS} basis functions: bake with fewer --levels or a larger --coarse-radius")]
    TooMany,
}

/// Rays for the harmonic mean distance.
const HARMONIC_RAYS: u32 = 32;

/// Places the points of all levels for what is seen from `viewpoints` (local space). `progress`
/// is told the level and its number of points so far.
///
/// # Errors
/// [`PlaceError`].
pub fn place<S: Surfaces + ?Sized>(
    surfaces: &S,
    viewpoints: &[Vec3],
    settings: &PlaceSettings,
    mut progress: impl FnMut(usize, usize),
) -> Result<Points, PlaceError> {
    let mut source = Candidates::new(surfaces, viewpoints, settings.seed);
    let mut pool = Vec::new();
    for _ in 0..64 {
        pool.extend(source.batch());
        if pool.len() > 40_000 {
            break;
        }
    }
    if pool.is_empty() {
        let first = viewpoints.first().copied().unwrap_or_default();
        return Err(PlaceError::NothingSeen(first.x, first.y, first.z));
    }
    let coarse_radius = settings.coarse_radius.unwrap_or_else(|| coarse_radius_for(&pool, settings));
    let mut result = Points::default();
    for l in 0..settings.levels {
        let disk_radius = coarse_radius / (1u64 << l) as f32;
        let finest = l + 1 == settings.levels;
        let overlap = if finest { settings.fine_overlap } else { settings.coarse_overlap };
        let mut board = DartBoard::new(disk_radius);
        let fits = |candidate: &SurfacePoint| finest || !is_tight(surfaces, candidate, disk_radius);
        let mut failures = 0;
        let mut batch = std::mem::take(&mut pool);
        'level: loop {
            // In parallel, sort out what cannot pass; then, in order, throw what is left.
            let hopeful: Vec<bool> =
                batch.par_iter().map(|candidate| board.is_free(candidate) && fits(candidate)).collect();
            for (candidate, hopeful) in batch.iter().zip(hopeful) {
                if hopeful && board.is_free(candidate) {
                    board.insert(*candidate);
                    failures = 0;
                } else {
                    failures += 1;
                    if failures >= settings.failures && !board.is_empty() {
                        break 'level;
                    }
                }
            }
            progress(l, board.len());
            if result.points.len() + board.len() > MAX_POINTS {
                return Err(PlaceError::TooMany);
            }
            if failures > 1_000_000 {
                break;
            }
            batch = source.batch();
        }
        fill(surfaces, &mut board, disk_radius, settings.seed, fits);
        if result.points.len() + board.len() > MAX_POINTS {
            return Err(PlaceError::TooMany);
        }
        let mut points = board.into_points();
        let (low, high) = surfaces.bounds();
        points.sort_by_cached_key(|p| morton::code(p.position, low, high));
        result.levels.push(PointLevel {
            first: result.points.len(),
            count: points.len(),
            disk_radius,
            support_radius: overlap * disk_radius,
        });
        result.points.extend(points);
    }
    Ok(result)
}

/// Functions of a level over those of the level before: under 4, because rooms are full of small
/// things that coarse functions cover less well. Measured on furnished rooms and halls: 3.5 to 4.
const GROWTH: f32 = 3.6;
/// The level whose functions are counted to choose the radii: fine enough to know the surface's
/// area, coarse enough for a pool of candidates to fill it.
const COUNTED_LEVEL: usize = 2;

/// The radius of level 0 that gives the finest level about as many functions as wanted.
fn coarse_radius_for(pool: &[SurfacePoint], settings: &PlaceSettings) -> f32 {
    let finest = settings.levels.saturating_sub(1);
    let counted = COUNTED_LEVEL.min(finest);
    let count = settings.functions as f32 / GROWTH.powi((finest - counted) as i32);
    radius_for(pool, count.max(1.0) as usize) * (1u32 << counted) as f32
}

/// The disk radius at which throwing these candidates leaves about `count` points.
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
        let origin = point.position + point.geometric_normal * surfaces.epsilon();
        let ray = Ray { origin, direction, max_distance: length };
        let distance = surfaces.cast(&ray, i).map_or(length, |hit| hit.distance);
        inverse_sum += 1.0 / distance.max(1e-4 * length);
    }
    (HARMONIC_RAYS as f32) / inverse_sum < disk_radius / 6.0
}
