//! Edges in the parameter plane of a surface: adaptive sampling of nearest points, or of pcurves.

use super::file::File;
use super::path::Path;
use super::poles::{Domain, Pole};
use super::{Flaw, Read};
use crate::curve::Curve;
use crate::surface::Surface;
use glam::DVec2;

/// Distance of a straight segment in the parameter plane from the edge, measured on the surface, relative to the face's size.
pub(super) const TOLERANCE: f64 = 1e-5;

/// What counts as straight, relative to the tolerance.
const STRAIGHT: f64 = 1e-3;

/// Work of a sample.
const SAMPLE: usize = 40;

/// Work of a point of a spline among samples, and of one on the way to the nearest point.
const EVALUATION: [usize; 2] = [3, 8];

/// Points evaluated on the way to the nearest point of a surface and of a curve, if the way is long.
const DESCENT: [usize; 2] = [50, 250];

/// Work of a long way to the nearest point of a spline, where the edge is off it: by more than this share of the face's size.
const ASTRAY: usize = 10_000;
const OFF: f64 = 1e-3;

/// Segments of an edge besides what its knots need: a circle on a plane takes some four hundred.
const MOST_SEGMENTS: usize = 1 << 11;

/// Halvings of the distance between two samples.
const DEEPEST: usize = 13;

/// Maps edges to parameters.
pub(super) struct Mapper<'a> {
    pub file: &'a File,
    pub surface: &'a Surface,
    pub domain: &'a Domain,
    /// The face's size, metres.
    pub size: f64,
}

/// A pcurve.
pub(super) struct Pcurve {
    pub curve: Curve,
    /// From the file's parameters to those of the surface.
    pub scale: DVec2,
}

/// An edge, or a part of it between poles, in the parameter plane.
pub(super) struct Strand {
    /// Vertices of a polygonal line; on axes of a period it may leave the domain.
    pub points: Vec<DVec2>,
    /// Poles that it begins and ends at.
    pub poles: [Option<Pole>; 2],
}

impl Mapper<'_> {
    /// An edge, cut at poles within it. `pcurve` is used if it agrees with the edge. Also the largest distance of a sample's
    /// parameters from the edge, metres.
    pub fn map(&self, path: &Path, pcurve: Option<&Pcurve>) -> Read<(Vec<Strand>, f64)> {
        let breaks = path.breaks();
        self.file.spend(breaks.len() * (1 + EVALUATION[1] * DESCENT[0] * self.domain.poles.len()))?;
        let pcurve = pcurve.filter(|pcurve| {
            let near = |s: &f64| {
                self.surface.point(self.domain.within(pcurve.at(path, *s))).distance(path.point(*s))
                    <= TOLERANCE * self.size
            };
            breaks.iter().all(near)
        });
        let mut cuts = vec![(0.0, self.pole(path, 0.0))];
        for pole in &self.domain.poles {
            let within = path.nearest(pole.place).into_iter().map(|s| (s, self.pole(path, s)));
            cuts.extend(within.filter(|(_, pole)| pole.is_some()));
        }
        cuts.push((path.end(), self.pole(path, path.end())));
        cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
        cuts.dedup_by(|a, b| a.0 - b.0 < 1e-9);
        let mut strands = Vec::new();
        let mut off: f64 = 0.0;
        for pair in cuts.windows(2) {
            let [(from, first), (to, last)] = [pair[0], pair[1]];
            let mut samples = vec![from];
            samples.extend(breaks.iter().copied().filter(|s| s - from > 1e-9 && to - s > 1e-9));
            samples.push(to);
            let (points, gap) = Sampling { mapper: self, path, pcurve }.strand(&samples, [first, last])?;
            off = off.max(gap);
            strands.push(Strand { points, poles: [first, last] });
        }
        Ok((strands, off))
    }

    fn pole(&self, path: &Path, s: f64) -> Option<Pole> {
        let place = path.point(s);
        self.domain.poles.iter().find(|pole| pole.place.distance(place) <= 1e-6 * self.size).copied()
    }

    /// Distance on the surface, about, of parameters from a segment between others.
    fn distance(&self, at: DVec2, from: DVec2, to: DVec2) -> f64 {
        let [_, along_u, along_v] = self.surface.derivatives(self.domain.within(at));
        let place = |at: DVec2| at.x * along_u + at.y * along_v;
        let (offset, segment) = (place(at - from), place(to - from));
        let length = segment.length_squared();
        let along = if length > 0.0 { (offset.dot(segment) / length).clamp(0.0, 1.0) } else { 0.0 };
        (offset - along * segment).length()
    }

    /// Fewer points: those between are left out that lie on the line.
    fn straightened(&self, points: &[DVec2]) -> Vec<DVec2> {
        let near = STRAIGHT * TOLERANCE * self.size;
        let [first, .., _] = *points else { return points.to_vec() };
        let mut kept = vec![first];
        let mut anchor = 0;
        for end in 2..points.len() {
            let on_line = |at: usize| self.distance(points[at], points[anchor], points[end]) <= near;
            let forward = (points[end] - points[anchor]).dot(points[end] - points[end - 1]) > 0.0;
            if !(forward && (anchor + 1..end).all(on_line)) {
                anchor = end - 1;
                kept.push(points[anchor]);
            }
        }
        kept.push(points[points.len() - 1]);
        if let [a, b] = &mut kept[..] {
            // Along one parameter exactly.
            let [_, along_u, along_v] = self.surface.derivatives(self.domain.within(0.5 * (*a + *b)));
            for (axis, along) in [along_u, along_v].into_iter().enumerate() {
                if (a[axis] - b[axis]).abs() * along.length() <= near {
                    b[axis] = a[axis];
                }
            }
        }
        kept
    }
}

