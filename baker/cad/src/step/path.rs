//! Edges in space: curves between vertices.

use super::curves::{DEEPEST, Geometry};
use super::file::broken;
use super::{Flaw, Read};
use crate::curve::Curve;
use glam::DVec3;
use std::rc::Rc;

/// Curves run one after the other. Its parameter s is 0 at the beginning and counts the pieces.
#[derive(Clone)]
pub(super) struct Path {
    pieces: Vec<PathSegment>,
}

/// A part of a curve, run from one parameter to the other; the second may be the smaller.
#[derive(Clone)]
pub(super) struct PathSegment {
    pub curve: Rc<Curve>,
    pub from: f64,
    pub to: f64,
}

/// An edge of a file.
pub(super) struct Edge {
    /// From the start vertex to the end vertex.
    pub path: Path,
    /// Its curves in the parameter planes of surfaces: number of the surface, number of the curve.
    pub pcurves: Vec<[u64; 2]>,
}

impl Path {
    /// A straight one.
    pub fn straight(from: DVec3, to: DVec3) -> Self {
        let curve = Rc::new(Curve::Line { origin: from, direction: to - from });
        Self { pieces: vec![PathSegment { curve, from: 0.0, to: 1.0 }] }
    }

    /// One piece.
    pub fn single(piece: PathSegment) -> Self {
        Self { pieces: vec![piece] }
    }

    /// The pieces.
    pub fn pieces(&self) -> &[PathSegment] {
        &self.pieces
    }

    /// The largest s.
    pub fn end(&self) -> f64 {
        self.pieces.len() as f64
    }

    /// The piece and the parameter of its curve at s.
    pub fn at(&self, s: f64) -> (&PathSegment, f64) {
        let piece = (s.max(0.0) as usize).min(self.pieces.len() - 1);
        let PathSegment { from, to, .. } = self.pieces[piece];
        let along = s - piece as f64;
        // Both ends exactly.
        (&self.pieces[piece], if along == 1.0 { to } else { from + along * (to - from) })
    }

    /// The place at s.
    pub fn point(&self, s: f64) -> DVec3 {
        let (piece, t) = self.at(s);
        piece.curve.point(t)
    }

    /// Run the other way.
    pub fn reversed(&self) -> Self {
        let reversed =
            |piece: &PathSegment| PathSegment { curve: piece.curve.clone(), from: piece.to, to: piece.from };
        Self { pieces: self.pieces.iter().rev().map(reversed).collect() }
    }

    /// Values of s, ascending from 0 to the end, between which the curve is smooth and turns little: knots, or eighths.
    pub fn breaks(&self) -> Vec<f64> {
        let mut breaks = vec![0.0];
        for (at, PathSegment { curve, from, to }) in self.pieces.iter().enumerate() {
            let mut own: Vec<f64> = match &**curve {
                Curve::Line { .. } => Vec::new(),
                Curve::Nurbs(nurbs) => nurbs.knots.iter().map(|knot| (knot - from) / (to - from)).collect(),
                _ => Vec::new(),
            };
            if !matches!(**curve, Curve::Line { .. }) {
                own.extend((1..8).map(|eighth| f64::from(eighth) / 8.0));
            }
            own.retain(|along| *along > 1e-9 && *along < 1.0 - 1e-9);
            own.push(1.0);
            own.sort_by(f64::total_cmp);
            own.dedup_by(|a, b| *a - *b < 1e-9);
            breaks.extend(own.iter().map(|along| at as f64 + along));
        }
        breaks
    }

    /// Values of s strictly within the path where it comes nearest to a place, one a piece, and joints.
    pub fn nearest(&self, place: DVec3) -> Vec<f64> {
        let mut found: Vec<f64> = (1..self.pieces.len()).map(|joint| joint as f64).collect();
        for (at, PathSegment { curve, from, to }) in self.pieces.iter().enumerate() {
            let t = curve.invert(place, Some(0.5 * (from + to)));
            let along = (t - from) / (to - from);
            let turn = curve.period().map_or(0.0, |period| period / (to - from));
            for along in [along, along - turn, along + turn] {
                if along > 1e-9 && along < 1.0 - 1e-9 {
                    found.push(at as f64 + along);
                }
            }
        }
        found.sort_by(f64::total_cmp);
        found.dedup();
        found
    }
}

