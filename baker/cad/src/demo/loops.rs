//! Closed curves in the parameter plane, and planar faces.

use crate::face::Face;
use crate::frame::Frame;
use crate::surface::Surface;
use crate::trim::{TrimEdge, TrimLoop};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// A rectangle, counterclockwise.
pub(super) fn rectangle(low: DVec2, high: DVec2) -> TrimLoop {
    polygon(&[low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)])
}

/// A polygon with its corners in this order.
pub(super) fn polygon(corners: &[DVec2]) -> TrimLoop {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(&from, &to)| TrimEdge::Segment { from, to }).collect()
}

/// An ellipse along the axes, counterclockwise.
pub(super) fn ellipse(centre: DVec2, radii: DVec2) -> TrimLoop {
    vec![TrimEdge::Arc { centre, radii, angles: [0.0, TAU] }]
}

/// A circle, counterclockwise.
pub(super) fn circle(centre: DVec2, radius: f64) -> TrimLoop {
    ellipse(centre, DVec2::splat(radius))
}

/// An arched opening, counterclockwise: its sill with this middle, straight sides, and half a circle on them. The height is
/// that of the straight sides.
pub(super) fn arch(sill: DVec2, width: f64, height: f64) -> TrimLoop {
    let half = 0.5 * width;
    let corner = |x: f64, y: f64| sill + DVec2::new(x, y);
    vec![
        TrimEdge::Segment { from: corner(-half, 0.0), to: corner(half, 0.0) },
        TrimEdge::Segment { from: corner(half, 0.0), to: corner(half, height) },
        TrimEdge::Arc { centre: corner(0.0, height), radii: DVec2::splat(half), angles: [0.0, PI] },
        TrimEdge::Segment { from: corner(-half, height), to: corner(-half, 0.0) },
    ]
}

/// The same curve run the other way.
pub(super) fn reversed(edges: &TrimLoop) -> TrimLoop {
    edges.iter().rev().map(TrimEdge::reversed).collect()
}

/// A frame at a point with these two axes at right angles, which need not have unit length.
pub(super) fn frame_of(origin: DVec3, x: DVec3, y: DVec3) -> Frame {
    let x = x.normalize();
    let z = x.cross(y).normalize();
    Frame { origin, x, y: z.cross(x), z }
}

/// A planar face with loops in the coordinates of its frame; its normal is the frame's z.
pub(super) fn planar(frame: Frame, loops: Vec<TrimLoop>) -> Face {
    Face { surface: Surface::Plane(frame), is_reversed: false, loops }
}

/// A rectangle with a corner and two sides; its normal is along x × y.
pub(super) fn quad(corner: [f64; 3], x: [f64; 3], y: [f64; 3]) -> Face {
    let [corner, x, y] = [corner, x, y].map(DVec3::from_array);
    let size = DVec2::new(x.length(), y.length());
    planar(frame_of(corner, x, y), vec![rectangle(DVec2::ZERO, size)])
}
