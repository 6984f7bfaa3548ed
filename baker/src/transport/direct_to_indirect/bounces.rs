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

use super::accumulator::reservoir_takes;
use super::series::{BATCH, Light, Series};
use super::{Operator, OperatorSettings};
use crate::transport::operator::IrradianceRow;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::link::LaterLink;

/// Batches per part.
const BATCHES: usize = 8;

/// Irradiance of a receiver by sender and channel, senders ascending.
type ColourRow = Vec<(u32, Vec3)>;

/// Rows of later bounces for a set of coarse senders.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Columns {
    /// Number of bounces in the rows.
    pub bounces: u32,
    /// Irradiance of each coarse receiver by sender and channel, senders ascending.
    pub rows: Vec<Vec<(u32, Vec3)>>,
}

/// Number of columns of the later bounces.
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

/// The later bounces of an operator, in independent parts: ascending coarse senders, so that small entries are carried
/// over within a part.
pub struct LaterBounces<'a> {
    series: Series<'a>,
    /// Coarse senders.
    active: Vec<u32>,
    /// Number of coarse points.
    count: usize,
    epsilon: f32,
}

impl<'a> LaterBounces<'a> {
    /// Prepares the parts. `tints` are the colours of the coarse points. `None` if there are no later bounces.
    pub fn new(coarse: &'a [IrradianceRow], tints: &'a [Vec3], settings: &OperatorSettings) -> Option<Self> {
        if settings.bounces.is_some_and(|wanted| wanted <= 1) || coarse.is_empty() {
            return None;
        }
        let series = Series::new(coarse, tints, settings.bounces);
        let epsilon = settings.epsilon_later();
        Some(Self { series, active: active(coarse), count: coarse.len(), epsilon })
    }

    /// Number of parts.
    pub fn count(&self) -> usize {
        self.active.len().div_ceil(BATCH * BATCHES)
    }

    /// Coarse senders of a part.
    pub fn senders(&self, part: usize) -> &[u32] {
        self.active.chunks(BATCH * BATCHES).nth(part).unwrap_or_default()
    }

    /// Computes a part.
    pub fn columns(&self, part: usize) -> Columns {
        columns(&self.series, self.senders(part), self.count, self.epsilon)
    }

    /// Whether data of unknown origin is valid for a part: a row for each coarse point, from the part's senders
    /// (ascending), with finite irradiance.
    pub fn fits(&self, part: usize, columns: &Columns) -> bool {
        let senders = self.senders(part);
        let row = |row: &ColourRow| {
            row.windows(2).all(|pair| pair[0].0 < pair[1].0)
                && row.iter().all(|entry| entry.1.is_finite() && senders.binary_search(&entry.0).is_ok())
        };
        columns.rows.len() == self.count && columns.rows.iter().all(row)
    }
}

/// Computes the operator's [`later`](Operator::later) rows.
pub fn add_later_bounces(operator: &mut Operator, settings: &OperatorSettings) {
    let tints = super::tint::unpack(&operator.tints[..operator.coarse.len()]);
    let Some(later) = LaterBounces::new(&operator.coarse, &tints, settings) else { return };
    let parts = (0..later.count()).into_par_iter().map(|part| later.columns(part)).collect();
    set_later(operator, parts);
}

/// Stores all parts of the later bounces.
pub fn set_later(operator: &mut Operator, parts: Vec<Columns>) {
    operator.bounces = parts.iter().map(|columns| columns.bounces).fold(2, u32::max);
    operator.later = (0..operator.coarse.len())
        .into_par_iter()
        .map(|receiver| {
            let row = parts.iter().flat_map(|columns| &columns.rows[receiver]);
            row.map(|(sender, colour)| LaterLink::pack(*sender, *colour)).collect()
        })
        .collect();
}

/// Computes rows of C + C² + … for ascending `senders`, between `count` points. An amount up to
/// `least` is carried over to the next sender; the entry of a carried sum is assigned by chance to
/// a contributing sender ([`reservoir_takes`]).
fn columns(series: &Series, senders: &[u32], count: usize, least: f32) -> Columns {
    let mut deepest = 2;
    let mut kept: Vec<ColourRow> = vec![Vec::new(); count];
    let mut carried = vec![Vec3::ZERO; count];
    // Sender assigned to each receiver's carried sum.
    let mut speaks = vec![0; count];
    for batch in senders.chunks(BATCH) {
        let (light, bounces) = series.columns(batch);
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
    }
    for ((kept, rest), sender) in kept.iter_mut().zip(carried).zip(speaks) {
        if rest != Vec3::ZERO {
            kept.push((sender, rest));
        }
    }
    Columns { bounces: deepest, rows: kept }
}
