//! Later bounces: S = T + T² + T³ + … (Eq. 15), on the coarse levels (paper, section 3.2).
//!
//! The series is summed a few senders at a time: unit light at one sender is bounced through the
//! coarse levels – transport, push, dot with the normals, pull, differences, and again – until
//! the energy left is negligible. What it brings to a receiver after the first bounce is added
//! to the receiver's links. This needs no product of sparse matrices, and its working memory is
//! one vector.

use super::{Operator, OperatorSettings};
use crate::basis::Relations;
use crate::operator::gather::link_directions;
use crate::points::Points;
use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use rebounce_shared::interpolation::{Entry, Rows};
use rebounce_shared::link::{Link, RowWriter, VectorRgb, columns};
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};

/// Senders that travel together.
const BATCH: usize = 8;
/// The series ends when what is left is under this share of what has come.
const NEGLIGIBLE: f32 = 1e-3;
/// The series ends here whatever is left: a closed room of albedo 0.99 has 1% left.
const MAX_BOUNCES: u32 = 512;

/// One link of the coarse block, unpacked.
struct Transfer {
    column: u32,
    direction: Vec3A,
    magnitude: Vec3A,
}

/// Adds the later bounces to the operator's links. `progress` is told the senders done and all.
pub fn add_later_bounces(
    operator: &mut Operator,
    points: &Points,
    relations: &Relations,
    settings: &OperatorSettings,
    progress: &(impl Fn(usize, usize) + Sync),
) {
    let wanted = settings.bounces.unwrap_or(MAX_BOUNCES);
    let levels = settings.later_levels.min(settings.sender_levels).min(points.levels.len());
    let count = points.levels[..levels].last().map_or(0, |l| l.range().end);
    if wanted <= 1 || count == 0 {
        return;
    }
    let block = Block::new(operator, points, relations, levels, count);
    let deepest = AtomicU32::new(1);
    let done = AtomicUsize::new(0);
    let starts: Vec<usize> = (0..count).step_by(BATCH).collect();
    let found: Vec<Vec<(u32, u32, VectorRgb)>> = starts
        .into_par_iter()
        .map(|first| {
            let (sums, bounces) = block.series(first, wanted);
            deepest.fetch_max(bounces, Ordering::Relaxed);
            let mut kept = Vec::new();
            for (receiver, sums) in sums.iter().enumerate() {
                for (b, sum) in sums.iter().enumerate().take(count.min(first + BATCH) - first) {
                    let vectors = VectorRgb { rgb: sum.map(Vec3::from) };
                    let sender = first + b;
                    let carries_mean = block.is_root(receiver) && block.is_root(sender);
                    if vectors.magnitude() > if carries_mean { 1e-7 } else { settings.epsilon } {
                        kept.push((receiver as u32, sender as u32, vectors));
                    }
                }
            }
            progress((done.fetch_add(BATCH, Ordering::Relaxed) + BATCH).min(count), count);
            kept
        })
        .collect();
    operator.bounces = deepest.into_inner();
    let mut later: Vec<Vec<(u32, VectorRgb)>> = vec![Vec::new(); count];
    for (receiver, sender, vectors) in found.into_iter().flatten() {
        later[receiver as usize].push((sender, vectors));
    }
    operator.rows[..count].par_iter_mut().zip(later).for_each(|(row, later)| {
        if !later.is_empty() {
            *row = merge(row, &later);
        }
    });
}

/// A row plus later bounces; both ascend by sender.
fn merge(row: &[Link], later: &[(u32, VectorRgb)]) -> Vec<Link> {
    let mut merged = Vec::with_capacity(row.len() + later.len());
    let mut writer = RowWriter::default();
    let mut later = later.iter().peekable();
    let mut write = |sender: u32, link: Link| writer.push(&mut merged, sender, link);
    for (column, link) in columns(row) {
        while let Some((sender, vectors)) = later.next_if(|e| (e.0 as usize) < column) {
            write(*sender, Link::pack_vectors(0, vectors));
        }
        match later.next_if(|e| e.0 as usize == column) {
            Some((sender, vectors)) => {
                let mut sum = *vectors;
                sum.add_scaled(1.0, &link.vectors());
                write(*sender, Link::pack_vectors(0, &sum));
            }
            None => write(column as u32, link),
        }
    }
    for (sender, vectors) in later {
        write(*sender, Link::pack_vectors(0, vectors));
    }
    merged
}

/// The coarse levels' part of everything.
struct Block<'a> {
    rows: Vec<Vec<Transfer>>,
    push: Rows<'a>,
    pull: Rows<'a>,
    normals: Vec<Vec3A>,
    /// First point of each level, and the number of all.
    firsts: Vec<usize>,
}

