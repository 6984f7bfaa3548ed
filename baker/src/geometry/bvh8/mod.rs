//! BVH8: a bounding volume hierarchy with eight children per node, collapsed from obvhs' binary BVH (Wald, Benthin and
//! Boulos 2008, *Getting Rid of Packets*).
//!
//! The boxes of a node's children are stored side by side (structure of arrays) and tested by one slab test of eight
//! [lanes](crate::lanes). Invariant: traversal finds the hits of brute force over the triangles. Boxes keep 32-bit
//! floats; obvhs' compressed wide BVH (CWBVH) misses hits in large scenes.

mod build;
mod reinsertion;
#[cfg(test)]
mod tests;

pub(in crate::geometry) use build::{PaddedBox, build};

use crate::lanes::{F32x8, LANES, LaneKernel, Mask8, dispatch};
use glam::Vec3;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use smallvec::SmallVec;
use std::ops::{ControlFlow, Range};

/// Number of children of a node.
pub(in crate::geometry) const WIDTH: usize = LANES;
/// Flag of a leaf, a child with a range of triangles: bits 28 to 30 are the number of triangles − 1, bits 0 to 27 the
/// first triangle.
pub(in crate::geometry) const LEAF: u32 = 1 << 31;
/// Lowest bit of a leaf's number of triangles.
const COUNT_SHIFT: u32 = 28;
/// Maximum number of triangles of a leaf.
pub(in crate::geometry) const LARGEST_LEAF: u32 = 8;
/// Factor on the limit in box tests: for a slim triangle, the rounding error of a hit's distance exceeds the rounding
/// error of the box's distance.
pub(in crate::geometry) const BEYOND: f32 = 1.0 + 1e-5;
/// Minimum magnitude of a divisor.
pub(in crate::geometry) const SMALL: f32 = 1e-12;
/// Capacity of the traversal stack without heap memory; in tests small enough to overflow often.
const WAITING: usize = if cfg!(test) { 2 * WIDTH } else { 64 };

/// A node.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(in crate::geometry) struct Node {
    /// Low and high sides of the children's boxes, by axis. The box of an absent child is missed by every ray.
    pub sides: [[[f32; WIDTH]; 2]; 3],
    /// Indices of nodes, or leaves with the flag [`LEAF`].
    pub children: [u32; WIDTH],
}

/// Ray, prepared for the slab test of nodes.
#[derive(Debug)]
pub(in crate::geometry) struct SlabRay {
    pub origin: [f32; 3],
    pub inverse: [f32; 3],
    /// By axis: 1 if the ray's direction is negative, so that a box's high side is the near side; otherwise 0.
    pub down: [usize; 3],
}

/// Ray, prepared for the slab test of a node's eight children at once.
pub(in crate::geometry) struct SlabRay8<V> {
    origin: [V; 3],
    inverse: [V; 3],
    down: [usize; 3],
}

/// Slab test of a node's children against a ray.
pub(in crate::geometry) trait SlabTest {
    /// Returns the distances to the children's boxes along the ray, and a bit mask of the children hit before the
    /// limit.
    fn meet(&self, node: &Node, limit: f32) -> ([f32; WIDTH], u32);
}

/// Visitor of the triangles possibly hit by a ray. A closure is a visitor too, but is called, not inlined.
pub(in crate::geometry) trait Visit {
    /// What the visitor has found in the end.
    type Found;

    /// Receives a triangle's index in leaf order and the ray's current limit; returns a new limit or ends the
    /// traversal.
    fn visit(&mut self, place: usize, limit: f32) -> ControlFlow<(), f32>;

    /// Ends the traversal.
    fn found(self) -> Self::Found;
}

impl<F: FnMut(usize, f32) -> ControlFlow<(), f32>> Visit for F {
    type Found = ();

    #[inline(always)]
    fn visit(&mut self, place: usize, limit: f32) -> ControlFlow<(), f32> {
        self(place, limit)
    }

    #[inline(always)]
    fn found(self) {}
}

/// BVH8 over triangles in leaf order, the order returned by [`Self::new`].
#[derive(Clone, Debug, Default)]
pub(in crate::geometry) struct Bvh8 {
    pub nodes: Vec<Node>,
}

