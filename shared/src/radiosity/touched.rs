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

/// Consecutive points that share a box: those of a level follow a curve that fills space.
const RUN: usize = 32;

/// Boxes around the supports of a file's points, where the file has them.
#[derive(Clone, Debug, Default)]
pub struct SupportBoxes {
    /// By run of [`RUN`] points, the box of those of the group of the first; points of other groups are in none.
    runs: Vec<[Vec3; 2]>,
}

impl SupportBoxes {
    /// Boxes of a scene's points.
    pub fn new(scene: &BakedScene) -> Self {
        let around = |(run, points): (usize, &[Point])| {
            let first = run * RUN;
            let group = scene.group_of(first);
            let own = (first..).zip(points).filter(|(i, _)| scene.group_of(*i) == group);
            own.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], (_, point)| {
                let Support { centre, half, .. } = Support::new(point);
                [low.min(centre - half), high.max(centre + half)]
            })
        };
        Self { runs: scene.points.chunks(RUN).enumerate().map(around).collect() }
    }

    /// Returns the points whose supports are touched by a surface that stands elsewhere, seen from the point, after a motion
    /// than before it, in either place; ascending.
    pub fn touched(&self, scene: &BakedScene, accelerator: &Accelerator, motions: [&Motions; 2]) -> Vec<u32> {
        if motions[0] == motions[1] {
            return Vec::new();
        }
        let ways = Ways::new(scene.groups.groups.len() as u32 + 1, motions);
        let places = motions.map(|motions| accelerator.places(scene, motions));
        // For each way to move, the models that move otherwise, before and after.
        let others: Vec<[Others<'_>; 2]> = (0..ways.all.len())
            .map(|way| {
                let is_other = |place: &&ModelPlace| ways.part(way, ways.of[place.group as usize]);
                places.each_ref().map(|places| Others::new(places.iter().filter(is_other)))
            })
            .collect();
        let is_touched = |i: usize, way: usize| {
            let [before, after] = motions.map(|motions| Support::new(&scene.moved_point(i, motions)));
            others[way][0].touch(accelerator, &before) || others[way][1].touch(accelerator, &after)
        };
        let mut out = Vec::new();
        for (run, bounds) in self.runs.iter().enumerate() {
            let range = run * RUN..scene.points.len().min((run + 1) * RUN);
            let group = scene.group_of(range.start);
            let way = ways.of[group as usize];
            // The box of a run holds where the file has it.
            let is_far = ways.all[way].iter().all(|motion| !motion.is_moved())
                && others[way].iter().all(|others| !overlap(*bounds, [others.low, others.high]));
            for i in range {
                let own = scene.group_of(i);
                if !(is_far && own == group) && is_touched(i, ways.of[own as usize]) {
                    out.push(i as u32);
                }
            }
        }
        out
    }
}

/// Ways in which groups move: where each is before and after.
struct Ways {
    /// Number of the way of each group.
    of: Vec<usize>,
    all: Vec<[Motion; 2]>,
}

impl Ways {
    fn new(groups: u32, motions: [&Motions; 2]) -> Self {
        let mut all: Vec<[Motion; 2]> = Vec::new();
        let number = |group: u32| {
            let way = motions.map(|motions| motions.of(group));
            all.iter().position(|other| *other == way).unwrap_or_else(|| {
                all.push(way);
                all.len() - 1
            })
        };
        Self { of: (0..groups).map(number).collect(), all }
    }

    /// Whether two ways to move bring surfaces elsewhere, seen from each other.
    fn part(&self, a: usize, b: usize) -> bool {
        let moves = |way: usize| self.all[way][0] != self.all[way][1];
        a != b && (moves(a) || moves(b))
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
