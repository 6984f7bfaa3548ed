//! Acceleration structures: a BVH for the triangles of each model, and a BVH over the placed models. A motion changes the
//! places alone: the small BVH above is built anew, those of the models stay.
//!
//! obvhs builds (PLOC, Meister and Bittner 2018); the layout is ours: a node has the boxes of both children, so that a
//! traversal reads 64 bytes a step.

use crate::baked::BakedScene;
use crate::motion::{Motion, Motions};
use crate::octahedral::unpack_snorm16;
use crate::rbn::bulk::Instance;
use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::ploc::PlocBuilder;
use std::ops::Range;

/// Inner node: boxes and places of two children. 64 bytes. A child with a `count` is a leaf of so many primitives from
/// `first` on; one without is the node `first`. An absent child has a box that no ray meets.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct BvhNode {
    /// Both children.
    pub children: [Child; 2],
}

/// Child of a node. 32 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Child {
    /// Least corner.
    pub low: [f32; 3],
    /// First primitive of a leaf, or number of a node.
    pub first: u32,
    /// Greatest corner.
    pub high: [f32; 3],
    /// Number of primitives of a leaf; 0 for a node.
    pub count: u32,
}

impl Child {
    /// No child.
    const NONE: Self = Self { low: [1.0; 3], first: 0, high: [-1.0; 3], count: 1 };
}

/// Bit of [`Triangle::flags`]: the back reflects, too.
pub const TWO_SIDED: u32 = 1;

/// Triangle in model space, counterclockwise from the front. 48 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Triangle {
    /// First corner.
    pub corner: [f32; 3],
    /// Reconstruction group.
    pub group: u32,
    /// From the first to the second corner.
    pub edge1: [f32; 3],
    /// [`TWO_SIDED`].
    pub flags: u32,
    /// From the first to the third corner.
    pub edge2: [f32; 3],
    /// Share of rays that pass: the mean transmittance of the material.
    pub transmittance: f32,
}

/// A model at its place. 128 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct PlacedModel {
    /// Rows of the matrix from local space to model space.
    pub model_from_local: [[f32; 4]; 3],
    /// Rows of the matrix from local space to where the file has the model's group, local space.
    pub rest_from_local: [[f32; 4]; 3],
    /// Root of the model's BVH.
    pub root: u32,
    /// Unused.
    pub pad: [u32; 7],
}

impl PlacedModel {
    /// The matrix from local space to model space.
    pub fn model_from_local(&self) -> Affine3A {
        Instance { rows: self.model_from_local }.local_from_model()
    }

    /// The matrix from local space to where the file has the group.
    pub fn rest_from_local(&self) -> Affine3A {
        Instance { rows: self.rest_from_local }.local_from_model()
    }
}

/// A model: its BVH and its places.
#[derive(Clone, Debug)]
struct Model {
    root: u32,
    bounds: Aabb,
    /// Instances of the scene; `None` for triangles that stand in local space.
    instances: Option<Range<usize>>,
    /// Reconstruction group of its triangles; all of them move alike.
    group: u32,
}

/// BVHs of all models of a scene.
#[derive(Clone, Debug, Default)]
pub struct Accelerator {
    /// Nodes of all models' BVHs.
    pub nodes: Vec<BvhNode>,
    /// Triangles, in the order of the leaves.
    pub triangles: Vec<Triangle>,
    models: Vec<Model>,
}

/// A model at a place, for what asks for surfaces around a place.
#[derive(Clone, Copy, Debug)]
pub struct ModelPlace {
    /// Root of the model's BVH.
    pub root: u32,
    /// Reconstruction group of its triangles.
    pub group: u32,
    /// The matrix from model space to local space.
    pub local_from_model: Affine3A,
    /// Its box, local space.
    pub bounds: [Vec3; 2],
}