/// Whether the nearest point of a surface is searched for.
fn is_spline(surface: &Surface) -> bool {
    matches!(
        surface,
        Surface::Nurbs(_)
            | Surface::Revolution { profile: Curve::Nurbs(_), .. }
            | Surface::Extrusion { profile: Curve::Nurbs(_), .. }
    )
}

/// Work of finding the nearest point of a surface, without a guess or with one.
fn inversion_work(surface: &Surface, is_guessed: bool) -> usize {
    let [samples, steps] = match surface {
        Surface::Nurbs(_) if is_guessed => [0, DESCENT[0]],
        // A grid over all spans, and four ways from it.
        Surface::Nurbs(nurbs) => {
            let [u, v] = [0, 1].map(|side| nurbs.counts[side].saturating_mul(nurbs.degrees[side] + 1));
            [u.saturating_mul(v), 4 * DESCENT[0]]
        }
        Surface::Revolution { profile: Curve::Nurbs(profile), .. }
        | Surface::Extrusion { profile: Curve::Nurbs(profile), .. } => {
            [profile.poles.len() * (profile.degree + 4), DESCENT[1]]
        }
        _ => [0, 0],
    };
    samples.saturating_mul(EVALUATION[0]).saturating_add(SAMPLE + steps * EVALUATION[1])
}

impl Pcurve {
    /// Parameters at s of the edge.
    fn at(&self, path: &Path, s: f64) -> DVec2 {
        self.scale * self.curve.point(path.at(s).1).truncate()
    }
}

/// One edge on its way.
struct Sampling<'a> {
    mapper: &'a Mapper<'a>,
    path: &'a Path,
    pcurve: Option<&'a Pcurve>,
}

