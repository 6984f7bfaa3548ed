//! Adaptive choice of the points that get a matrix (Lehtinen et al. 2007, 6.4): all of the coarsest level; on the next,
//! those whose parents differ from each other; on finer ones, those with a parent whose own difference from its parents was
//! large. Norms are ‖·‖₁: the largest sum of magnitudes over a column.

use super::GlossSettings;
use super::glossy_points::GlossyPoints;
use super::matrix::{MatrixGather, MatrixVector};
use crate::geometry::Surfaces;
use crate::job::watch::{Stopped, Watch};
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::harmonics::COUNT;
use std::collections::HashMap;

/// Matrices of the points that have one.
pub(super) struct Matrices {
    /// Indices of the points, ascending.
    pub points: Vec<u32>,
    /// Differences from what the points' parents say; of the coarsest level, the matrices themselves.
    pub matrices: Vec<MatrixVector>,
    /// Rays cast.
    pub rays: u64,
}

/// Points a task.
const CHUNK: usize = 32;

/// Value of the first of the harmonics.
const FIRST: f32 = 0.282_094_8;

/// Norm ‖·‖₁ of a matrix, the largest of the channels, and of the light of an even environment that is seen, V y_0.
fn norm(vector: &[f32]) -> f32 {
    let (matrices, visibility) = vector.split_at(vector.len() - COUNT);
    let seen = FIRST * visibility.iter().map(|v| v.abs()).sum::<f32>();
    let channels = matrices.chunks_exact(COUNT * COUNT);
    let column = |matrix: &[f32], j: usize| (0..COUNT).map(|i| matrix[i * COUNT + j].abs()).sum::<f32>();
    let largest = |matrix: &[f32]| (0..COUNT).fold(0.0f32, |most, j| most.max(column(matrix, j)));
    channels.fold(seen, |most, matrix| most.max(largest(matrix)))
}

fn difference(a: &[f32], b: &[f32]) -> MatrixVector {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// A level's matrices as they are, and whether each was refined.
#[derive(Default)]
struct LevelMatrices {
    /// By point.
    whole: HashMap<u32, MatrixVector>,
    /// Points whose difference from their parents is over ε.
    differs: HashMap<u32, bool>,
}

impl LevelMatrices {
    /// The mean of the parents of a point.
    fn parents_mean(&self, file: &BakedScene, point: usize, dimensions: usize) -> MatrixVector {
        let (mut sum, mut total): (MatrixVector, f32) = (vec![0.0; dimensions].into(), 0.0);
        for entry in file.push().row(point) {
            if let Some(parent) = self.whole.get(&(entry.point() as u32)) {
                sum.iter_mut().zip(parent.iter()).for_each(|(sum, x)| *sum += x * entry.weight());
                total += entry.weight();
            }
        }
        let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
        sum.iter_mut().for_each(|x| *x *= scale);
        sum
    }
}

/// Computes the matrices of the points that need one.
///
/// # Errors
/// [`Stopped`].
pub(super) fn matrices<S: Surfaces + ?Sized>(
    gather: &MatrixGather<'_, S>,
    file: &BakedScene,
    glossy: &GlossyPoints,
    settings: &GlossSettings,
    watch: &dyn Watch,
) -> Result<Matrices, Stopped> {
    let mut out = Matrices { points: Vec::new(), matrices: Vec::new(), rays: 0 };
    let mut known = LevelMatrices::default();
    let mut is_first = true;
    for (level, range) in glossy.levels.windows(2).map(|pair| pair[0]..pair[1]).enumerate() {
        let points = &glossy.points[range];
        if points.is_empty() {
            continue;
        }
        if points.len() > settings.most && !is_first {
            break;
        }
        let is_refined = |point: u32| -> bool {
            let parents = file.push().row(point as usize).iter().map(|entry| entry.point() as u32);
            let of = |parent: &u32| known.whole.get(parent);
            match level {
                0 => true,
                // The parents of the first refined level have no difference of their own: they are held to each other.
                1 => {
                    let all: Vec<_> = parents.filter_map(|parent| of(&parent)).collect();
                    let first = all.first();
                    all.is_empty()
                        || all.iter().any(|other| {
                            first.is_some_and(|first| norm(&difference(other, first)) > settings.epsilon)
                        })
                }
                _ => {
                    let mut any = false;
                    let differs = parents.into_iter().any(|parent| {
                        any |= known.whole.contains_key(&parent);
                        known.differs.get(&parent).copied().unwrap_or(false)
                    });
                    differs || !any
                }
            }
        };
        type PointMatrix = (u32, MatrixVector, Option<MatrixVector>, u64);
        let compute = |point: &u32| -> PointMatrix {
            let mean = known.parents_mean(file, *point as usize, gather.dimensions());
            if !(is_first || is_refined(*point)) {
                return (*point, mean, None, 0);
            }
            let (matrix, rays) = gather.matrix(*point as usize);
            let own = difference(&matrix, &mean);
            (*point, matrix, Some(own), rays)
        };
        let mut next = LevelMatrices::default();
        for part in points.chunks(CHUNK * rayon::current_num_threads()) {
            let computed: Vec<PointMatrix> = part.par_iter().map(compute).collect();
            watch.step(part.len() as u64)?;
            for (point, whole, own, rays) in computed {
                out.rays += rays;
                if let Some(own) = own {
                    next.differs.insert(point, norm(&own) > settings.epsilon);
                    out.points.push(point);
                    out.matrices.push(own);
                }
                next.whole.insert(point, whole);
            }
        }
        known = next;
        is_first = false;
    }
    Ok(out)
}
