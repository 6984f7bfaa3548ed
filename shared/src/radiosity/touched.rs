//! Points whose supports are touched by surfaces that stand elsewhere, seen from the point, than they did in the bake: their
//! clip planes and direct-light samples are those of other surroundings.

use super::accelerator::{Accelerator, BvhNode, ModelPlace, Triangle};
use crate::baked::BakedScene;
use crate::kernel::SQUASH;
use crate::motion::{Motion, Motions};
use crate::rbn::bulk::Point;
use glam::Vec3;

/// How far the law of clip planes looks, over the support radius.
const REACH: f32 = 1.1;

/// Returns the points whose supports a surface of another motion touches, where the file has both or where `motions` have
/// them; ascending.
pub fn touched(scene: &BakedScene, accelerator: &Accelerator, motions: &Motions) -> Vec<u32> {
    if motions.is_empty() {
        return Vec::new();
    }
    let ways = Ways::new(scene.groups.groups.len() as u32 + 1, motions);
    let places = [Motions::default(), motions.clone()].map(|motions| accelerator.places(scene, &motions));
    // For each way to move, the models that move otherwise, at rest and now.
    let others: Vec<[Others<'_>; 2]> = (0..ways.count)
        .map(|way| {
            places
                .each_ref()
                .map(|places| Others::new(places.iter().filter(|place| ways.of[place.group as usize] != way)))
        })
        .collect();
    let is_touched = |i: &u32| {
        let i = *i as usize;
        let [at_rest, now] = &others[ways.of[scene.group_of(i) as usize]];
        at_rest.touch(accelerator, &Support::new(&scene.points[i]))
            || now.touch(accelerator, &Support::new(&scene.moved_point(i, motions)))
    };
    (0..scene.points.len() as u32).filter(is_touched).collect()
}

/// Motions that differ from each other.
struct Ways {
    /// Number of the motion of each group.
    of: Vec<usize>,
    count: usize,
}

impl Ways {
    fn new(groups: u32, motions: &Motions) -> Self {
        let mut known: Vec<Motion> = Vec::new();
        let number = |group: u32| {
            let motion = motions.of(group);
            known.iter().position(|other| *other == motion).unwrap_or_else(|| {
                known.push(motion);
                known.len() - 1
            })
        };
        let of = (0..groups).map(number).collect();
        Self { of, count: known.len() }
    }
}

/// Where a support is: a flat ellipsoid, in a box.
struct Support {
    centre: Vec3,
    normal: Vec3,
    radius: f32,
    half: Vec3,
}

impl Support {
    fn new(point: &Point) -> Self {
        let (centre, normal, radius) = (point.position(), point.normal(), REACH * point.radius);
        let (thickness, n2) = (radius / (1.0 + SQUASH), normal * normal);
        // Of the flat cylinder around the ellipsoid, along which rays go.
        let flat = (Vec3::ONE - n2).max(Vec3::ZERO).map(f32::sqrt);
        Self { centre, normal, radius, half: radius * flat + thickness * normal.abs() }
    }

    /// Whether a triangle with these corners touches the cylinder: it is near enough, and not all above or below it.
    fn meets(&self, corners: [Vec3; 3]) -> bool {
        let thickness = self.radius / (1.0 + SQUASH);
        let heights = corners.map(|corner| (corner - self.centre).dot(self.normal));
        let (low, high) =
            (heights[0].min(heights[1]).min(heights[2]), heights[0].max(heights[1]).max(heights[2]));
        low <= thickness
            && high >= -thickness
            // The cylinder's rim is farther than its radius by a few hundredths.
            && distance_squared(self.centre, corners) <= self.radius * self.radius * (1.0 + 1.0 / 9.0)
    }
}

/// Models that move otherwise than a point.
struct Others<'a> {
    /// Box around all of them.
    low: Vec3,
    high: Vec3,
    all: Vec<&'a ModelPlace>,
}

impl<'a> Others<'a> {
    fn new(places: impl Iterator<Item = &'a ModelPlace>) -> Self {
        let all: Vec<&ModelPlace> = places.collect();
        let low = all.iter().fold(Vec3::INFINITY, |low, place| low.min(place.bounds[0]));
        let high = all.iter().fold(Vec3::NEG_INFINITY, |high, place| high.max(place.bounds[1]));
        Self { low, high, all }
    }

