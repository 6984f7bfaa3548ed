//! Solids of extrusion.

use super::loops::{planar, rectangle, reversed};
use crate::curve::Curve;
use crate::face::Face;
use crate::frame::Frame;
use crate::surface::Surface;
use crate::trim::{TrimEdge, TrimLoop};
use glam::{DVec2, DVec3};

/// The solid between an outline in the frame's plane, with holes, and the same at `depth` along its z; all loops
/// counterclockwise. Faces: the front, at `depth`; the back; the sides in the order of edges, those of the outline first.
/// Sides are planes, cylinders, and extruded ellipses.
pub(super) fn prism(frame: &Frame, outline: &TrimLoop, holes: &[TrimLoop], depth: f64) -> Vec<Face> {
    let loops: Vec<TrimLoop> = std::iter::once(outline).chain(holes).cloned().collect();
    let front = Frame { origin: frame.place(DVec3::Z * depth), ..*frame };
    let back = Face { is_reversed: true, ..planar(*frame, loops.clone()) };
    let mut faces = vec![planar(front, loops), back];
    let inner = holes.iter().flat_map(reversed);
    faces.extend(outline.iter().copied().chain(inner).map(|edge| side(frame, edge, depth)));
    faces
}

/// The face that an edge sweeps; its normal is on the right of the edge.
fn side(frame: &Frame, edge: TrimEdge, depth: f64) -> Face {
    match edge {
        TrimEdge::Segment { from, to } => {
            let x = frame.turn((to - from).extend(0.0)).normalize();
            let plane = Frame { origin: frame.place(from.extend(0.0)), x, y: frame.z, z: x.cross(frame.z) };
            planar(plane, vec![rectangle(DVec2::ZERO, DVec2::new(from.distance(to), depth))])
        }
        TrimEdge::Arc { centre, radii, angles: [a, b] } => {
            let frame = Frame { origin: frame.place(centre.extend(0.0)), ..*frame };
            let surface = if radii.x == radii.y {
                Surface::Cylinder { frame, radius: radii.x }
            } else {
                let profile = Curve::Ellipse { frame, radii: radii.to_array() };
                Surface::Extrusion { profile, along: frame.z }
            };
            let loops = vec![rectangle(DVec2::new(a.min(b), 0.0), DVec2::new(a.max(b), depth))];
            Face { surface, is_reversed: b < a, loops }
        }
    }
}
