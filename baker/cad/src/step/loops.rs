//! Trimming loops of a face.

use super::curves::Geometry;
use super::path::{Edge, Path};
use super::period::{self, Ring};
use super::poles::Domain;
use super::project::{Mapper, Pcurve, Strand, TOLERANCE};
use super::surfaces::Placed;
use super::{Flaw, Read, plane};
use crate::frame::Frame;
use crate::surface::Surface;
use crate::trim::{TrimEdge, TrimLoop};
use glam::{DVec2, DVec3};
use std::rc::Rc;

/// One bound of a face: edges, each with whether it is run from start to end.
pub(super) type Bound = Vec<(Rc<Edge>, bool)>;

/// A face's domain.
pub(super) struct Trimmed {
    /// The surface, a plane maybe turned about its axis.
    pub surface: Surface,
    /// Closed loops.
    pub loops: Vec<TrimLoop>,
    /// Whether edges stand off the surface by more than a thousandth of the face's size.
    pub is_off: bool,
    /// Whether bounds run clockwise all the same: the file contradicts itself.
    pub is_against: bool,
}

impl Trimmed {
    fn new(surface: Surface, loops: Vec<TrimLoop>, is_off: bool) -> Self {
        let about = loops.iter().flatten().next().map_or(DVec2::ZERO, |edge| edge.ends()[0]);
        let area: f64 = loops.iter().flatten().map(|edge| edge.swept_area(about)).sum();
        Self { surface, loops, is_off, is_against: area < 0.0 }
    }
}

impl Geometry<'_> {
    /// Loops of a face whose bounds run counter-clockwise in the parameter plane of `placed`.
    pub fn trim(&self, placed: Placed, bounds: &[Bound]) -> Read<Trimmed> {
        let runs = bounds.iter().flatten();
        let paths: Vec<Path> = runs
            .map(|(edge, forward)| if *forward { edge.path.clone() } else { edge.path.reversed() })
            .collect();
        let size = self.size(&paths)?;
        if let Some(frame) = plane::frame(&placed.surface) {
            let frame = plane::along_ellipse(frame, paths.iter());
            return self.trim_plane(frame, bounds, paths, size);
        }
        let domain = Domain::new(&placed.surface);
        let mapper = Mapper { file: self.file, surface: &placed.surface, domain: &domain, size };
        if paths.is_empty() {
            let loops = vec![rectangle(whole(&placed, &domain)?)];
            return Ok(Trimmed::new(placed.surface, loops, false));
        }
        let mut paths = paths.into_iter();
        let mut rings = Vec::new();
        let mut off: f64 = 0.0;
        for bound in bounds {
            let mut strands = Vec::new();
            for ((edge, _), path) in bound.iter().zip(&mut paths) {
                let pcurve = self.pcurve(&placed, edge);
                let (mapped, gap) = mapper.map(&path, pcurve.as_ref())?;
                strands.extend(mapped);
                off = off.max(gap);
            }
            rings.extend(ring(&mapper, strands));
        }
        let polygons = period::arrange(rings, &domain)?;
        self.file.spend(polygons.iter().map(Vec::len).sum())?;
        let loops: Vec<TrimLoop> = polygons.iter().map(|polygon| closed(polygon)).collect();
        if loops.is_empty() {
            return Err(Flaw::Unread("bounds enclose nothing".into()));
        }
        Ok(Trimmed::new(placed.surface, loops, off > 1e-3 * size))
    }

    /// Diagonal of the box about the edges.
    fn size(&self, paths: &[Path]) -> Read<f64> {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for path in paths {
            let breaks = path.breaks();
            self.file.spend(breaks.len())?;
            for place in breaks.into_iter().map(|s| path.point(s)) {
                low = low.min(place);
                high = high.max(place);
            }
        }
        let size = if paths.is_empty() { 1.0 } else { low.distance(high) };
        if size > 0.0 && size.is_finite() {
            Ok(size)
        } else {
            Err(Flaw::Unread("edges have no size or leave the range of numbers".into()))
        }
    }

    /// The edge's curve in the parameter plane, of those surfaces that have no closed form for it.
    fn pcurve(&self, placed: &Placed, edge: &Edge) -> Option<Pcurve> {
        let wants = matches!(
            placed.surface,
            Surface::Revolution { .. } | Surface::Extrusion { .. } | Surface::Nurbs(_)
        );
        let [_, curve] = *edge.pcurves.iter().find(|[surface, _]| wants && placed.ids.contains(surface))?;
        let curve = Self { units: super::units::Units::NONE, ..*self }.curve(curve).ok()?;
        Some(Pcurve { curve, scale: placed.scale })
    }

    fn trim_plane(&self, frame: Frame, bounds: &[Bound], paths: Vec<Path>, size: f64) -> Read<Trimmed> {
        if bounds.iter().all(Vec::is_empty) {
            return Err(unbounded());
        }
        let surface = Surface::Plane(frame);
        let domain = Domain::new(&surface);
        let mapper = Mapper { file: self.file, surface: &surface, domain: &domain, size };
        let mut paths = paths.into_iter();
        let mut loops = Vec::new();
        let mut off: f64 = 0.0;
        for bound in bounds.iter().filter(|bound| !bound.is_empty()) {
            let mut edges = TrimLoop::new();
            for path in paths.by_ref().take(bound.len()) {
                let (mapped, gap) = plane::map(&mapper, &frame, &path)?;
                edges.extend(mapped);
                off = off.max(gap);
            }
            let edges = joined(edges, TOLERANCE * size);
            self.file.spend(edges.len())?;
            loops.push(edges);
        }
        Ok(Trimmed::new(surface, loops, off > 1e-3 * size))
    }
}