/// Period of a conic.
fn period(curve: &Curve) -> Option<f64> {
    matches!(curve, Curve::Circle { .. } | Curve::Ellipse { .. }).then_some(std::f64::consts::TAU)
}

/// Beginning and end of a B-spline's parameters.
fn domain(curve: &Curve) -> Option<[f64; 2]> {
    if let Curve::Nurbs(nurbs) = curve { Some(nurbs.domain()) } else { None }
}

/// A length that tells what is near on a curve; 0 for unbounded ones.
fn extent(curve: &Curve) -> f64 {
    match curve {
        Curve::Circle { radius, .. } => *radius,
        Curve::Ellipse { radii, .. } => radii[0].max(radii[1]),
        Curve::Nurbs(nurbs) => {
            nurbs.poles.iter().map(|pole| pole.distance(nurbs.poles[0])).fold(0.0, f64::max)
        }
        _ => 0.0,
    }
}

impl Geometry<'_> {
    /// An `edge_curve`. `None` if it has no length.
    pub fn edge(&self, id: u64) -> Read<Option<Edge>> {
        let fields = self.file.expect(id, "EDGE_CURVE")?;
        let [start, end] = [fields.reference(1)?, fields.reference(2)?];
        let curve_id = fields.reference(3)?;
        let same_sense = fields.flag(4);
        let places = [self.vertex(start)?, self.vertex(end)?];
        // In the direction of the curve.
        let [a, b] = if same_sense { places } else { [places[1], places[0]] };
        let pieces = match self.composite(curve_id, 0)? {
            Some(pieces) => Some(fit_composite(id, pieces, a, b)?),
            None => between(Rc::new(self.curve(curve_id)?), a, b, start == end),
        };
        let Some(pieces) = pieces else { return Ok(None) };
        let path = Path { pieces };
        let path = if same_sense { path } else { path.reversed() };
        Ok(Some(Edge { path, pcurves: self.pcurves(curve_id) }))
    }

    /// The place of a vertex.
    pub fn vertex(&self, id: u64) -> Read<DVec3> {
        self.point(self.file.expect(id, "VERTEX_POINT")?.reference(1)?)
    }

    /// Pcurves of a surface curve.
    fn pcurves(&self, id: u64) -> Vec<[u64; 2]> {
        let kinds = ["SURFACE_CURVE", "SEAM_CURVE", "INTERSECTION_CURVE"];
        let Some(fields) = kinds.iter().find_map(|kind| self.file.fields(id, kind)) else {
            return Vec::new();
        };
        let pcurve = |id: u64| {
            let fields = self.file.fields(id, "PCURVE")?;
            let definition =
                self.file.fields(fields.optional_reference(2)?, "DEFINITIONAL_REPRESENTATION")?;
            let [curve] = definition.references(1).ok()?[..] else { return None };
            Some([fields.optional_reference(1)?, curve])
        };
        fields.references(2).unwrap_or_default().into_iter().filter_map(pcurve).collect()
    }

    /// The pieces of a composite curve, or `None` if it is another curve.
    fn composite(&self, id: u64, depth: usize) -> Read<Option<Vec<PathSegment>>> {
        if depth > DEEPEST {
            return Err(Flaw::UnreadAt(id, "curves are nested too deep".into()));
        }
        for kind in ["SURFACE_CURVE", "SEAM_CURVE", "INTERSECTION_CURVE"] {
            if let Some(fields) = self.file.fields(id, kind) {
                return self.composite(fields.reference(1)?, depth + 1);
            }
        }
        let Some(fields) = self.file.fields(id, "COMPOSITE_CURVE") else { return Ok(None) };
        let mut pieces = Vec::new();
        for segment in fields.references(1)? {
            let segment = self.file.expect(segment, "COMPOSITE_CURVE_SEGMENT")?;
            // A segment is no representation item: it has no name.
            let parent = segment.reference(2)?;
            let part = match self.composite(parent, depth + 1)? {
                Some(pieces) => pieces,
                None => self.bounded(parent)?,
            };
            self.file.spend(part.len())?;
            let path = Path { pieces: part };
            pieces.extend(if segment.flag(1) { path } else { path.reversed() }.pieces);
        }
        if pieces.is_empty() { Err(broken(id)) } else { Ok(Some(pieces)) }
    }

    /// A curve with ends of its own.
    fn bounded(&self, id: u64) -> Read<Vec<PathSegment>> {
        let curve = self.curve(id)?;
        let Some(fields) = self.file.fields(id, "TRIMMED_CURVE") else {
            let [from, to] = domain(&curve).ok_or_else(|| broken(id))?;
            return Ok(vec![PathSegment { curve: Rc::new(curve), from, to }]);
        };
        // `curve` has taken the sense of the trimmed curve, and runs from the first place to the second.
        let sign = if fields.flag(4) { 1.0 } else { -1.0 };
        let scale = if period(&curve).is_some() { sign * self.units.angle } else { sign };
        let place = |at: usize| {
            let (references, values) = fields.mixed(at);
            match (references.first(), values.first()) {
                (Some(point), _) => self.point(*point),
                (None, Some(value)) => Ok(curve.point(scale * value)),
                (None, None) => Err(broken(id)),
            }
        };
        let (a, b) = (place(2)?, place(3)?);
        between(Rc::new(curve), a, b, false).ok_or_else(|| broken(id))
    }
}

