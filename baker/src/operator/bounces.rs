//! Later bounces: S = T + T² + T³ + … (Eq. 15), arriving on the coarse levels (paper, section 3.2).
//!
//! The series is summed a few senders at a time. Unit light at one sender is bounced from senders
//! to senders, as irradiance, until the energy left is negligible or each bounce is a smaller
//! copy of the one before; then all of it is sent to the coarse receivers at once. This needs no
//! product of sparse matrices, and its working memory is one vector.

use super::gather::link_directions;
use super::{Operator, OperatorSettings};
use crate::points::Points;
use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use rebounce_shared::link::{Link, RowWriter, VectorRgb, columns};
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};

/// Senders that travel together.
const BATCH: usize = 8;
/// The series ends when what is left is under this share of what has come.
const NEGLIGIBLE: f32 = 1e-3;
/// Or when the share that a bounce keeps changes by less than this from bounce to bounce: then
/// all further bounces look alike, and their sum, a geometric series, is added at once.
const STEADY: f32 = 2e-3;
/// No more bounces than this are followed one by one.
const MAX_BOUNCES: u32 = 64;

/// One colour channel of some numbers that travel together.
type Lane = [f32; BATCH];
/// Irradiance at a sender, red, green and blue.
type Light = [Lane; 3];

/// One link to a coarse receiver, unpacked.
struct Transfer {
    column: u32,
    direction: Vec3A,
    magnitude: Vec3A,
}

/// Adds the later bounces to the operator's links. `progress` is told the senders done and all.
pub fn add_later_bounces(
    operator: &mut Operator,
    points: &Points,
    settings: &OperatorSettings,
    progress: &(impl Fn(usize, usize) + Sync),
) {
    let levels = settings.later_levels.min(points.levels.len());
    let receivers = points.levels[..levels].last().map_or(0, |l| l.range().end);
    let senders = operator.irradiance.len();
    if settings.bounces.is_some_and(|wanted| wanted <= 1) || receivers == 0 {
        return;
    }
    let directions = link_directions();
    let unpack = |(column, link): (usize, Link)| Transfer {
        column: column as u32,
        direction: directions[(link.column_direction >> 16) as usize],
        magnitude: link.magnitude().into(),
    };
    let rows: Vec<Vec<Transfer>> =
        operator.rows[..receivers].iter().map(|row| columns(row).map(unpack).collect()).collect();
    let irradiance = &operator.irradiance;
    // Only what sends anything to anyone needs to be followed.
    let mut sends = vec![false; senders];
    for (sender, _) in irradiance.iter().flatten() {
        sends[*sender as usize] = true;
    }
    let active: Vec<u32> = (0..senders as u32).filter(|s| sends[*s as usize]).collect();
    let epsilons: Vec<f32> = points.levels[..levels]
        .iter()
        .enumerate()
        .flat_map(|(l, level)| std::iter::repeat_n(settings.epsilon_on(l), level.count))
        .collect();
    let deepest = AtomicU32::new(1);
    let done = AtomicUsize::new(0);
    let found: Vec<Vec<Vec<(u32, VectorRgb)>>> = active
        .par_chunks(BATCH * 16)
        .map(|chunk| {
            // Ascending senders within a chunk, so that small shares can be carried over.
            let mut kept: Vec<Vec<(u32, VectorRgb)>> = vec![Vec::new(); receivers];
            let mut carried = vec![VectorRgb::ZERO; receivers];
            for batch in chunk.chunks(BATCH) {
                let (light, bounces) = series(irradiance, batch, settings.bounces);
                deepest.fetch_max(bounces, Ordering::Relaxed);
                for (receiver, row) in rows.iter().enumerate() {
                    let arriving = send(row, &light);
                    for (sender, arriving) in batch.iter().zip(&arriving) {
                        carried[receiver].add_scaled(1.0, arriving);
                        if carried[receiver].magnitude() > epsilons[receiver] {
                            kept[receiver].push((*sender, std::mem::take(&mut carried[receiver])));
                        }
                    }
                }
            }
            if let Some(&last) = chunk.last() {
                for (kept, carried) in kept.iter_mut().zip(carried) {
                    if carried.magnitude() > 1e-7 {
                        match kept.last_mut() {
                            Some((sender, sum)) if *sender == last => sum.add_scaled(1.0, &carried),
                            _ => kept.push((last, carried)),
                        }
                    }
                }
            }
            let all = active.len();
            progress((done.fetch_add(chunk.len(), Ordering::Relaxed) + chunk.len()).min(all), all);
            kept
        })
        .collect();
    operator.bounces = deepest.into_inner();
    operator.rows[..receivers].par_iter_mut().enumerate().for_each(|(receiver, row)| {
        let later: Vec<(u32, VectorRgb)> =
            found.iter().flat_map(|chunk| chunk[receiver].iter().copied()).collect();
        if !later.is_empty() {
            *row = merge(row, &later);
        }
    });
}

