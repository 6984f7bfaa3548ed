//! Later bounces: S = T + T² + T³ + … (Eq. 15) as S = T (1 + P (1 + H) F).
//!
//! The links T take whatever the senders hold to all receivers. F is the part of T that ends at the points of the
//! coarse levels (paper, section 3.2: later bounces on coarse receivers): the irradiance there after one bounce. H
//! adds that of all further bounces between them; P interpolates to the finer senders, where it is added to the
//! direct light. So later bounces leave as smooth as the coarse levels are, and arrive with all the detail that
//! T has.
//!
//! `H = C + C² + …`, with C the irradiance of coarse points from each other. The [`series`](super::series) is summed a
//! few columns at a time: unit light at one coarse point is bounced among them until it has settled. No product of sparse
//! matrices grows on the way.

use super::accumulator::{IrradianceRow, reservoir_takes};
use super::bytes::{Reader, put, put_columns};
use super::journal::{Columns, PartialResults};
use super::series::{BATCH, Light, Series};
use super::{Operator, OperatorSettings};
use crate::communicator::share::{SendBuffer, Traffic, share};
use crate::communicator::{Communicator, CommunicatorError};
use crate::watch::{Stopped, Watch};
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::link::LaterLink;

/// Batches of a part of the journal.
const BATCHES: usize = 8;

/// A receiver's irradiance by channel from senders, ascending.
type ColourRow = Vec<(u32, Vec3)>;

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
/// [`CommunicatorError`]; the operator is as it was.
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

/// Rows of C + C² + … for some senders, ascending, between so many points. What is not over `least` is carried over to the
/// next sender; who of those that it is from [speaks](reservoir_takes) for the sum, chance says.
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
    // Who speaks for what is carried.
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