impl Bvh8 {
    /// Collapses a binary BVH with at most [`LARGEST_LEAF`] triangles per leaf. Also returns the leaf order of the
    /// triangles: leaves refer to indices in the leaf order.
    pub fn new(binary: &Bvh2) -> (Self, Vec<u32>) {
        let mut order = Vec::with_capacity(binary.primitive_indices.len());
        let mut nodes: Vec<Node> = Vec::new();
        // Nodes to be filled, depth first: nearby nodes are filled, and stored, consecutively.
        let mut waiting: Vec<(usize, &Bvh2Node)> = Vec::new();
        if let Some(root) = binary.nodes.first() {
            nodes.push(Node::EMPTY);
            waiting.push((0, root));
        }
        while let Some((place, node)) = waiting.pop() {
            let children = children(binary, node);
            let first = waiting.len();
            let mut name = |child| {
                let child: &Bvh2Node = child;
                if child.prim_count == 0 {
                    waiting.push((nodes.len(), child));
                    nodes.push(Node::EMPTY);
                    return nodes.len() as u32 - 1;
                }
                let range = child.first_index..child.first_index + child.prim_count;
                let first = order.len() as u32;
                order.extend(range.map(|i| binary.primitive_indices[i as usize]));
                LEAF | (child.prim_count - 1) << COUNT_SHIFT | first
            };
            let names: SmallVec<[u32; WIDTH]> = children.iter().map(|child| name(child)).collect();
            nodes[place] = Node::new(&children, &names);
            waiting[first..].reverse();
        }
        (Self { nodes }, order)
    }

    /// Visits the triangles possibly hit by a ray before `limit`, near boxes first; returns what the visitor
    /// has found.
    #[inline(always)]
    pub fn walk<T: Visit>(&self, origin: Vec3, direction: Vec3, limit: f32, visit: T) -> T::Found {
        if self.nodes.is_empty() {
            return visit.found();
        }
        dispatch(Walk { bvh: self, walker: SlabRay::new(origin, direction), limit, visit })
    }

    /// Traverses the hierarchy from the node `from`; returns the final limit.
    #[inline(always)]
    pub fn walk_by(&self, walker: &impl SlabTest, from: u32, mut limit: f32, visit: &mut impl Visit) -> f32 {
        let nodes = self.nodes.as_slice();
        let mut reach = limit * BEYOND;
        // Traversal stack: a node's nearest child is last. `farther` has the children without room on the stack.
        let (mut waiting, mut count) = ([0; WAITING], 0);
        let mut farther: Vec<u64> = Vec::new();
        let mut next = from;
        loop {
            if next & LEAF == 0 {
                let node = &nodes[next as usize];
                let (near, mut met) = walker.meet(node, reach);
                if met != 0 {
                    let mut take = || {
                        let child = met.trailing_zeros() as usize;
                        met &= met - 1;
                        (entry(node.children[child], near[child]), met != 0)
                    };
                    // The nearest child is next, the other children are pushed.
                    let (mut nearest, mut are_more) = take();
                    if are_more && count + WIDTH > WAITING {
                        count = move_half(&mut waiting, &mut farther, count);
                    }
                    let from = count;
                    while are_more {
                        let another;
                        (another, are_more) = take();
                        // Insertion sort: few children are hit.
                        let waits = another.max(nearest);
                        let mut place = count;
                        while place > from && waiting[place - 1] < waits {
                            waiting[place] = waiting[place - 1];
                            place -= 1;
                        }
                        waiting[place] = waits;
                        count += 1;
                        nearest = another.min(nearest);
                    }
                    next = nearest as u32;
                    continue;
                }
            } else {
                for place in places(next) {
                    match visit.visit(place, limit) {
                        ControlFlow::Continue(nearer) => limit = nearer,
                        ControlFlow::Break(()) => return limit,
                    }
                }
                reach = limit * BEYOND;
            }
            // A box with the near side exactly at the limit must be opened too.
            next = loop {
                let entry = if count > 0 {
                    count -= 1;
                    waiting[count]
                } else {
                    let Some(entry) = farther.pop() else { return limit };
                    entry
                };
                if distance(entry) <= reach {
                    break entry as u32;
                }
            };
        }
    }
}

/// Packs a child and the distance to the child's box, at least 0, into a number that increases with the distance.
#[inline(always)]
pub(in crate::geometry) fn entry(child: u32, near: f32) -> u64 {
    (near.to_bits() as u64) << 32 | child as u64
}

/// Returns the distance to an entry's box.
#[inline(always)]
pub(in crate::geometry) fn distance(entry: u64) -> f32 {
    f32::from_bits((entry >> 32) as u32)
}

