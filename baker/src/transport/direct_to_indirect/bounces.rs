//! Later bounces: S = T + T² + T³ + … (Eq. 15) as S = T (1 + P (1 + H) F).
//!
//! The links T carry the senders' light to all receivers. F is the part of T that ends at the
//! points of the coarse levels (paper, section 3.2: later bounces on coarse receivers): the
//! irradiance at coarse points after the first bounce. H adds all further bounces between coarse
//! points. P interpolates to the finer senders, where the result is added to the direct light.
//! Later bounces leave with the smoothness of the coarse levels and arrive with the full detail of
//! T.
//!
//! `H = C + C² + …`, with C the irradiance of coarse points from other coarse points. The
//! [`series`](super::series) is summed a few columns at a time: unit light at a coarse point is
//! bounced between coarse points until convergence. No product of sparse matrices is stored.

use super::accumulator::{IrradianceRow, reservoir_takes};
use super::bytes::{Reader, put, put_columns};
use super::journal::{Columns, PartialResults};
use super::series::{BATCH, Light, Series};
use super::{Operator, OperatorSettings};
use crate::job::communicator::share::{SendBuffer, Traffic, share};
use crate::job::communicator::{Communicator, CommunicatorError};
use crate::job::watch::{Stopped, Watch};
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::link::LaterLink;

/// Batches per part of the journal.
const BATCHES: usize = 8;

/// Irradiance of a receiver by sender and channel, senders ascending.
type ColourRow = Vec<(u32, Vec3)>;

/// Number of columns of the later bounces, the unit of progress in [`add_later_bounces`].
pub fn column_count(operator: &Operator, settings: &OperatorSettings) -> usize {
    let none = settings.bounces.is_some_and(|wanted| wanted <= 1);
    if none { 0 } else { active(&operator.coarse).len() }
}

/// Coarse points whose light reaches a coarse point; only their columns are computed.
fn active(coarse: &[IrradianceRow]) -> Vec<u32> {
    let mut sends = vec![false; coarse.len()];
    for (sender, _) in coarse.iter().flatten() {
        sends[*sender as usize] = true;
    }
    (0..coarse.len() as u32).filter(|s| sends[*s as usize]).collect()
}

/// Computes the operator's [`later`](Operator::later) rows with all processes of the communicator
/// and returns the number of bytes sent. Only the first process stores the rows, because no other
/// process reads them. A unit of `watch` is a column. Parts in the first process's `journal` are
/// read from the journal.
///
/// # Errors
/// [`CommunicatorError`]; the operator is unchanged.
pub fn add_later_bounces(
    operator: &mut Operator,
    settings: &OperatorSettings,
    watch: &dyn Watch,
    journal: &dyn PartialResults,
    team: &dyn Communicator,
) -> Result<Traffic, CommunicatorError> {
    let count = operator.coarse.len();
    let mut traffic = Traffic::default();
    if settings.bounces.is_some_and(|wanted| wanted <= 1) || count == 0 {
        return Ok(traffic);
    }
    let tints = super::tint::unpack(&operator.tints[..count]);
    let series = Series::new(&operator.coarse, &tints, settings.bounces);
    let active = active(&operator.coarse);
    // Parts hold ascending columns, so that small entries can be carried over.
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
        // The first process decides which parts are left.
        let mut told = Vec::new();
        put(&mut told, &left);
        let received = team.exchange(&[], if team.rank() == 0 { &told } else { &[] }, watch)?;
        let told = received.to_all.first().ok_or(CommunicatorError::Garbled(0))?;
        let mut from = Reader(told);
        left = from.take(from.rest::<u64>()).ok_or(CommunicatorError::Garbled(0))?;
        traffic.to_all += told.len() as u64;
    }
    let mine: Vec<usize> =
        left.iter().skip(team.rank()).step_by(team.size()).map(|part| *part as usize).collect();
    let work = |outbox: Option<&SendBuffer>| {
        let sum = |&part: &usize| {
            let senders = parts.get(part).copied().unwrap_or_default();
            let columns = part_of(&series, senders, count, settings.epsilon_later(), watch)?;
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
            let (part, columns) = from.columns().ok_or(CommunicatorError::Garbled(member))?;
            let senders = parts.get(part).filter(|_| columns.rows.len() == count);
            let senders = senders.ok_or(CommunicatorError::Garbled(member))?;
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
    let parts = found.into_iter().collect::<Option<Vec<_>>>().ok_or(CommunicatorError::Garbled(0))?;
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

/// Computes rows of C + C² + … for ascending `senders`, between `count` points. An amount up to
/// `least` is carried over to the next sender; the entry of a carried sum is assigned by chance to
/// a contributing sender ([`reservoir_takes`]).
fn part_of(
    series: &Series,
    senders: &[u32],
    count: usize,
    least: f32,
    watch: &dyn Watch,
) -> Result<Columns, Stopped> {
    let mut deepest = 2;
    let mut kept: Vec<ColourRow> = vec![Vec::new(); count];
    let mut carried = vec![Vec3::ZERO; count];
    // Sender assigned to each receiver's carried sum.
    let mut speaks = vec![0; count];
    for batch in senders.chunks(BATCH) {
        let (light, bounces) = series.columns(batch, watch)?;
        deepest = deepest.max(bounces);
        for (receiver, Light([red, green, blue])) in light.iter().enumerate() {
            for (b, sender) in batch.iter().enumerate() {
                let arriving = Vec3::new(red[b], green[b], blue[b]);
                if arriving == Vec3::ZERO {
                    continue;
                }
                let carried = &mut carried[receiver];
                *carried += arriving;
                let name = (receiver as u64) << 32 | *sender as u64;
                if reservoir_takes(name, arriving.element_sum(), carried.element_sum()) {
                    speaks[receiver] = *sender;
                }
                if carried.max_element() > least {
                    kept[receiver].push((speaks[receiver], std::mem::take(carried)));
                }
            }
        }
        watch.step(batch.len() as u64)?;
    }
    for ((kept, rest), sender) in kept.iter_mut().zip(carried).zip(speaks) {
        if rest != Vec3::ZERO {
            kept.push((sender, rest));
        }
    }
    Ok(Columns { bounces: deepest, rows: kept })
}