fn unbounded() -> Flaw {
    Flaw::Unread("faces without bounds on surfaces without ends are not read".into())
}

/// All of a surface that a face without bounds takes.
fn whole(placed: &Placed, domain: &Domain) -> Read<[DVec2; 2]> {
    let Some([from, to]) = placed.window else { return domain.whole.ok_or_else(unbounded) };
    let (mut low, mut high) = (from.min(to), from.max(to));
    for axis in 0..2 {
        let period = domain.periods[axis].unwrap_or(f64::INFINITY);
        if high[axis] - low[axis] > period {
            high[axis] = low[axis] + period;
        }
        if let Some([first, last]) = domain.limits[axis] {
            low[axis] = low[axis].clamp(first, last);
            high[axis] = high[axis].clamp(first, last);
        }
    }
    if low.cmplt(high).all() && low.is_finite() && high.is_finite() {
        Ok([low, high])
    } else {
        Err(unbounded())
    }
}

/// The sides of a rectangle.
fn rectangle([low, high]: [DVec2; 2]) -> TrimLoop {
    closed(&[low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)])
}

/// The sides of a polygon.
fn closed(polygon: &[DVec2]) -> TrimLoop {
    let next = polygon.iter().cycle().skip(1);
    polygon.iter().zip(next).map(|(&from, &to)| TrimEdge::Segment { from, to }).collect()
}

/// Closes gaps: small ones by moving ends of segments, others by segments between.
fn joined(edges: TrimLoop, small: f64) -> TrimLoop {
    let mut edges = edges;
    let count = edges.len();
    let mut joints = vec![None; count];
    for at in 0..count {
        let next = (at + 1) % count;
        let ([_, end], [start, _]) = (edges[at].ends(), edges[next].ends());
        // A whole circle ends where it begins but for rounding.
        if end == start || (at == next && end.distance(start) <= small) {
            continue;
        }
        let is_small = end.distance(start) <= 2.0 * small;
        if let (true, TrimEdge::Segment { to, .. }) = (is_small, &mut edges[at]) {
            *to = start;
        } else if let (true, TrimEdge::Segment { from, .. }) = (is_small, &mut edges[next]) {
            *from = end;
        } else {
            joints[at] = Some(TrimEdge::Segment { from: end, to: start });
        }
    }
    let has_length = |edge: &TrimEdge| !matches!(edge, TrimEdge::Segment { from, to } if from == to);
    edges
        .into_iter()
        .zip(joints)
        .flat_map(|(edge, joint)| [Some(edge), joint])
        .flatten()
        .filter(has_length)
        .collect()
}

/// Strands one after the other, each moved by whole periods to begin where the one before ends. `None` without strands.
fn ring(mapper: &Mapper<'_>, strands: Vec<Strand>) -> Option<Ring> {
    let periods = mapper.domain.periods;
    let small = 2.0 * TOLERANCE * mapper.size;
    let first = strands.first().map(|strand| (strand.points[0], strand.poles[0]))?;
    let mut points: Vec<DVec2> = Vec::new();
    let mut pole_before = None;
    let is_near = |a: DVec2, b: DVec2| {
        let [_, along_u, along_v] = mapper.surface.derivatives(mapper.domain.within(a));
        ((a.x - b.x) * along_u).length() + ((a.y - b.y) * along_v).length() <= small
    };
    // What brings `start` to where the line so far ends.
    let shift = |points: &[DVec2], before: Option<super::poles::Pole>, start: DVec2, pole| -> DVec2 {
        let [.., inner, end] = *points else { return DVec2::ZERO };
        let mut shift = DVec2::ZERO;
        for axis in 0..2 {
            if let Some(period) = periods[axis] {
                shift[axis] = period * ((end[axis] - start[axis]) / period).round();
            }
        }
        let (Some(before), Some(_)) = (before, pole) else { return shift };
        // Along the line that is a pole, the face on its left.
        let around = 1 - before.axis;
        if let Some(period) = periods[around] {
            let is_high = inner[before.axis] < end[before.axis];
            let sign = if (before.axis == 1) != is_high { 1.0 } else { -1.0 };
            let ahead = (sign * (start[around] - end[around])).rem_euclid(period);
            let ahead = if ahead < 1e-6 * period { period } else { ahead };
            shift[around] = end[around] + sign * ahead - start[around];
        }
        shift
    };
    for strand in strands {
        let by = shift(&points, pole_before, strand.points[0], strand.poles[0]);
        let mut rest = strand.points.iter().map(|at| *at + by).peekable();
        if let (Some(end), Some(start)) = (points.last(), rest.peek())
            && (strand.poles[0].is_none() || pole_before.is_none())
            && is_near(*start, *end)
        {
            rest.next();
        }
        points.extend(rest);
        pole_before = strand.poles[1];
    }
    let by = shift(&points, pole_before, first.0, first.1);
    let mut turns = [0; 2];
    let mut end = first.0;
    for axis in 0..2 {
        if let Some(period) = periods[axis] {
            turns[axis] = (by[axis] / period).round() as i32;
            end[axis] += period * f64::from(turns[axis]);
        }
    }
    match points.last_mut() {
        Some(last) if (first.1.is_none() || pole_before.is_none()) && is_near(*last, end) => *last = end,
        _ => points.push(end),
    }
    Some(Ring { points, turns })
}