    fn touch(&self, accelerator: &Accelerator, support: &Support) -> bool {
        let (low, high) = (support.centre - support.half, support.centre + support.half);
        overlap([low, high], [self.low, self.high])
            && self
                .all
                .iter()
                .any(|place| overlap([low, high], place.bounds) && meets_model(accelerator, place, support))
    }
}

fn overlap([low, high]: [Vec3; 2], [other_low, other_high]: [Vec3; 2]) -> bool {
    low.cmple(other_high).all() && high.cmpge(other_low).all()
}

/// Whether a triangle of a model at its place touches a support.
fn meets_model(accelerator: &Accelerator, place: &ModelPlace, support: &Support) -> bool {
    let model_from_local = place.local_from_model.inverse();
    let centre = model_from_local.transform_point3(support.centre);
    let half = Vec3::from(model_from_local.matrix3.abs() * glam::Vec3A::from(support.half));
    let bounds = [centre - half, centre + half];
    let is_met = |triangle: &Triangle| {
        let corner = Vec3::from(triangle.corner);
        let corners = [corner, corner + Vec3::from(triangle.edge1), corner + Vec3::from(triangle.edge2)];
        support.meets(corners.map(|corner| place.local_from_model.transform_point3(corner)))
    };
    let mut stack = vec![place.root];
    while let Some(at) = stack.pop() {
        let BvhNode { children } = &accelerator.nodes[at as usize];
        for child in children {
            let is_absent = child.low[0] > child.high[0];
            if is_absent || !overlap(bounds, [child.low, child.high].map(Vec3::from)) {
                continue;
            }
            if child.count == 0 {
                stack.push(child.first);
            } else if accelerator.triangles[child.first as usize..(child.first + child.count) as usize]
                .iter()
                .any(is_met)
            {
                return true;
            }
        }
    }
    false
}

/// Squared distance of a place from a triangle (Ericson 2005, 5.1.5).
fn distance_squared(place: Vec3, [a, b, c]: [Vec3; 3]) -> f32 {
    let (ab, ac, ap) = (b - a, c - a, place - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return ap.length_squared();
    }
    let bp = place - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return bp.length_squared();
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (ap - ab * (d1 / (d1 - d3))).length_squared();
    }
    let cp = place - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return cp.length_squared();
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (ap - ac * (d2 / (d2 - d6))).length_squared();
    }
    let va = d3 * d6 - d5 * d4;
    let (along_b, along_c) = (d4 - d3, d5 - d6);
    if va <= 0.0 && along_b >= 0.0 && along_c >= 0.0 {
        return (bp - (c - b) * (along_b / (along_b + along_c))).length_squared();
    }
    let normal = ab.cross(ac);
    ap.dot(normal).powi(2) / normal.length_squared()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn the_distance_of_a_triangle_is_that_of_its_nearest_place() {
        for i in 0..200 {
            let mut stream = Stream::new(5, i);
            let mut place = || Vec3::new(stream.unit(), stream.unit(), stream.unit()) * 2.0 - 1.0;
            let (from, [a, b, c]) = (place(), [place(), place(), place()]);
            let exact = distance_squared(from, [a, b, c]).sqrt();
            let mut least = f32::MAX;
            for u in 0..=100 {
                for v in 0..=100 - u {
                    let on = a + (b - a) * (u as f32 / 100.0) + (c - a) * (v as f32 / 100.0);
                    least = least.min(on.distance(from));
                }
            }
            assert!(exact <= least + 1e-5 && least <= exact + 0.05, "{exact}, {least}");
        }
    }

    #[test]
    fn a_support_is_met_by_what_stands_in_it_and_not_by_what_is_above_or_beside_it() {
        let point = Point {
            position: [1.0, 0.0, 0.0],
            radius: 0.3,
            normal: crate::octahedral::pack_snorm16(Vec3::Y),
            ..Point::default()
        };
        let support = Support::new(&point);
        let upright =
            |x: f32, y: f32| [Vec3::new(x, y, -1.0), Vec3::new(x, y, 1.0), Vec3::new(x, y + 1.0, 0.0)];
        assert!(support.meets(upright(1.2, 0.0)) && support.meets(upright(1.0, 0.08)));
        assert!(!support.meets(upright(1.4, 0.0)) && !support.meets(upright(1.0, 0.12)));
    }
}
