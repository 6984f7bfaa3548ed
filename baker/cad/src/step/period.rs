//! Loops on surfaces that repeat: closed loops within one period from loops that go round.
//!
//! Loops run with the face on their left. Where one goes round, or leaves the period, all are cut along a line u = c and its
//! repetitions and the pieces moved into one period. Along that line, upwards, the face begins where a loop crosses to the
//! right and ends where one crosses to the left; what begins or ends at a pole does so along the line that is the pole. Pieces
//! and the parts of both sides of the period within the face are then joined into closed loops.

use super::poles::Domain;
use super::{Flaw, Read};
use glam::DVec2;
use std::collections::HashMap;

/// Crossings of one face's loops with the line at which a period is cut.
const MOST_CROSSINGS: usize = 1 << 20;

/// A closed polygonal line on a surface that may repeat.
#[derive(Clone, Debug)]
pub(super) struct Ring {
    /// Vertices; the last is the first, moved by periods.
    pub points: Vec<DVec2>,
    /// Periods from the first to the last.
    pub turns: [i32; 2],
}

impl Ring {
    /// Signed area, of a ring that does not go round.
    fn area(&self) -> f64 {
        0.5 * self.points.windows(2).map(|pair| pair[0].perp_dot(pair[1] - pair[0])).sum::<f64>()
    }

    fn bounds(&self) -> [DVec2; 2] {
        let box_of = |[low, high]: [DVec2; 2], at: &DVec2| [low.min(*at), high.max(*at)];
        self.points.iter().fold([DVec2::INFINITY, DVec2::NEG_INFINITY], box_of)
    }

    fn move_by(&mut self, axis: usize, distance: f64) {
        self.points.iter_mut().for_each(|at| at[axis] += distance);
    }

    /// With u and v exchanged, still with the face on its left.
    fn exchanged(&self) -> Self {
        let points = self.points.iter().rev().map(|at| DVec2::new(at.y, at.x)).collect();
        Self { points, turns: [-self.turns[1], -self.turns[0]] }
    }
}

/// Polygons that enclose the face, by the even-odd rule, within one period.
pub(super) fn arrange(mut rings: Vec<Ring>, domain: &Domain) -> Read<Vec<Vec<DVec2>>> {
    let goes_round = |axis: usize, rings: &[Ring]| rings.iter().any(|ring| ring.turns[axis] != 0);
    let round = [goes_round(0, &rings), goes_round(1, &rings)];
    if round[0] && round[1] {
        return Err(Flaw::Unread("bounds that go round a surface both ways are not read".into()));
    }
    if !round[0] && !round[1] {
        gather(&mut rings, domain);
        if domain.is_closed() && rings.iter().map(Ring::area).sum::<f64>() < 0.0 {
            surround(&mut rings, domain)?;
        }
    }
    for axis in if round[1] { [1, 0] } else { [0, 1] } {
        let Some(period) = domain.periods[axis] else { continue };
        if round[axis]
            && let Some(across) = domain.periods[1 - axis]
        {
            alternate(&mut rings, axis, across);
        }
        let [low, high] = union(&rings);
        let start = settle(&mut rings, axis, period, domain.limits[axis], [low[axis], high[axis]]);
        let is_within = start.is_none_or(|start| {
            let [low, high] = union(&rings);
            low[axis] >= start - 1e-6 * period && high[axis] <= start + (1.0 + 1e-6) * period
        });
        if round[axis] || high[axis] - low[axis] > (1.0 + 1e-6) * period || !is_within {
            let line = start.unwrap_or_else(|| widest_gap(&rings, axis, period));
            let poles = domain.poles.iter().filter(|pole| pole.axis == 1 - axis).map(|pole| pole.value);
            let poles: Vec<f64> = poles.collect();
            rings = if axis == 0 {
                cut(&rings, period, line, &poles)?
            } else {
                let exchanged: Vec<Ring> = rings.iter().map(Ring::exchanged).collect();
                cut(&exchanged, period, line, &poles)?.iter().map(Ring::exchanged).collect()
            };
        }
    }
    for axis in 0..2 {
        if let Some([first, last]) = domain.limits[axis] {
            let points = rings.iter_mut().flat_map(|ring| &mut ring.points);
            points.for_each(|at| at[axis] = at[axis].clamp(first, last));
        }
    }
    Ok(rings.into_iter().filter_map(|ring| tidy(ring.points)).collect())
}