/// Models at their places, with a BVH over them.
#[derive(Clone, Debug, Default)]
pub struct PlacedModels {
    /// Nodes; the first is the root.
    pub nodes: Vec<BvhNode>,
    /// Models, in the order of the leaves.
    pub models: Vec<PlacedModel>,
}

impl Accelerator {
    /// Builds the BVHs of a scene's models.
    pub fn new(scene: &BakedScene) -> Self {
        let mut out = Self::default();
        let draws = || 0..scene.meta.draws.len();
        let mut add = |some: &[usize], instances: Option<Range<usize>>| {
            let triangles: Vec<Triangle> = some.iter().flat_map(|draw| triangles(scene, *draw)).collect();
            let group = triangles.first().map_or(0, |triangle| triangle.group);
            out.add(&triangles, instances, group);
        };
        let alone: Vec<usize> = draws().filter(|draw| scene.copies_of(*draw).is_empty()).collect();
        add(&alone, None);
        // Draw calls of equal copies are one model.
        let copied: Vec<usize> = draws().filter(|draw| !scene.copies_of(*draw).is_empty()).collect();
        for some in copied.chunk_by(|a, b| scene.copies_of(*a) == scene.copies_of(*b)) {
            add(some, Some(scene.copies_of(some[0])));
        }
        out
    }

    fn add(&mut self, triangles: &[Triangle], instances: Option<Range<usize>>, group: u32) {
        if triangles.is_empty() {
            return;
        }
        let boxes: Vec<Aabb> = triangles.iter().map(bounds).collect();
        let bounds = boxes.iter().fold(Aabb::empty(), |all, one| all.union(one));
        let bvh = build(&boxes, LEAF);
        let root = self.nodes.len() as u32;
        flatten(&bvh, root, self.triangles.len() as u32, &mut self.nodes);
        self.triangles.extend(bvh.primitive_indices.iter().map(|i| triangles[*i as usize]));
        self.models.push(Model { root, bounds, instances, group });
    }

    /// The places of all models of a scene whose groups are where `motions` have them.
    pub fn places(&self, scene: &BakedScene, motions: &Motions) -> Vec<ModelPlace> {
        let mut out = Vec::new();
        for model in &self.models {
            let motion = motions.of(model.group);
            let identity = [Instance::IDENTITY];
            let instances = model.instances.clone().map_or(&identity[..], |range| &scene.instances[range]);
            for instance in instances {
                let local_from_model = motion.local_from_rest * instance.local_from_model();
                let around = moved(&model.bounds, &local_from_model);
                let bounds = [around.min, around.max].map(Vec3::from);
                out.push(ModelPlace { root: model.root, group: model.group, local_from_model, bounds });
            }
        }
        out
    }

    /// Places the models of a scene whose groups are where `motions` have them.
    pub fn placed(&self, scene: &BakedScene, motions: &Motions) -> PlacedModels {
        let places = self.places(scene, motions);
        if places.is_empty() {
            return PlacedModels::default();
        }
        let models: Vec<PlacedModel> = places.iter().map(|at| place(at, &motions.of(at.group))).collect();
        let boxes: Vec<Aabb> =
            places.iter().map(|at| Aabb::new(at.bounds[0].into(), at.bounds[1].into())).collect();
        let bvh = build(&boxes, 1);
        let mut nodes = Vec::new();
        flatten(&bvh, 0, 0, &mut nodes);
        PlacedModels { nodes, models: bvh.primitive_indices.iter().map(|i| models[*i as usize]).collect() }
    }
}

fn place(at: &ModelPlace, motion: &Motion) -> PlacedModel {
    PlacedModel {
        model_from_local: Instance::from(&at.local_from_model.inverse()).rows,
        rest_from_local: Instance::from(&motion.rest_from_local).rows,
        root: at.root,
        pad: [0; 7],
    }
}