/// Unit light at the senders of a batch: the irradiance of all its bounces on every sender, the
/// light itself not counted; and the bounces followed.
fn series(rows: &[Vec<(u32, Vec3)>], batch: &[u32], wanted: Option<u32>) -> (Vec<Light>, u32) {
    let zero = [[0f32; BATCH]; 3];
    let mut light = vec![zero; rows.len()];
    for (b, sender) in batch.iter().enumerate() {
        light[*sender as usize] = std::array::from_fn(|c| {
            let mut lane = light[*sender as usize][c];
            lane[b] = 1.0;
            lane
        });
    }
    let mut sums = vec![zero; rows.len()];
    let (mut total, mut last_energy, mut last_kept) = (0f32, 0f32, 0f32);
    let mut bounce = 1;
    loop {
        // The receivers take the last bounce themselves: `sums` is what they take it from.
        if wanted.is_some_and(|wanted| bounce >= wanted) || bounce == MAX_BOUNCES {
            return (sums, bounce);
        }
        bounce += 1;
        let next: Vec<Light> = rows
            .iter()
            .map(|row| {
                let mut sum = zero;
                for (sender, transfer) in row {
                    let light = &light[*sender as usize];
                    for c in 0..3 {
                        for b in 0..BATCH {
                            sum[c][b] += transfer[c] * light[c][b];
                        }
                    }
                }
                sum
            })
            .collect();
        let energy: f32 = next.as_flattened().as_flattened().iter().sum();
        total += energy;
        let kept = energy / last_energy.max(f32::MIN_POSITIVE);
        let ends = wanted.is_none()
            && bounce > 3
            && (energy <= NEGLIGIBLE * total * (1.0 - kept).max(0.02)
                || (kept < 0.98 && (kept - last_kept).abs() < STEADY));
        let scale = if ends { 1.0 + kept / (1.0 - kept.min(0.98)) } else { 1.0 };
        for (sum, next) in sums.iter_mut().zip(&next) {
            for c in 0..3 {
                for b in 0..BATCH {
                    sum[c][b] += scale * next[c][b];
                }
            }
        }
        if ends || energy <= 0.0 {
            return (sums, bounce);
        }
        (last_energy, last_kept, light) = (energy, kept, next);
    }
}

/// What a receiver's links bring it from senders with this irradiance.
fn send(row: &[Transfer], light: &[Light]) -> [VectorRgb; BATCH] {
    let mut out = [[Vec3A::ZERO; 3]; BATCH];
    for link in row {
        let [red, green, blue] = &light[link.column as usize];
        for (b, out) in out.iter_mut().enumerate() {
            out[0] += link.direction * (link.magnitude.x * red[b]);
            out[1] += link.direction * (link.magnitude.y * green[b]);
            out[2] += link.direction * (link.magnitude.z * blue[b]);
        }
    }
    out.map(|rgb| VectorRgb { rgb: rgb.map(Vec3::from) })
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
