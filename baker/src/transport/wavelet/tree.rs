//! Quadtree of a patch: irradiance received and not yet shot, at the levels where it arrived.

use super::basis::{Basis, Coefficients, MOST};
use super::cell::{Cell, descend};
use glam::{DVec2, DVec3, Vec3};
use rebounce_cad::trim::Coverage;
use rebounce_cad::virtual_mesh::VirtualMesh;
use std::num::NonZeroU32;

/// What a shot adds to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Arrival {
    /// Direct light of lamps: reflected, not part of the solution.
    Lamps,
    /// Light of patches that shine, before a reflection.
    Emission,
    /// Reflected light.
    Bounced,
}

/// Irradiance that one shot gives to the square of a patch: as the decoy of Alonso et al. 2001, 5.3, it is
/// apart from what the patch has, also where it shoots to itself.
#[derive(Clone, Debug)]
pub(super) enum ReceivedTree {
    /// On a cell.
    Cell(Box<Coefficients>),
    /// On its quarters.
    Divided(Box<[Self; 4]>),
}

/// A node of the tree.
#[derive(Clone, Copy, Debug)]
struct QuadtreeNode {
    /// The first of its four quarters, which lie side by side.
    children: Option<NonZeroU32>,
    coverage: Coverage,
    /// Real area on the surface per area of the square: the part that is real, times its mean density.
    share: f32,
}

/// A quadtree.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    nodes: Vec<QuadtreeNode>,
    /// Coefficients of a node.
    functions: usize,
    /// By node, those of [`Arrival::Emission`]; empty until some arrives.
    emitted: Vec<Vec3>,
    /// By node, those of [`Arrival::Bounced`].
    bounced: Vec<Vec3>,
    /// By node, irradiance whose reflection has not been shot.
    unshot: Vec<Vec3>,
}

impl Tree {
    pub(super) fn new(functions: usize, mesh: &VirtualMesh) -> Self {
        let mut it = Self {
            nodes: Vec::new(),
            functions,
            emitted: Vec::new(),
            bounced: Vec::new(),
            unshot: Vec::new(),
        };
        it.add(Cell::ROOT, mesh);
        it
    }

    fn add(&mut self, cell: Cell, mesh: &VirtualMesh) {
        let corners = cell.corners();
        let coverage = mesh.coverage(corners);
        let share = match coverage {
            Coverage::Empty => 0.0,
            Coverage::Plain if mesh.is_equal_area() => 1.0,
            Coverage::Plain | Coverage::Boundary => mesh.real_density(corners) as f32,
        };
        self.nodes.push(QuadtreeNode { children: None, coverage, share });
        let count = self.nodes.len() * self.functions;
        self.bounced.resize(count, Vec3::ZERO);
        self.unshot.resize(count, Vec3::ZERO);
        if !self.emitted.is_empty() {
            self.emitted.resize(count, Vec3::ZERO);
        }
    }

    /// Adds what a shot gives; returns the mean over the square of its real part, by area on the surface.
    pub(super) fn merge(
        &mut self,
        received: &ReceivedTree,
        arrival: Arrival,
        mesh: &VirtualMesh,
        basis: &Basis,
    ) -> DVec3 {
        if arrival == Arrival::Emission {
            self.emitted.resize(self.nodes.len() * self.functions, Vec3::ZERO);
        }
        self.merge_node((0, Cell::ROOT), received, arrival, mesh, basis)
    }

    fn merge_node(
        &mut self,
        (node, cell): (usize, Cell),
        received: &ReceivedTree,
        arrival: Arrival,
        mesh: &VirtualMesh,
        basis: &Basis,
    ) -> DVec3 {
        match received {
            ReceivedTree::Cell(coefficients) => {
                let range = node * self.functions..(node + 1) * self.functions;
                for (sum, c) in self.unshot[range.clone()].iter_mut().zip(coefficients.iter()) {
                    *sum += c.as_vec3();
                }
                let sums = match arrival {
                    Arrival::Lamps => None,
                    Arrival::Emission => Some(&mut self.emitted),
                    Arrival::Bounced => Some(&mut self.bounced),
                };
                if let Some(sums) = sums {
                    for (sum, c) in sums[range].iter_mut().zip(coefficients.iter()) {
                        *sum += c.as_vec3();
                    }
                }
                cell.area() * f64::from(self.nodes[node].share) * mean(coefficients, cell, mesh, basis)
            }
            ReceivedTree::Divided(quarters) => {
                let first = self.divide(node, cell, mesh);
                let quarter = |quadrant: usize| (first + quadrant, cell.child(quadrant), &quarters[quadrant]);
                let mut sum = DVec3::ZERO;
                for (child, cell, received) in [0, 1, 2, 3].map(quarter) {
                    sum += self.merge_node((child, cell), received, arrival, mesh, basis);
                }
                sum
            }
        }
    }

    /// The first of the quarters of a node.
    fn divide(&mut self, node: usize, cell: Cell, mesh: &VirtualMesh) -> usize {
        if let Some(first) = self.nodes[node].children {
            return first.get() as usize;
        }
        let first = self.nodes.len();
        for quadrant in 0..4 {
            self.add(cell.child(quadrant), mesh);
        }
        self.nodes[node].children = NonZeroU32::new(first as u32);
        first
    }

