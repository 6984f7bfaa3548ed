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

use super::bytes::{Reader, put, put_columns};
use super::journal::{Columns, Journal};
use super::tally::IrradianceRow;
use super::{Operator, OperatorSettings};
use crate::processor;
use crate::team::share::{Outbox, Traffic, share};
use crate::team::{Team, TeamError};
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
/// Irradiance at a point, red, green and blue: whole cache lines.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Light([Lane; 3]);

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

/// Fills the operator's [`later`](Operator::later) rows together with the team; those of the first member, as no other
/// reads them. A unit of `watch` is a column. What the first member's `journal` has is taken from there. How many bytes
/// were sent.
///
/// # Errors
/// [`TeamError`]; the operator is as it was.
pub fn add_later_bounces(
    operator: &mut Operator,
    settings: &OperatorSettings,
    watch: &dyn Watch,
    journal: &dyn Journal,
    team: &dyn Team,
) -> Result<Traffic, TeamError> {
    let count = operator.coarse.len();
    let mut traffic = Traffic::default();
    if settings.bounces.is_some_and(|wanted| wanted <= 1) || count == 0 {
        return Ok(traffic);
    }
    let tints = super::tint::unpack(&operator.tints[..count]);
    let series = Series { coarse: &operator.coarse, tints: &tints, settings };
    let active = active(&operator.coarse);
    // By parts of ascending columns, so that small entries can be carried over.
    let parts: Vec<&[u32]> = active.chunks(BATCH * BATCHES).collect();
    let mut found: Vec<Option<Columns>> = vec![None; parts.len()];
    for (part, senders) in parts.iter().enumerate() {
        if let Some(columns) = journal.columns(part).filter(|columns| columns.fits(senders, count)) {
            watch.skip(senders.len() as u64)?;
            found[part] = Some(columns);
        }
    }
    let mut left: Vec<u64> = (0..parts.len() as u64).filter(|part| found[*part as usize].is_none()).collect();
    if team.size() > 1 {
        // What the first member has to do is what there is to do.
        let mut told = Vec::new();
        put(&mut told, &left);
        let received = team.exchange(&[], if team.rank() == 0 { &told } else { &[] }, watch)?;
        let told = received.to_all.first().ok_or(TeamError::Garbled(0))?;
        let mut from = Reader(told);
        left = from.take(from.rest::<u64>()).ok_or(TeamError::Garbled(0))?;
        traffic.to_all += told.len() as u64;
    }
    let mine: Vec<usize> =
        left.iter().skip(team.rank()).step_by(team.size()).map(|part| *part as usize).collect();
    let work = |outbox: Option<&Outbox>| {
        let sum = |&part: &usize| {
            let senders = parts.get(part).copied().unwrap_or_default();
            let columns = series.columns(senders, watch)?;
            journal.keep_columns(part, &columns);
            if let Some(outbox) = outbox {
                outbox.post(|to_first, _| put_columns(to_first, part, &columns));
            }
            Ok((part, columns))
        };
        mine.par_iter().map(sum).collect::<Result<Vec<_>, Stopped>>()
    };
    let arrive = |member: usize, for_first: &[u8], _: &[u8]| {
        let mut from = Reader(for_first);
        while !from.is_empty() {
            let (part, columns) = from.columns().ok_or(TeamError::Garbled(member))?;
            let senders = parts.get(part).filter(|_| columns.rows.len() == count);
            let senders = senders.ok_or(TeamError::Garbled(member))?;
            journal.keep_columns(part, &columns);
            found[part] = Some(columns);
            watch.step(senders.len() as u64)?;
        }
        Ok(())
    };
    let (own, sent) = share(team, watch, work, arrive)?;
    traffic.add(sent);
    if team.rank() != 0 {
        return Ok(traffic);
    }
    for (part, columns) in own {
        found[part] = Some(columns);
    }
    let parts = found.into_iter().collect::<Option<Vec<_>>>().ok_or(TeamError::Garbled(0))?;
    operator.bounces = parts.iter().map(|columns| columns.bounces).fold(2, u32::max);
    operator.later = (0..count)
        .into_par_iter()
        .map(|receiver| {
            let row = parts.iter().flat_map(|columns| &columns.rows[receiver]);
            row.map(|(sender, colour)| LaterLink::pack(*sender, *colour)).collect()
        })
        .collect();
    Ok(traffic)
}

/// What the series of bounces is summed of.
struct Series<'a> {
    coarse: &'a [IrradianceRow],
    tints: &'a [Vec3],
    settings: &'a OperatorSettings,
}