/// Triangles of a draw call, degenerate ones left out.
fn triangles(scene: &BakedScene, draw: usize) -> Vec<Triangle> {
    let draw = &scene.meta.draws[draw];
    let material = &scene.meta.materials[draw.material as usize];
    let group = scene.groups.of_material(draw.material);
    let transmittance = scene.groups.transmittance_of(draw.material);
    let flags = if material.double_sided { TWO_SIDED } else { 0 };
    let range = draw.first_index as usize..(draw.first_index + draw.index_count) as usize;
    let triangle = |corners: &[u32; 3]| {
        let vertices = corners.map(|i| &scene.vertices[i as usize]);
        let [a, b, c] = vertices.map(|vertex| Vec3::from(vertex.position));
        let front: Vec3 = vertices.map(|vertex| unpack_snorm16(vertex.normal)).into_iter().sum();
        let (mut edge1, mut edge2) = (b - a, c - a);
        let spanned = edge1.cross(edge2);
        if spanned.dot(front) < 0.0 {
            std::mem::swap(&mut edge1, &mut edge2);
        }
        let [corner, edge1, edge2] = [a, edge1, edge2].map(|v| v.to_array());
        (spanned != Vec3::ZERO).then_some(Triangle { corner, group, edge1, flags, edge2, transmittance })
    };
    scene.indices[range].as_chunks::<3>().0.iter().filter_map(triangle).collect()
}

fn bounds(triangle: &Triangle) -> Aabb {
    let corner = Vec3A::from(triangle.corner);
    let [b, c] = [triangle.edge1, triangle.edge2].map(|edge| corner + Vec3A::from(edge));
    Aabb::new(corner.min(b).min(c), corner.max(b).max(c))
}

/// Box around a box that is transformed.
fn moved(bounds: &Aabb, by: &Affine3A) -> Aabb {
    let (middle, half) = (0.5 * (bounds.min + bounds.max), 0.5 * (bounds.max - bounds.min));
    let (middle, half) = (by.transform_point3a(middle), by.matrix3.abs() * half);
    // For what rounding takes away.
    let half = half + 1e-6 * (half + middle.abs());
    Aabb::new(middle - half, middle + half)
}

/// Greatest number of triangles of a leaf.
const LEAF: u32 = 4;

/// The steps of obvhs' `build_bvh2`, which reads a clock that wasm32 lacks.
fn build(boxes: &[Aabb], leaf: u32) -> Bvh2 {
    let preset = BvhBuildParams::fast_build();
    let mut bvh = PlocBuilder::with_capacity(boxes.len()).build(
        preset.ploc_search_distance,
        boxes,
        (0..boxes.len() as u32).collect(),
        preset.sort_precision,
        preset.search_depth_threshold,
    );
    if leaf > 1 {
        collapse(&mut bvh, leaf, 1.0);
    }
    bvh
}

/// Appends the nodes of a BVH: the root has the number `root`, leaves count primitives from `first` on.
fn flatten(bvh: &Bvh2, root: u32, first: u32, nodes: &mut Vec<BvhNode>) {
    // Inner nodes keep their order.
    let mut numbers = vec![0u32; bvh.nodes.len()];
    let mut next = root;
    for (node, number) in bvh.nodes.iter().zip(&mut numbers) {
        if !node.is_leaf() {
            *number = next;
            next += 1;
        }
    }
    let child = |index: usize| {
        let node = &bvh.nodes[index];
        let (first, count) = match node.is_leaf() {
            true => (first + node.first_index, node.prim_count),
            false => (numbers[index], 0),
        };
        Child {
            low: Vec3::from(node.aabb.min).to_array(),
            first,
            high: Vec3::from(node.aabb.max).to_array(),
            count,
        }
    };
    let Some(top) = bvh.nodes.first() else { return };
    if top.is_leaf() {
        nodes.push(BvhNode { children: [child(0), Child::NONE] });
        return;
    }
    for node in bvh.nodes.iter().filter(|node| !node.is_leaf()) {
        let first = node.first_index as usize;
        nodes.push(BvhNode { children: [child(first), child(first + 1)] });
    }
}