    /// Takes what has not been shot: pushed down to the leaves and pulled up again, so that each node has all
    /// of it.
    pub(super) fn take_unshot(&mut self, basis: &Basis) -> UnshotTree {
        let mut coefficients: Vec<Coefficients> =
            self.unshot.chunks_exact(self.functions).map(widened).collect();
        self.unshot.fill(Vec3::ZERO);
        // Quarters lie after their parents.
        for node in 0..self.nodes.len() {
            if let Some(first) = self.children(node) {
                let here = coefficients[node];
                for quadrant in 0..4 {
                    add(&mut coefficients[first + quadrant], &basis.push(&here, quadrant));
                }
            }
        }
        for node in (0..self.nodes.len()).rev() {
            if let Some(first) = self.children(node) {
                let quarters = [0, 1, 2, 3].map(|quadrant| coefficients[first + quadrant]);
                coefficients[node] = basis.pull(&quarters);
            }
        }
        UnshotTree { children: self.nodes.iter().map(|node| node.children).collect(), coefficients }
    }

    fn children(&self, node: usize) -> Option<usize> {
        self.nodes[node].children.map(|first| first.get() as usize)
    }

    /// Adds what nodes have to their quarters, so that leaves have all (UpdateHierarchy of Algorithm 1).
    pub(super) fn push_down(&mut self, basis: &Basis) {
        self.unshot = Vec::new();
        for node in 0..self.nodes.len() {
            let Some(first) = self.children(node) else { continue };
            for sums in [&mut self.emitted, &mut self.bounced] {
                if sums.is_empty() {
                    continue;
                }
                let here = widened(&sums[node * self.functions..][..self.functions]);
                for quadrant in 0..4 {
                    let pushed = basis.push(&here, quadrant);
                    let child = &mut sums[(first + quadrant) * self.functions..][..self.functions];
                    for (sum, c) in child.iter_mut().zip(pushed) {
                        *sum += c.as_vec3();
                    }
                }
            }
        }
    }

    /// Irradiance of patches that shine, and bounced, at a point of the square; after [`Self::push_down`].
    pub(super) fn irradiance(&self, basis: &Basis, st: DVec2) -> [DVec3; 2] {
        let mut local = st.clamp(DVec2::ZERO, DVec2::ONE);
        let mut node = 0;
        while let Some(first) = self.children(node) {
            let (quadrant, within) = descend(local);
            (node, local) = (first + quadrant, within);
        }
        [&self.emitted, &self.bounced].map(|sums| {
            let leaf = sums.get(node * self.functions..(node + 1) * self.functions);
            leaf.map_or(DVec3::ZERO, |leaf| basis.evaluate(&widened(leaf), local))
        })
    }

    /// Level of the smallest cells.
    pub(super) fn depth(&self) -> u32 {
        let mut level = vec![0; self.nodes.len()];
        // Quarters lie after their parents.
        for node in 0..self.nodes.len() {
            if let Some(first) = self.children(node) {
                let below = level[node] + 1;
                level[first..first + 4].fill(below);
            }
        }
        level.into_iter().max().unwrap_or(0)
    }

    /// Leaves that are not empty.
    pub(super) fn leaves(&self) -> usize {
        self.nodes.iter().filter(|node| node.children.is_none() && node.coverage != Coverage::Empty).count()
    }

    /// Numbers of nodes and of coefficients.
    pub(super) fn counts(&self) -> [usize; 2] {
        let coefficients = self.emitted.len() + self.bounced.len() + self.unshot.len();
        [self.nodes.len(), coefficients]
    }

    /// Bytes of memory.
    pub(super) fn bytes(&self) -> usize {
        let [nodes, coefficients] = self.counts();
        nodes * size_of::<QuadtreeNode>() + coefficients * size_of::<Vec3>()
    }
}

/// What a patch shoots: irradiance to be reflected, whole in each node.
pub(super) struct UnshotTree {
    children: Vec<Option<NonZeroU32>>,
    coefficients: Vec<Coefficients>,
}

impl UnshotTree {
    pub(super) fn coefficients(&self, node: usize) -> &Coefficients {
        &self.coefficients[node]
    }

    /// The first of the quarters of a node.
    pub(super) fn children(&self, node: usize) -> Option<usize> {
        self.children[node].map(|first| first.get() as usize)
    }
}

/// Mean over a cell, by area on the surface: quadrature at the Gauss points.
fn mean(coefficients: &Coefficients, cell: Cell, mesh: &VirtualMesh, basis: &Basis) -> DVec3 {
    if mesh.is_equal_area() {
        return coefficients[0];
    }
    let (mut sum, mut whole) = (DVec3::ZERO, 0.0);
    for (at, weight) in (0..basis.order().functions()).map(|index| basis.point(index)) {
        let area = weight * mesh.density(cell.at(at));
        sum += area * basis.evaluate(coefficients, at);
        whole += area;
    }
    if whole > 0.0 { sum / whole } else { coefficients[0] }
}

/// Coefficients with zeros after them.
fn widened(few: &[Vec3]) -> Coefficients {
    let mut all = [DVec3::ZERO; MOST];
    for (wide, c) in all.iter_mut().zip(few) {
        *wide = c.as_dvec3();
    }
    all
}

/// Adds coefficients.
fn add(sums: &mut Coefficients, more: &Coefficients) {
    for (sum, c) in sums.iter_mut().zip(more) {
        *sum += *c;
    }
}