impl Series<'_> {
    /// Rows of C + C² + … for some senders, ascending.
    fn columns(&self, senders: &[u32], watch: &dyn Watch) -> Result<Columns, Stopped> {
        let (count, least) = (self.coarse.len(), self.settings.epsilon_later());
        let mut deepest = 2;
        let mut kept: Vec<ColourRow> = vec![Vec::new(); count];
        let mut carried = vec![Vec3::ZERO; count];
        // The last sender that each receiver sees, however little: what is left is given to it.
        let mut seen = vec![u32::MAX; count];
        for batch in senders.chunks(BATCH) {
            let (light, bounces) = series(self.coarse, self.tints, batch, self.settings.bounces, watch)?;
            deepest = deepest.max(bounces);
            for (receiver, Light([red, green, blue])) in light.iter().enumerate() {
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
        Ok(Columns { bounces: deepest, rows: kept })
    }
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
    let zero = Light([[0f32; BATCH]; 3]);
    let mut light = vec![zero; rows.len()];
    for (b, sender) in batch.iter().enumerate() {
        light[*sender as usize].0.iter_mut().for_each(|lane| lane[b] = 1.0);
    }
    let mut sums = vec![zero; rows.len()];
    let (mut total, mut last_energy, mut last_kept) = (0f32, 0f32, 0f32);
    // One bounce on the way here (F), one on the way to the receivers (T).
    let mut bounces = 2;
    loop {
        if wanted.is_some_and(|wanted| bounces >= wanted) || bounces == MAX_BOUNCES {
            return Ok((sums, bounces));
        }
        watch.step(0)?;
        bounces += 1;
        // What the points send, in their colours.
        for (light, tint) in light.iter_mut().zip(tints) {
            for (lane, tint) in light.0.iter_mut().zip(tint.to_array()) {
                lane.iter_mut().for_each(|x| *x *= tint);
            }
        }
        let next = bounce_once(rows, &light);
        let energy = next.iter().fold([[0f32; BATCH]; 3], |mut sums, light| {
            for (sum, light) in sums.as_flattened_mut().iter_mut().zip(light.0.as_flattened()) {
                *sum += light;
            }
            sums
        });
        let energy: f32 = energy.as_flattened().iter().sum();
        total += energy;
        let kept = energy / last_energy.max(f32::MIN_POSITIVE);
        let ends = wanted.is_none()
            && bounces > 4
            && (energy <= NEGLIGIBLE * total * (1.0 - kept).max(0.02)
                || (kept < 0.98 && (kept - last_kept).abs() < STEADY));
        let scale = if ends { 1.0 + kept / (1.0 - kept.min(0.98)) } else { 1.0 };
        for (sum, next) in sums.iter_mut().zip(&next) {
            for c in 0..3 {
                for b in 0..BATCH {
                    sum.0[c][b] += scale * next.0[c][b];
                }
            }
        }
        if ends || energy <= 0.0 {
            return Ok((sums, bounces));
        }
        (last_energy, last_kept, light) = (energy, kept, next);
    }
}

/// The irradiance of every point from what all points send.
fn bounce_once(rows: &[IrradianceRow], light: &[Light]) -> Vec<Light> {
    #[cfg(target_arch = "x86_64")]
    if processor::has_avx512() {
        // SAFETY: the processor has AVX-512.
        #[expect(unsafe_code, reason = "what a processor has is known when the program runs")]
        return unsafe { bounce_once_avx512(rows, light) };
    } else if processor::has_avx2() {
        // SAFETY: the processor has AVX2.
        #[expect(unsafe_code, reason = "what a processor has is known when the program runs")]
        return unsafe { bounce_once_avx2(rows, light) };
    }
    rows.iter().map(|row| arriving(row, light)).collect()
}

/// The same arithmetic in the same order, and so the same numbers, eight at a time.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn bounce_once_avx2(rows: &[IrradianceRow], light: &[Light]) -> Vec<Light> {
    rows.iter().map(|row| arriving(row, light)).collect()
}

/// Sixteen at a time.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn bounce_once_avx512(rows: &[IrradianceRow], light: &[Light]) -> Vec<Light> {
    rows.iter().map(|row| arriving(row, light)).collect()
}

/// The irradiance of one point.
#[inline(always)]
fn arriving(row: &IrradianceRow, light: &[Light]) -> Light {
    let mut sum = [[0f32; BATCH]; 3];
    for (sender, transfer) in row {
        let light = light[*sender as usize].0.as_flattened();
        for (sum, light) in sum.as_flattened_mut().iter_mut().zip(light) {
            *sum += transfer * light;
        }
    }
    Light(sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn light_bounces_alike_however_many_numbers_are_added_at_once() {
        let mut stream = Stream::new(5, 0);
        let mut some = || 2.0 * stream.unit() - 0.5;
        let light: Vec<Light> =
            (0..90).map(|_| Light([(); 3].map(|_| [(); BATCH].map(|_| some())))).collect();
        let rows: Vec<IrradianceRow> =
            (0..90).map(|i| (i % 7..90).step_by(1 + i as usize % 5).map(|k| (k, some())).collect()).collect();
        let bits = |light: Vec<Light>| -> Vec<u32> {
            light.iter().flat_map(|light| light.0.as_flattened()).map(|x| x.to_bits()).collect()
        };
        let wanted = bits(rows.iter().map(|row| arriving(row, &light)).collect());
        assert_eq!(bits(bounce_once(&rows, &light)), wanted);
        #[cfg(target_arch = "x86_64")]
        if processor::has_avx2() {
            // SAFETY: the processor has AVX2.
            #[expect(unsafe_code, reason = "what a processor has is known when the test runs")]
            let found = unsafe { bounce_once_avx2(&rows, &light) };
            assert_eq!(bits(found), wanted);
        }
    }
}