impl<'a> Block<'a> {
    fn new(
        operator: &Operator,
        points: &Points,
        relations: &'a Relations,
        levels: usize,
        count: usize,
    ) -> Self {
        let directions = link_directions();
        let rows = operator.rows[..count]
            .iter()
            .map(|row| {
                columns(row)
                    .filter(|(column, _)| *column < count)
                    .map(|(column, link)| Transfer {
                        column: column as u32,
                        direction: directions[(link.column_direction >> 16) as usize],
                        magnitude: link.magnitude().into(),
                    })
                    .collect()
            })
            .collect();
        let mut firsts: Vec<usize> = points.levels[..levels].iter().map(|l| l.first).collect();
        firsts.push(count);
        Self {
            rows,
            push: relations.push(),
            pull: Rows { offsets: &relations.pull_offsets, entries: &relations.pull_entries },
            normals: points.points[..count].iter().map(|p| p.normal.into()).collect(),
            firsts,
        }
    }

    fn count(&self) -> usize {
        self.rows.len()
    }

    fn is_root(&self, point: usize) -> bool {
        self.push.row(point).is_empty()
    }

    /// Light of unit irradiance at the senders from `first` on: what their second and later
    /// bounces bring to every receiver, as coefficients; and the bounces made.
    fn series(&self, first: usize, wanted: u32) -> (Vec<[[Vec3A; 3]; BATCH]>, u32) {
        let mut light = vec![[Vec3A::ZERO; BATCH]; self.count()];
        for (b, sender) in light[first..].iter_mut().take(BATCH).enumerate() {
            sender[b] = Vec3A::ONE;
        }
        let mut sums = vec![[[Vec3A::ZERO; 3]; BATCH]; self.count()];
        let mut total = 0.0;
        let mut last = f32::INFINITY;
        for bounce in 1..=wanted {
            let mut arriving = self.transport(&light);
            if bounce > 1 {
                for (sum, new) in sums.iter_mut().zip(&arriving) {
                    for (sum, new) in sum.iter_mut().zip(new) {
                        for c in 0..3 {
                            sum[c] += new[c];
                        }
                    }
                }
            }
            self.push(&mut arriving);
            let mut irradiance: Vec<[Vec3A; BATCH]> = arriving
                .iter()
                .zip(&self.normals)
                .map(|(v, n)| v.map(|v| Vec3A::new(v[0].dot(*n), v[1].dot(*n), v[2].dot(*n))))
                .collect();
            let energy: f32 = irradiance.iter().flatten().map(|e| e.abs().element_sum()).sum();
            total += energy;
            // What is still to come, if each bounce keeps the share that this one kept.
            let kept = if last.is_finite() && last > 0.0 { (energy / last).min(0.999) } else { 0.999 };
            if energy * kept / (1.0 - kept) < NEGLIGIBLE * total {
                return (sums, bounce);
            }
            last = energy;
            self.pull(&mut irradiance);
            light = self.differences(&irradiance);
        }
        (sums, wanted)
    }

    fn transport(&self, light: &[[Vec3A; BATCH]]) -> Vec<[[Vec3A; 3]; BATCH]> {
        let mut out = vec![[[Vec3A::ZERO; 3]; BATCH]; self.count()];
        for (row, out) in self.rows.iter().zip(&mut out) {
            for link in row {
                let light = &light[link.column as usize];
                for (light, out) in light.iter().zip(out.iter_mut()) {
                    let power = link.magnitude * *light;
                    out[0] += link.direction * power.x;
                    out[1] += link.direction * power.y;
                    out[2] += link.direction * power.z;
                }
            }
        }
        out
    }

    fn push(&self, values: &mut [[[Vec3A; 3]; BATCH]]) {
        for i in 0..values.len() {
            let row = self.push.row(i);
            let scale = 1.0 / total(row).max(1.0);
            let (coarser, rest) = values.split_at_mut(i);
            for entry in row {
                let weight = entry.weight() * scale;
                for (value, parent) in rest[0].iter_mut().zip(&coarser[entry.point()]) {
                    for c in 0..3 {
                        value[c] += parent[c] * weight;
                    }
                }
            }
        }
    }

    fn pull(&self, irradiance: &mut [[Vec3A; BATCH]]) {
        for level in (0..self.firsts.len().saturating_sub(2)).rev() {
            for i in self.firsts[level]..self.firsts[level + 1] {
                let mut sum = [Vec3A::ZERO; BATCH];
                let mut weights = 0.0;
                for entry in self.pull.row(i).iter().filter(|e| e.point() < self.count()) {
                    weights += entry.weight();
                    for (sum, child) in sum.iter_mut().zip(&irradiance[entry.point()]) {
                        *sum += *child * entry.weight();
                    }
                }
                if weights > 0.0 {
                    irradiance[i] = sum.map(|s| s / weights);
                }
            }
        }
    }

    fn differences(&self, irradiance: &[[Vec3A; BATCH]]) -> Vec<[Vec3A; BATCH]> {
        (0..self.count())
            .map(|i| {
                let row = self.push.row(i);
                let scale = 1.0 / total(row).max(1.0);
                let mut out = irradiance[i];
                for entry in row {
                    let weight = entry.weight() * scale;
                    for (out, parent) in out.iter_mut().zip(&irradiance[entry.point()]) {
                        *out -= *parent * weight;
                    }
                }
                out
            })
            .collect()
    }
}

fn total(row: &[Entry]) -> f32 {
    row.iter().map(|e| e.weight()).sum()
}
