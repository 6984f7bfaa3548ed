//! Trimming curves in the unit square, as chains of segments.

use super::equal_area::EqualArea;
use crate::surface::Surface;
use crate::trim::{TrimEdge, TrimLoop};
use glam::{DVec2, DVec3};

/// Chords are no farther than this from the curve: part of the extent of the flat domain in x and in y.
const FLAT_ERROR: f64 = 1e-5;
/// The same in space, part of the diagonal of the boundary's box.
const SPACE_ERROR: f64 = 1e-3;
/// Most halvings of an edge.
const DEEPEST: u32 = 10;

/// Points of the trimming curves of a face.
pub(super) struct Chain {
    /// In the flat plane, of each loop.
    pub loops: Vec<Vec<DVec2>>,
    /// How far the chords are from the curve at most: part of the extents in x and y. 0 for polygons on
    /// planes.
    pub deviation: f64,
}

/// The trimming curves of a face in the plane of an equal-area map.
pub(super) fn flattened(surface: &Surface, map: &EqualArea, loops: &[TrimLoop]) -> Chain {
    let ends = || loops.iter().flatten().flat_map(|edge| [0.0, 0.25, 0.5, 0.75].map(|t| edge.at(t)));
    let mut flat_box = [DVec2::INFINITY, DVec2::NEG_INFINITY];
    let mut space_box = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for at in ends() {
        let (flat, point) = (map.flat(at), surface.point(at));
        flat_box = [flat_box[0].min(flat), flat_box[1].max(flat)];
        space_box = [space_box[0].min(point), space_box[1].max(point)];
    }
    let extent = flat_box[1] - flat_box[0];
    let halving = Halving { surface, map, extent, size: space_box[0].distance(space_box[1]) };
    let mut chain = Chain { loops: Vec::new(), deviation: 0.0 };
    for edges in loops {
        let mut points = Vec::new();
        for edge in edges {
            points.push(map.flat(edge.at(0.0)));
            halving.halve(edge, [0.0, 1.0], DEEPEST, &mut points, &mut chain.deviation);
        }
        chain.loops.push(points);
    }
    chain
}

struct Halving<'a> {
    surface: &'a Surface,
    map: &'a EqualArea,
    extent: DVec2,
    size: f64,
}

impl Halving<'_> {
    /// Adds points of an edge between two fractions, and the second.
    fn halve(&self, edge: &TrimEdge, [a, b]: [f64; 2], depth: u32, points: &mut Vec<DVec2>, worst: &mut f64) {
        let fractions = [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| a + t * (b - a));
        let flat = fractions.map(|t| self.map.flat(edge.at(t)));
        let point = fractions.map(|t| self.surface.point(edge.at(t)));
        let [mut in_flat, mut in_space] = [0.0_f64; 2];
        for i in 1..4 {
            let off = ((flat[i] - nearest_on(flat[i], flat[0], flat[4])) / self.extent).abs();
            in_flat = in_flat.max(off.max_element());
            in_space = in_space.max(point[i].distance(nearest_in_space(point[i], point[0], point[4]).0));
        }
        if depth > 0 && (in_flat > FLAT_ERROR || in_space > SPACE_ERROR * self.size) {
            let middle = 0.5 * (a + b);
            self.halve(edge, [a, middle], depth - 1, points, worst);
            self.halve(edge, [middle, b], depth - 1, points, worst);
        } else {
            *worst = worst.max(in_flat);
            points.push(flat[4]);
        }
    }
}

/// The nearest point of a segment.
fn nearest_on(at: DVec2, from: DVec2, to: DVec2) -> DVec2 {
    let along = to - from;
    let length = along.length_squared();
    let t = if length > 0.0 { ((at - from).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    from + t * along
}

/// The nearest point of a segment in space, and where on it, 0 to 1.
fn nearest_in_space(at: DVec3, from: DVec3, to: DVec3) -> (DVec3, f64) {
    let along = to - from;
    let length = along.length_squared();
    let t = if length > 0.0 { ((at - from).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    (from + t * along, t)
}

/// A segment of the boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoundarySegment {
    /// Ends in the unit square.
    pub square: [DVec2; 2],
    /// The same in space.
    pub space: [DVec3; 2],
}

/// The point of a boundary nearest to a point in space: in the unit square, with the direction of its segment
/// there.
pub(super) fn nearest(boundary: &[BoundarySegment], point: DVec3) -> Option<(DVec2, DVec2)> {
    let mut least = f64::INFINITY;
    let mut found = None;
    for segment in boundary {
        let (foot, t) = nearest_in_space(point, segment.space[0], segment.space[1]);
        let distance = foot.distance_squared(point);
        if distance < least {
            least = distance;
            let [from, to] = segment.square;
            found = Some((from.lerp(to, t), to - from));
        }
    }
    found
}