fn union(rings: &[Ring]) -> [DVec2; 2] {
    let boxes = rings.iter().map(Ring::bounds);
    boxes.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

/// Moves holes by periods to the largest ring.
fn gather(rings: &mut [Ring], domain: &Domain) {
    let largest = rings.iter().max_by(|a, b| a.area().abs().total_cmp(&b.area().abs()));
    let Some([low, high]) = largest.map(Ring::bounds) else { return };
    for ring in rings.iter_mut() {
        let [own_low, own_high] = ring.bounds();
        for axis in 0..2 {
            if let Some(period) = domain.periods[axis] {
                let apart = 0.5 * (low + high - own_low - own_high)[axis];
                ring.move_by(axis, period * (apart / period).round());
            }
        }
    }
}

/// Adds the sides of the whole domain about rings that are all holes.
fn surround(rings: &mut Vec<Ring>, domain: &Domain) -> Read<()> {
    let Some([mut low, mut high]) = domain.whole else { return Ok(()) };
    for axis in 0..2 {
        let Some(period) = domain.periods[axis] else { continue };
        let start =
            domain.limits[axis].map_or_else(|| uncovered(rings, axis, period), |[first, _]| Some(first));
        let start =
            start.ok_or_else(|| Flaw::Unread("holes all round a closed surface are not read".into()))?;
        for ring in rings.iter_mut() {
            let lowest = ring.bounds()[0][axis];
            ring.move_by(axis, -period * ((lowest - start) / period + 1e-9).floor());
        }
        low[axis] = start;
        high[axis] = start + period;
    }
    let points = vec![low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y), low];
    rings.push(Ring { points, turns: [0; 2] });
    Ok(())
}

/// A value that no ring's range has, the middle of the widest gap.
fn uncovered(rings: &[Ring], axis: usize, period: f64) -> Option<f64> {
    let mut ranges = Vec::new();
    for ring in rings {
        let [low, high] = ring.bounds();
        let start = low[axis].rem_euclid(period);
        ranges.push([start, start + high[axis] - low[axis]]);
    }
    ranges.sort_by(|a, b| a[0].total_cmp(&b[0]));
    // Ranges that reach past the period cover its beginning too.
    let mut reach = ranges.iter().map(|range| range[1] - period).max_by(f64::total_cmp)?;
    let mut best: Option<[f64; 2]> = None;
    for [start, end] in ranges {
        if start > reach && best.is_none_or(|[low, high]| high - low < start - reach) {
            best = Some([reach, start]);
        }
        reach = reach.max(end);
    }
    best.map(|[low, high]| 0.5 * (low + high))
}

/// On a torus: moves loops that go round in `axis` the other way, so that above each begins what the next ends.
fn alternate(rings: &mut [Ring], axis: usize, across: f64) {
    let other = 1 - axis;
    let mean = |ring: &Ring| {
        let [low, high] = ring.bounds();
        0.5 * (low + high)[other]
    };
    // Face above: to the left of a loop along u, to the right of one along v.
    let opens = |ring: &Ring| if axis == 0 { ring.turns[0] > 0 } else { ring.turns[1] < 0 };
    let Some(base) = rings.iter().position(opens) else { return };
    let from = mean(&rings[base]);
    for (at, ring) in rings.iter_mut().enumerate() {
        let above = (mean(ring) - from).rem_euclid(across);
        // A loop run both ways encloses all of the torus.
        let above = if above < 1e-9 * across && at != base && !opens(ring) { across } else { above };
        ring.move_by(other, from + above - mean(ring));
    }
}

/// Moves all rings by whole periods: into the limits each by itself, else together to begin from 0. Gives the beginning of the
/// limits.
fn settle(
    rings: &mut [Ring],
    axis: usize,
    period: f64,
    limits: Option<[f64; 2]>,
    [low, _]: [f64; 2],
) -> Option<f64> {
    let turns = |low: f64, start: f64| ((low - start) / period + 1e-6).floor();
    match limits {
        None => {
            let by = -period * turns(low, 0.0);
            rings.iter_mut().for_each(|ring| ring.move_by(axis, by));
            None
        }
        Some([first, _]) => {
            for ring in rings.iter_mut() {
                let by = -period * turns(ring.bounds()[0][axis], first);
                ring.move_by(axis, by);
            }
            Some(first)
        }
    }
}