impl Sampling<'_> {
    /// Parameters at s, of a period's turns those nearest to `near`.
    fn at(&self, s: f64, near: Option<DVec2>) -> Read<DVec2> {
        let mut at = match self.pcurve {
            Some(pcurve) => {
                self.mapper.file.spend(SAMPLE)?;
                pcurve.at(self.path, s)
            }
            None => {
                let surface = self.mapper.surface;
                let place = self.path.point(s);
                self.mapper.file.spend(inversion_work(surface, near.is_some()))?;
                let at = surface.invert(place, near);
                let is_near = || surface.point(at).distance(place) <= OFF * self.mapper.size;
                if is_spline(surface) && !is_near() {
                    self.mapper.file.spend(ASTRAY)?;
                }
                at
            }
        };
        if let Some(near) = near {
            for (axis, period) in self.mapper.domain.periods.iter().enumerate() {
                if let Some(period) = period {
                    at[axis] += period * ((near[axis] - at[axis]) / period).round();
                }
            }
        }
        if at.is_finite() {
            Ok(at)
        } else {
            Err(Flaw::Unread("edges cannot be mapped to the surface's parameters".into()))
        }
    }

    /// At a pole: what the parameters come to from s on the way from `inner`.
    fn at_pole(&self, pole: Pole, s: f64, inner: f64, near: Option<DVec2>) -> Read<DVec2> {
        let step = 1e-3 * (inner - s);
        let beyond = self.at(s + 2.0 * step, near)?;
        let mut at = 2.0 * self.at(s + step, Some(beyond))? - beyond;
        at[pole.axis] = pole.value;
        Ok(at)
    }

    /// The polygonal line through samples, refined; and the largest distance from the edge at samples.
    fn strand(&self, samples: &[f64], poles: [Option<Pole>; 2]) -> Read<(Vec<DVec2>, f64)> {
        let last = samples.len() - 1;
        let mut points = Vec::with_capacity(samples.len());
        let mut near = None;
        let mut off: f64 = 0.0;
        for (index, &s) in samples.iter().enumerate() {
            let at = match poles {
                [Some(pole), _] if index == 0 => self.at_pole(pole, s, samples[1], near)?,
                [_, Some(pole)] if index == last => self.at_pole(pole, s, samples[last - 1], near)?,
                _ => self.at(s, near)?,
            };
            off = off
                .max(self.mapper.surface.point(self.mapper.domain.within(at)).distance(self.path.point(s)));
            near = Some(at);
            points.push(at);
        }
        let mut refined = vec![points[0]];
        for index in 0..last {
            let ends = [(samples[index], points[index]), (samples[index + 1], points[index + 1])];
            self.refine(ends, DEEPEST, MOST_SEGMENTS + 16 * samples.len(), &mut refined)?;
        }
        Ok((self.mapper.straightened(&refined), off))
    }

    /// Appends points up to the second end; no more than so many in all.
    fn refine(
        &self,
        [a, b]: [(f64, DVec2); 2],
        depth: usize,
        most: usize,
        points: &mut Vec<DVec2>,
    ) -> Read<()> {
        if points.len() > most {
            return Err(Flaw::Unread("edges have no smooth course on the surface".into()));
        }
        let along = |fraction: f64| self.at(a.0 + fraction * (b.0 - a.0), Some(a.1.lerp(b.1, fraction)));
        let middle = along(0.5)?;
        if depth > 0 {
            let tolerance = TOLERANCE * self.mapper.size;
            let turns_far = self.mapper.domain.periods.iter().enumerate();
            let mut turns_far = turns_far.filter_map(|(axis, period)| Some((axis, (*period)?)));
            let is_far = turns_far.any(|(axis, period)| (b.1[axis] - a.1[axis]).abs() > 0.26 * period);
            let stands_off = |at: DVec2| self.mapper.distance(at, a.1, b.1) > tolerance;
            if is_far || stands_off(middle) || stands_off(along(0.25)?) || stands_off(along(0.75)?) {
                let half = (0.5 * (a.0 + b.0), middle);
                self.refine([a, half], depth - 1, most, points)?;
                return self.refine([half, b], depth - 1, most, points);
            }
        }
        points.push(b.1);
        Ok(())
    }
}