/// The part of a curve from one place to another in its direction; all of a closed curve if they are the same. `None` if there is
/// no length between.
fn between(curve: Rc<Curve>, a: DVec3, b: DVec3, same_vertex: bool) -> Option<Vec<PathSegment>> {
    let extent = extent(&curve);
    let is_whole = same_vertex || a.distance(b) <= 1e-7 * extent;
    let piece = |from: f64, to: f64| PathSegment { curve: curve.clone(), from, to };
    let from = curve.invert(a, None);
    if let Some(period) = period(&curve) {
        if is_whole {
            return Some(vec![piece(from, from + period)]);
        }
        let ahead = (curve.invert(b, None) - from).rem_euclid(period);
        let ahead = if ahead < 1e-12 { period } else { ahead };
        return Some(vec![piece(from, from + ahead)]);
    }
    let to = curve.invert(b, None);
    let Some([first, last]) = domain(&curve) else {
        return (!same_vertex && from != to).then(|| vec![piece(from, to)]);
    };
    // Ends of the domain where they are as near as any place.
    let settled = |t: f64, place: DVec3, prefer: [f64; 2]| {
        let near = curve.point(t).distance(place) + 1e-7 * extent;
        prefer.into_iter().find(|end| curve.point(*end).distance(place) <= near).unwrap_or(t)
    };
    let (from, to) = (settled(from, a, [first, last]), settled(to, b, [last, first]));
    let is_closed = curve.point(first).distance(curve.point(last)) <= 1e-6 * extent;
    if is_closed && (to < from || (is_whole && to == from)) {
        return Some(vec![piece(from, last), piece(first, to)]);
    }
    (from != to).then(|| vec![piece(from, to)])
}

/// A composite curve run from `a` to `b`, if these are its ends.
fn fit_composite(id: u64, pieces: Vec<PathSegment>, a: DVec3, b: DVec3) -> Read<Vec<PathSegment>> {
    let path = Path { pieces };
    let (start, end) = (path.point(0.0), path.point(path.end()));
    let middle = path.point(0.5 * path.end());
    let near = 1e-4 * (start.distance(middle) + end.distance(middle));
    if start.distance(a) <= near && end.distance(b) <= near {
        Ok(path.pieces)
    } else {
        Err(Flaw::UnreadAt(id, "edges that are parts of composite curves are not read".into()))
    }
}