/// The middle of the widest gap between vertices.
fn widest_gap(rings: &[Ring], axis: usize, period: f64) -> f64 {
    let points = rings.iter().flat_map(|ring| &ring.points);
    let mut values: Vec<f64> = points.map(|at| at[axis].rem_euclid(period)).collect();
    values.sort_by(f64::total_cmp);
    values.extend(values.first().map(|first| first + period));
    let gaps = values.windows(2).map(|pair| (pair[1] - pair[0], 0.5 * (pair[0] + pair[1])));
    gaps.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |gap| gap.1)
}

/// Where a loop crosses the line.
struct Crossing {
    v: f64,
    rightward: bool,
}

/// A side of the period and a crossing.
type End = (bool, usize);
const LEFT: bool = false;
const RIGHT: bool = true;

/// Part of a loop from side to side.
struct LoopPart {
    points: Vec<DVec2>,
    ends: [End; 2],
}

/// Cuts rings along u = line and its repetitions and closes them within one period.
fn cut(rings: &[Ring], period: f64, line: f64, poles: &[f64]) -> Read<Vec<Ring>> {
    let mut crossings = Vec::new();
    let mut parts = Vec::new();
    let mut closed = Vec::new();
    for ring in rings {
        if let Some(points) = cut_ring(ring, period, line, &mut crossings, &mut parts)? {
            closed.push(Ring { points, turns: [0; 2] });
        }
    }
    let mut order: Vec<usize> = (0..crossings.len()).collect();
    order.sort_by(|a, b| crossings[*a].v.total_cmp(&crossings[*b].v));
    let is_odd = order.len() % 2 == 1;
    let [left, right] = [line, line + period];
    let unclosed = || Flaw::Unread("bounds go round the surface but do not enclose a part of it".into());
    // Ends at poles.
    if let Some((&lowest, &highest)) = order.first().zip(order.last()) {
        let needs = [!crossings[lowest].rightward, crossings[highest].rightward];
        let below = |pole: &&f64| **pole <= crossings[lowest].v + 1e-9;
        let above = |pole: &&f64| **pole >= crossings[highest].v - 1e-9;
        let low = poles.iter().filter(below).copied().max_by(f64::total_cmp).filter(|_| needs[0]);
        let high = poles.iter().filter(above).copied().min_by(f64::total_cmp).filter(|_| needs[1]);
        let has_all = needs[0] == low.is_some() && needs[1] == high.is_some();
        let ends = [low, high].into_iter().flatten().count();
        if has_all && (is_odd == (ends == 1)) {
            if let Some(v) = low {
                let points = vec![DVec2::new(left, v), DVec2::new(right, v)];
                parts.push(LoopPart { points, ends: [(LEFT, crossings.len()), (RIGHT, crossings.len())] });
                order.insert(0, crossings.len());
                crossings.push(Crossing { v, rightward: true });
            }
            if let Some(v) = high {
                let points = vec![DVec2::new(right, v), DVec2::new(left, v)];
                parts.push(LoopPart { points, ends: [(RIGHT, crossings.len()), (LEFT, crossings.len())] });
                order.push(crossings.len());
                crossings.push(Crossing { v, rightward: false });
            }
        } else if is_odd {
            return Err(unclosed());
        }
    }
    for pair in order.chunks(2) {
        let [begin, end] = *pair else { return Err(unclosed()) };
        for (side, u) in [(RIGHT, right), (LEFT, left)] {
            let [from, to] = if side == RIGHT { [begin, end] } else { [end, begin] };
            let points = [from, to].map(|at| DVec2::new(u, crossings[at].v)).to_vec();
            parts.push(LoopPart { points, ends: [(side, from), (side, to)] });
        }
    }
    closed.extend(stitch(parts).ok_or_else(unclosed)?);
    Ok(closed)
}

