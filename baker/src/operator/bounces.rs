//! Later bounces: S = T + T² + T³ + … (Eq. 15) as S = T (1 + P (1 + H) F).
//!
//! The links T take whatever the senders hold to all receivers. F is the part of T that ends at the points of the
//! coarse levels (paper, section 3.2: later bounces on coarse receivers): the irradiance there after one bounce. H
//! adds that of all further bounces between them; P interpolates to the finer senders, where it is added to the
//! direct light. So later bounces leave as smooth as the coarse levels are, and arrive with all the detail that
//! T has.
//!
//! `H = C + C² + …`, with C the irradiance of coarse points from each other. The series is summed a few columns
//! at a time: unit light at one coarse point is bounced among them until what is left is negligible or each bounce
//! is a smaller copy of the one before. No product of sparse matrices grows on the way.

use super::tally::IrradianceRow;
use super::{Operator, OperatorSettings};
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::link::LaterLink;
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};

/// Coarse points whose light travels together.
const BATCH: usize = 8;
/// The series ends when what is left is under this share of what has come.
const NEGLIGIBLE: f32 = 1e-3;
/// Or when the share that a bounce keeps changes by less than this from bounce to bounce: then
/// all further bounces look alike, and their sum, a geometric series, is added at once.
const STEADY: f32 = 2e-3;
/// No more bounces than this are followed one by one.
const MAX_BOUNCES: u32 = 64;

/// A receiver's irradiance by channel from senders, ascending.
type ColourRow = Vec<(u32, Vec3)>;
/// One colour channel of some numbers that travel together.
type Lane = [f32; BATCH];
/// Irradiance at a point, red, green and blue.
type Light = [Lane; 3];

/// Fills the operator's [`later`](Operator::later) rows. `progress` is told the columns done and all.
pub fn add_later_bounces(
    operator: &mut Operator,
    settings: &OperatorSettings,
    progress: &(impl Fn(usize, usize) + Sync),
) {
    let count = operator.coarse.len();
    if settings.bounces.is_some_and(|wanted| wanted <= 1) || count == 0 {
        return;
    }
    let (coarse, tints) = (&operator.coarse, super::tint::unpack(&operator.tints[..count]));
    let least = settings.epsilon_later();
    // Only light that is sent on to anyone needs to be followed.
    let mut sends = vec![false; count];
    for (sender, _) in coarse.iter().flatten() {
        sends[*sender as usize] = true;
    }
    let active: Vec<u32> = (0..count as u32).filter(|s| sends[*s as usize]).collect();
    let deepest = AtomicU32::new(2);
    let done = AtomicUsize::new(0);
    // Rows of C + C² + …, by chunks of ascending columns, so that small entries can be carried over.
    let chunks: Vec<Vec<ColourRow>> = active
        .par_chunks(BATCH * 16)
        .map(|chunk| {
            let mut kept: Vec<ColourRow> = vec![Vec::new(); count];
            let mut carried = vec![Vec3::ZERO; count];
            // The last sender that each receiver sees, however little: what is left is given to it.
            let mut seen = vec![u32::MAX; count];
            for batch in chunk.chunks(BATCH) {
                let (light, bounces) = series(coarse, &tints, batch, settings.bounces);
                deepest.fetch_max(bounces, Ordering::Relaxed);
                for (receiver, [red, green, blue]) in light.iter().enumerate() {
                    for (b, sender) in batch.iter().enumerate() {
                        let arriving = Vec3::new(red[b], green[b], blue[b]);
                        if arriving == Vec3::ZERO {
                            continue;
                        }
                        carried[receiver] += arriving;
                        seen[receiver] = *sender;
                        if carried[receiver].max_element() > least {
                            kept[receiver].push((*sender, std::mem::take(&mut carried[receiver])));
                        }
                    }
                }
            }
            for ((kept, rest), last) in kept.iter_mut().zip(carried).zip(seen) {
                match kept.last_mut() {
                    Some((sender, sum)) if *sender == last => *sum += rest,
                    _ if rest != Vec3::ZERO => kept.push((last, rest)),
                    _ => {}
                }
            }
            let all = active.len();
            progress((done.fetch_add(chunk.len(), Ordering::Relaxed) + chunk.len()).min(all), all);
            kept
        })
        .collect();
    operator.bounces = deepest.into_inner();
    operator.later = (0..count)
        .into_par_iter()
        .map(|receiver| {
            let row = chunks.iter().flat_map(|rows| &rows[receiver]);
            row.map(|(sender, colour)| LaterLink::pack(*sender, *colour)).collect()
        })
        .collect();
}

/// Unit light at the coarse points of a batch: the irradiance of its bounces on every coarse point,
/// the light itself not counted; and the bounces that it has when the links have taken it on.
fn series(rows: &[IrradianceRow], tints: &[Vec3], batch: &[u32], wanted: Option<u32>) -> (Vec<Light>, u32) {
    let zero = [[0f32; BATCH]; 3];
    let mut light = vec![zero; rows.len()];
    for (b, sender) in batch.iter().enumerate() {
        light[*sender as usize].iter_mut().for_each(|lane| lane[b] = 1.0);
    }
    let mut sums = vec![zero; rows.len()];
    let (mut total, mut last_energy, mut last_kept) = (0f32, 0f32, 0f32);
    // One bounce on the way here (F), one on the way to the receivers (T).
    let mut bounce = 2;
    loop {
        if wanted.is_some_and(|wanted| bounce >= wanted) || bounce == MAX_BOUNCES {
            return (sums, bounce);
        }
        bounce += 1;
        let next: Vec<Light> = rows
            .iter()
            .map(|row| {
                let mut sum = zero;
                for (sender, transfer) in row {
                    let (light, tint) = (&light[*sender as usize], tints[*sender as usize]);
                    for c in 0..3 {
                        let transfer = transfer * tint[c];
                        for b in 0..BATCH {
                            sum[c][b] += transfer * light[c][b];
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
            && bounce > 4
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
