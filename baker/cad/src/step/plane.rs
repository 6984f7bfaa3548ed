//! Edges of planes: lines, circles and ellipses exactly.

use super::Read;
use super::path::{Path, PathSegment};
use super::project::Mapper;
use crate::curve::Curve;
use crate::frame::Frame;
use crate::surface::Surface;
use crate::trim::TrimEdge;
use glam::DVec2;

/// Sine of the angle at which an axis counts as parallel.
const PARALLEL: f64 = 1e-6;

/// The plane's placement turned so that its axes are those of the first ellipse among the edges: then that is an arc.
pub(super) fn along_ellipse<'a>(frame: Frame, edges: impl Iterator<Item = &'a Path>) -> Frame {
    let ellipse = edges.flat_map(Path::pieces).find_map(|piece| match &*piece.curve {
        Curve::Ellipse { frame: ellipse, .. } if is_parallel(&frame, ellipse) => Some(ellipse.x),
        _ => None,
    });
    ellipse.and_then(|x| Frame::new(frame.origin, frame.z, x)).unwrap_or(frame)
}

fn is_parallel(plane: &Frame, other: &Frame) -> bool {
    plane.z.cross(other.z).length() <= PARALLEL
}

/// An edge in the plane's parameters.
pub(super) fn map(mapper: &Mapper<'_>, plane: &Frame, path: &Path) -> Read<(Vec<TrimEdge>, f64)> {
    let mut edges = Vec::new();
    let mut off: f64 = 0.0;
    for piece in path.pieces() {
        if let Some(arc) = arc(plane, piece) {
            let place = |t: f64| piece.curve.point(t);
            let height = |t: f64| (place(t) - plane.origin).dot(plane.z).abs();
            off = off.max(height(piece.from)).max(height(0.5 * (piece.from + piece.to)));
            edges.push(arc);
            continue;
        }
        let (strands, gap) = mapper.map(&Path::single(piece.clone()), None)?;
        off = off.max(gap);
        edges.extend(strands.iter().flat_map(|strand| segments(&strand.points)));
    }
    Ok((edges, off))
}

/// Segments through points.
pub(super) fn segments(points: &[DVec2]) -> impl Iterator<Item = TrimEdge> {
    points.windows(2).map(|pair| TrimEdge::Segment { from: pair[0], to: pair[1] })
}

/// A circle, or an ellipse along the axes.
fn arc(plane: &Frame, piece: &PathSegment) -> Option<TrimEdge> {
    let (frame, radii) = match &*piece.curve {
        Curve::Circle { frame, radius } => (frame, [*radius; 2]),
        Curve::Ellipse { frame, radii } => (frame, *radii),
        _ => return None,
    };
    if !is_parallel(plane, frame) {
        return None;
    }
    let x = plane.local_direction(frame.x).truncate();
    // Ascending about the plane's axis, or descending.
    let sign = plane.z.dot(frame.z).signum();
    let (radii, phase) = if radii[0] == radii[1] {
        (DVec2::splat(radii[0]), x.to_angle())
    } else if x.y.abs() <= PARALLEL {
        (DVec2::from(radii), if x.x > 0.0 { 0.0 } else { std::f64::consts::PI })
    } else if x.x.abs() <= PARALLEL {
        (DVec2::new(radii[1], radii[0]), std::f64::consts::FRAC_PI_2 * x.y.signum())
    } else {
        return None;
    };
    let angles = [piece.from, piece.to].map(|t| phase + sign * t);
    Some(TrimEdge::Arc { centre: plane.local(frame.origin).truncate(), radii, angles })
}

/// Whether a face on this surface takes the exact way.
pub(super) fn frame(surface: &Surface) -> Option<Frame> {
    if let Surface::Plane(frame) = surface { Some(*frame) } else { None }
}