/// Makes room by moving the first half of the waiting entries to `farther`; returns the number of remaining entries.
#[cold]
#[inline(never)]
pub(in crate::geometry) fn move_half<T: Copy>(
    waiting: &mut [T],
    farther: &mut Vec<T>,
    count: usize,
) -> usize {
    let half = count / 2;
    farther.extend_from_slice(&waiting[..half]);
    waiting.copy_within(half..count, 0);
    count - half
}

/// Returns the range of a leaf's triangles, in leaf order.
#[inline(always)]
pub(in crate::geometry) fn places(leaf: u32) -> Range<usize> {
    let first = (leaf & ((1 << COUNT_SHIFT) - 1)) as usize;
    first..first + ((leaf & !LEAF) >> COUNT_SHIFT) as usize + 1
}

/// Returns up to eight nodes that make up this node: as long as there is room, the largest inner node is replaced by
/// its two children.
fn children<'a>(binary: &'a Bvh2, node: &'a Bvh2Node) -> SmallVec<[&'a Bvh2Node; WIDTH]> {
    let mut children: SmallVec<[&Bvh2Node; WIDTH]> = SmallVec::from_slice(&[node]);
    while children.len() < WIDTH {
        let inner = children.iter().enumerate().filter(|(_, child)| child.prim_count == 0);
        let Some((largest, _)) = inner.max_by(|a, b| a.1.aabb.half_area().total_cmp(&b.1.aabb.half_area()))
        else {
            break;
        };
        let first = children[largest].first_index as usize;
        children[largest] = &binary.nodes[first];
        children.push(&binary.nodes[first + 1]);
    }
    children
}

impl SlabRay {
    #[inline(always)]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        let inverse = direction.to_array().map(inverse);
        Self { origin: origin.to_array(), inverse, down: inverse.map(|x| (x < 0.0) as usize) }
    }
}

impl<V: F32x8> SlabRay8<V> {
    #[inline(always)]
    pub fn new(walker: &SlabRay) -> Self {
        Self { origin: splat_axes(walker.origin), inverse: splat_axes(walker.inverse), down: walker.down }
    }
}

impl<V: F32x8> SlabTest for SlabRay8<V> {
    #[inline(always)]
    fn meet(&self, node: &Node, limit: f32) -> ([f32; WIDTH], u32) {
        let (mut near, mut far) = (V::splat(0.0), V::splat(limit));
        for axis in 0..3 {
            let (sides, down) = (&node.sides[axis], self.down[axis]);
            let (origin, inverse) = (self.origin[axis], self.inverse[axis]);
            near = ((V::from_array(sides[down]) - origin) * inverse).max(near);
            far = ((V::from_array(sides[1 - down]) - origin) * inverse).min(far);
        }
        (near.to_array(), near.le(far).movemask())
    }
}

#[inline(always)]
fn splat_axes<V: F32x8>([x, y, z]: [f32; 3]) -> [V; 3] {
    [V::splat(x), V::splat(y), V::splat(z)]
}

/// Returns 1/x, never infinite, so that the box test has no 0 · ∞.
#[inline(always)]
fn inverse(x: f32) -> f32 {
    if x.abs() < SMALL { (1.0 / SMALL).copysign(x) } else { 1.0 / x }
}

impl Node {
    const EMPTY: Self =
        Self { sides: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3], children: [0; WIDTH] };

    /// Creates a node of these boxes, with `names` as the children.
    fn new(boxes: &[&Bvh2Node], names: &[u32]) -> Self {
        let mut node = Self::EMPTY;
        for (child, b) in boxes.iter().enumerate() {
            for axis in 0..3 {
                node.sides[axis][0][child] = b.aabb.min[axis];
                node.sides[axis][1][child] = b.aabb.max[axis];
            }
        }
        node.children[..names.len()].copy_from_slice(names);
        node
    }
}

/// Arguments of [`Bvh8::walk`]. The visitor is a part, not a reference: the compiler keeps in registers what the
/// traversal cannot reach otherwise.
struct Walk<'a, T> {
    bvh: &'a Bvh8,
    walker: SlabRay,
    limit: f32,
    visit: T,
}

impl<T: Visit> LaneKernel for Walk<'_, T> {
    type Output = T::Found;

    #[inline(always)]
    fn run<V: F32x8>(self) -> T::Found {
        let Self { bvh, walker, limit, mut visit } = self;
        bvh.walk_by(&SlabRay8::<V>::new(&walker), 0, limit, &mut visit);
        visit.found()
    }
}
