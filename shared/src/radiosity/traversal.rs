//! Nearest hit of a ray: a traversal of the BVH over the placed models, and of the BVHs of the models that it meets. Twin of
//! `bvh.wgsl`.

use super::accelerator::{Accelerator, BvhNode, Child, PlacedModels, TWO_SIDED, Triangle};
use super::directions::hash;
use glam::{Affine3A, Vec3};

/// Deepest BVH: a stack has so many places, and what would go beyond them is left out.
pub const STACK: usize = 48;
/// Tolerance of the barycentric coordinates, so that no ray passes between neighbouring triangles.
pub const EDGE: f32 = 1e-5;

/// Nearest hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance, scene units.
    pub distance: f32,
    /// Number of the triangle.
    pub triangle: u32,
    /// Number of the placed model.
    pub model: u32,
    /// Unit normal of the triangle on the ray's side, local space.
    pub normal: Vec3,
    /// Whether it is the back of a one-sided surface, which reflects nothing.
    pub is_dark: bool,
}

/// A ray.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin.
    pub origin: Vec3,
    /// Direction; distances are in its lengths.
    pub direction: Vec3,
    /// Seed of what passes through surfaces that let light through.
    pub seed: u32,
}

/// Distance at which a ray enters a box, not over `limit`; infinite where it does not.
#[inline]
fn entered(child: &Child, origin: Vec3, inverse: Vec3, limit: f32) -> f32 {
    let a = (Vec3::from(child.low) - origin) * inverse;
    let b = (Vec3::from(child.high) - origin) * inverse;
    let (near, far) = (a.min(b).max_element().max(0.0), a.max(b).min_element().min(limit));
    // Two rounding errors more than the exact box.
    if near <= far * 1.000_000_4 { near } else { f32::INFINITY }
}

/// Reciprocal of a direction, finite.
#[inline]
pub fn reciprocal(direction: Vec3) -> Vec3 {
    direction.map(|x| 1.0 / if x.abs() < 1e-20 { 1e-20f32.copysign(x) } else { x })
}

/// Walks over the leaves that a ray meets, near ones first; `visit` gets a leaf's primitives and the limit, and returns the
/// new limit.
#[inline]
fn walk(
    nodes: &[BvhNode],
    root: u32,
    ray: &Ray,
    mut limit: f32,
    mut visit: impl FnMut(u32, u32, f32) -> f32,
) {
    let inverse = reciprocal(ray.direction);
    let mut stack = [0u32; STACK];
    let (mut depth, mut at) = (0usize, root);
    loop {
        let [a, b] = &nodes[at as usize].children;
        let [near_a, near_b] = [a, b].map(|child| entered(child, ray.origin, inverse, limit));
        let ordered = if near_a <= near_b { [(a, near_a), (b, near_b)] } else { [(b, near_b), (a, near_a)] };
        let mut next = None;
        for (child, near) in ordered {
            // The limit may have come nearer.
            if near > limit || near == f32::INFINITY {
                continue;
            }
            if child.count > 0 {
                limit = visit(child.first, child.count, limit);
            } else if next.is_none() {
                next = Some(child.first);
            } else if depth < STACK {
                stack[depth] = child.first;
                depth += 1;
            }
        }
        at = match next {
            Some(node) => node,
            None if depth > 0 => {
                depth -= 1;
                stack[depth]
            }
            None => return,
        };
    }
}

/// Distance of a triangle along a ray (Möller and Trumbore 1997); negative without a hit.
#[inline]
fn distance(triangle: &Triangle, origin: Vec3, direction: Vec3) -> f32 {
    let [ab, ac, corner] = [triangle.edge1, triangle.edge2, triangle.corner].map(Vec3::from);
    let from = origin - corner;
    let (p, q) = (direction.cross(ac), from.cross(ab));
    let inverse = 1.0 / ab.dot(p);
    let (u, v) = (from.dot(p) * inverse, direction.dot(q) * inverse);
    if u >= -EDGE && v >= -EDGE && u + v <= 1.0 + EDGE { ac.dot(q) * inverse } else { -1.0 }
}