/// Cuts one ring; gives it whole, moved into the period, if it crosses no line.
fn cut_ring(
    ring: &Ring,
    period: f64,
    line: f64,
    crossings: &mut Vec<Crossing>,
    parts: &mut Vec<LoopPart>,
) -> Read<Option<Vec<DVec2>>> {
    let cell = |at: DVec2| ((at.x - line) / period + 1e-9).floor();
    let moved = |at: DVec2, cell: f64| DVec2::new((at.x - cell * period).clamp(line, line + period), at.y);
    let Some(&first) = ring.points.first() else { return Ok(None) };
    let mut now = cell(first);
    let mut points = vec![moved(first, now)];
    let mut begin: Option<End> = None;
    // The part up to the first crossing.
    let mut head: Option<(Vec<DVec2>, End)> = None;
    for pair in ring.points.windows(2) {
        let (p, q) = (pair[0], pair[1]);
        let target = cell(q);
        while now != target {
            if crossings.len() >= MOST_CROSSINGS {
                return Err(Flaw::Unread("bounds go round the surface too often".into()));
            }
            let rightward = target > now;
            let u = line + period * if rightward { now + 1.0 } else { now };
            let v = p.y + ((u - p.x) / (q.x - p.x)).clamp(0.0, 1.0) * (q.y - p.y);
            let [end, start] = if rightward { [RIGHT, LEFT] } else { [LEFT, RIGHT] };
            let side = |side: bool| DVec2::new(if side { line + period } else { line }, v);
            points.push(side(end));
            let part = std::mem::replace(&mut points, vec![side(start)]);
            let at = crossings.len();
            match begin {
                Some(begin) => parts.push(LoopPart { points: part, ends: [begin, (end, at)] }),
                None => head = Some((part, (end, at))),
            }
            begin = Some((start, at));
            crossings.push(Crossing { v, rightward });
            now += if rightward { 1.0 } else { -1.0 };
        }
        points.push(moved(q, now));
    }
    if let (Some(begin), Some((head, end))) = (begin, head) {
        points.extend(head.into_iter().skip(1));
        parts.push(LoopPart { points, ends: [begin, end] });
        return Ok(None);
    }
    Ok(Some(points))
}

/// Joins parts at their ends: at each, two meet.
fn stitch(parts: Vec<LoopPart>) -> Option<Vec<Ring>> {
    let mut at_end = HashMap::<End, Vec<usize>>::new();
    for (index, part) in parts.iter().enumerate() {
        part.ends.iter().for_each(|end| at_end.entry(*end).or_default().push(index));
    }
    let mut used = vec![false; parts.len()];
    let mut rings = Vec::new();
    for first in 0..parts.len() {
        if used[first] {
            continue;
        }
        used[first] = true;
        let mut points = parts[first].points.clone();
        let mut end = parts[first].ends[1];
        while end != parts[first].ends[0] {
            let next = *at_end.get(&end)?.iter().find(|part| !used[**part])?;
            used[next] = true;
            let LoopPart { points: more, ends } = &parts[next];
            if ends[0] == end {
                points.extend(&more[1..]);
                end = ends[1];
            } else {
                points.extend(more.iter().rev().skip(1));
                end = ends[0];
            }
        }
        rings.push(Ring { points, turns: [0; 2] });
    }
    Some(rings)
}

/// Without the repeated last vertex, equal neighbours and vertices within sides of constant u or v. `None` if nothing is enclosed.
fn tidy(mut points: Vec<DVec2>) -> Option<Vec<DVec2>> {
    points.pop();
    let mut changed = true;
    while changed && points.len() >= 3 {
        let count = points.len();
        let needed = |at: usize| {
            let [a, b, c] = [points[(at + count - 1) % count], points[at], points[(at + 1) % count]];
            let is_between = |axis: usize| {
                let other = 1 - axis;
                a[axis] == b[axis]
                    && b[axis] == c[axis]
                    && (b[other] - a[other]) * (c[other] - b[other]) >= 0.0
            };
            a != b && !is_between(0) && !is_between(1)
        };
        // Neighbours are judged in turn, so that not both of two equal ones go.
        let mut kept = Vec::with_capacity(count);
        let mut dropped_last = false;
        for (at, point) in points.iter().enumerate() {
            dropped_last = !dropped_last && !needed(at);
            if !dropped_last {
                kept.push(*point);
            }
        }
        changed = kept.len() < count;
        points = kept;
    }
    (points.len() >= 3).then_some(points)
}
