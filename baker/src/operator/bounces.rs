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

use super::journal::{Columns, Journal};
use super::tally::IrradianceRow;
use super::{Operator, OperatorSettings};
use crate::watch::{Stopped, Watch};
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::link::LaterLink;

/// Coarse points whose light travels together.
const BATCH: usize = 16;
/// Batches of a part of the journal.
const BATCHES: usize = 8;
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

/// How many columns later bounces have: the units that [`add_later_bounces`] counts in.
pub fn column_count(operator: &Operator, settings: &OperatorSettings) -> usize {
    let none = settings.bounces.is_some_and(|wanted| wanted <= 1);
    if none { 0 } else { active(&operator.coarse).len() }
}

/// The coarse points whose light reaches another: only that needs to be followed.
fn active(coarse: &[IrradianceRow]) -> Vec<u32> {
    let mut sends = vec![false; coarse.len()];
    for (sender, _) in coarse.iter().flatten() {
        sends[*sender as usize] = true;
    }
    (0..coarse.len() as u32).filter(|s| sends[*s as usize]).collect()
}

/// Fills the operator's [`later`](Operator::later) rows. A unit of `watch` is a column. What `journal` has is taken
/// from there.
///
/// # Errors
/// [`Stopped`]; the operator is as it was.
pub fn add_later_bounces(
    operator: &mut Operator,
    settings: &OperatorSettings,
    watch: &dyn Watch,
    journal: &dyn Journal,
) -> Result<(), Stopped> {
    let count = operator.coarse.len();
    if settings.bounces.is_some_and(|wanted| wanted <= 1) || count == 0 {
        return Ok(());
    }
    let (coarse, tints) = (&operator.coarse, super::tint::unpack(&operator.tints[..count]));
    let least = settings.epsilon_later();
    let active = active(coarse);
    // Rows of C + C² + …, by chunks of ascending columns, so that small entries can be carried over.
    let chunks: Vec<Columns> = active
        .par_chunks(BATCH * BATCHES)
        .enumerate()
        .map(|(part, chunk)| {
            if let Some(columns) = journal.columns(part).filter(|columns| columns.rows.len() == count) {
                watch.skip(chunk.len() as u64)?;
                return Ok(columns);
            }
            let mut deepest = 2;
            let mut kept: Vec<ColourRow> = vec![Vec::new(); count];
            let mut carried = vec![Vec3::ZERO; count];
            // The last sender that each receiver sees, however little: what is left is given to it.
            let mut seen = vec![u32::MAX; count];
            for batch in chunk.chunks(BATCH) {
                let (light, bounces) = series(coarse, &tints, batch, settings.bounces, watch)?;
                deepest = deepest.max(bounces);
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
                watch.step(batch.len() as u64)?;
            }
            for ((kept, rest), last) in kept.iter_mut().zip(carried).zip(seen) {
                match kept.last_mut() {
                    Some((sender, sum)) if *sender == last => *sum += rest,
                    _ if rest != Vec3::ZERO => kept.push((last, rest)),
                    _ => {}
                }
            }
            let columns = Columns { bounces: deepest, rows: kept };
            journal.keep_columns(part, &columns);
            Ok(columns)
        })
        .collect::<Result<_, Stopped>>()?;
    operator.bounces = chunks.iter().map(|columns| columns.bounces).fold(2, u32::max);
    operator.later = (0..count)
        .into_par_iter()
        .map(|receiver| {
            let row = chunks.iter().flat_map(|columns| &columns.rows[receiver]);
            row.map(|(sender, colour)| LaterLink::pack(*sender, *colour)).collect()
        })
        .collect();
    Ok(())
}

/// Unit light at the coarse points of a batch: the irradiance of its bounces on every coarse point,
/// the light itself not counted; and the bounces that it has when the links have taken it on.
fn series(
    rows: &[IrradianceRow],
    tints: &[Vec3],
    batch: &[u32],
    wanted: Option<u32>,
    watch: &dyn Watch,
) -> Result<(Vec<Light>, u32), Stopped> {
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
            return Ok((sums, bounce));
        }
        watch.step(0)?;
        bounce += 1;
        // What the points send, in their colours.
        for (light, tint) in light.iter_mut().zip(tints) {
            for (lane, tint) in light.iter_mut().zip(tint.to_array()) {
                lane.iter_mut().for_each(|x| *x *= tint);
            }
        }
        let next: Vec<Light> = rows
            .iter()
            .map(|row| {
                let mut sum = zero;
                for (sender, transfer) in row {
                    let light = light[*sender as usize].as_flattened();
                    for (sum, light) in sum.as_flattened_mut().iter_mut().zip(light) {
                        *sum += transfer * light;
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
            return Ok((sums, bounce));
        }
        (last_energy, last_kept, light) = (energy, kept, next);
    }
}