/// Returns the nearest hit of a ray.
pub fn nearest(accelerator: &Accelerator, placed: &PlacedModels, ray: &Ray) -> Option<Hit> {
    nearest_within(accelerator, placed, ray, f32::MAX)
}

/// Returns the nearest hit of a ray under a distance.
pub fn nearest_within(
    accelerator: &Accelerator,
    placed: &PlacedModels,
    ray: &Ray,
    limit: f32,
) -> Option<Hit> {
    if placed.models.is_empty() {
        return None;
    }
    // Distance, triangle, model.
    let mut best = (limit, u32::MAX, 0);
    walk(&placed.nodes, 0, ray, best.0, |first, count, _| {
        for model in first..first + count {
            let place = &placed.models[model as usize];
            let matrix = place.model_from_local();
            let line = Ray {
                origin: matrix.transform_point3(ray.origin),
                direction: matrix.transform_vector3(ray.direction),
                seed: ray.seed,
            };
            walk(&accelerator.nodes, place.root, &line, best.0, |first, count, _| {
                for number in first..first + count {
                    let triangle = &accelerator.triangles[number as usize];
                    let distance = distance(triangle, line.origin, line.direction);
                    if distance > 0.0 && distance < best.0 && stops(triangle, ray.seed, number) {
                        best = (distance, number, model);
                    }
                }
                best.0
            });
        }
        best.0
    });
    let (distance, triangle, model) = best;
    (triangle != u32::MAX).then(|| {
        let matrix = placed.models[model as usize].model_from_local();
        let (normal, is_dark) = facing(&accelerator.triangles[triangle as usize], &matrix, ray.direction);
        Hit { distance, triangle, model, normal, is_dark }
    })
}

/// Returns the share of light that goes straight from one place to another.
pub fn transmittance(accelerator: &Accelerator, placed: &PlacedModels, from: Vec3, to: Vec3) -> f32 {
    if placed.models.is_empty() {
        return 1.0;
    }
    let ray = Ray { origin: from, direction: to - from, seed: 0 };
    let mut share = 1.0f32;
    // Nothing is entered at a negative limit.
    let limit = |share: f32| if share > 0.0 { 1.0 } else { -1.0 };
    walk(&placed.nodes, 0, &ray, 1.0, |first, count, _| {
        for place in &placed.models[first as usize..(first + count) as usize] {
            let matrix = place.model_from_local();
            let line = Ray {
                origin: matrix.transform_point3(ray.origin),
                direction: matrix.transform_vector3(ray.direction),
                seed: 0,
            };
            walk(&accelerator.nodes, place.root, &line, limit(share), |first, count, _| {
                for triangle in &accelerator.triangles[first as usize..(first + count) as usize] {
                    let distance = distance(triangle, line.origin, line.direction);
                    if distance > 0.0 && distance < 1.0 {
                        share *= triangle.transmittance;
                    }
                }
                limit(share)
            });
        }
        limit(share)
    });
    share
}

/// Whether a triangle stops a ray.
#[inline]
fn stops(triangle: &Triangle, seed: u32, number: u32) -> bool {
    triangle.transmittance <= 0.0
        || (hash(seed ^ hash(number)) >> 8) as f32 * (1.0 / (1u32 << 24) as f32) >= triangle.transmittance
}

/// Unit normal of a triangle on the ray's side, local space, and whether that side reflects nothing.
fn facing(triangle: &Triangle, model_from_local: &Affine3A, direction: Vec3) -> (Vec3, bool) {
    let front = Vec3::from(triangle.edge1).cross(Vec3::from(triangle.edge2));
    // The transposed inverse of the matrix to local space.
    let across = (model_from_local.matrix3.transpose() * front).normalize_or_zero();
    let is_back = across.dot(direction) > 0.0;
    (if is_back { -across } else { across }, is_back && triangle.flags & TWO_SIDED == 0)
}
