//! What a file has of rigs, meshes that deform: a hierarchy of nodes, skins, morph targets, keyframes (glTF 2.0, 3.7.2.2, 3.7.3.3,
//! 3.11). [`rig`](super::rig) reads and writes it, [`crate::rig`] poses it.

use bincode::{Decode, Encode};
use bytemuck::{Pod, Zeroable};

/// The rig of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rig {
    /// Hierarchy, meshes and animations.
    pub layout: RigLayout,
    /// Vertices of the meshes, mesh after mesh.
    pub vertices: Vec<RigVertex>,
    /// Morph targets: of each mesh, target after target, one for each vertex.
    pub deltas: Vec<MorphDelta>,
    /// Points of the basis that ride on the meshes.
    pub points: Vec<RigPoint>,
}

/// What is small of a rig; section `RIGL`.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct RigLayout {
    /// Nodes; parents come before their children.
    pub nodes: Vec<RigNode>,
    /// Meshes that deform.
    pub meshes: Vec<RigMesh>,
    /// Animations that deform them.
    pub animations: Vec<RigAnimation>,
    /// Least and greatest corner of all poses of all animations, local space.
    pub bounds: [[f32; 3]; 2],
}

/// A node of the hierarchy.
#[derive(Clone, Debug, PartialEq, Encode, Decode)]
pub struct RigNode {
    /// Parent; `None` at the top, whose parent is local space.
    pub parent: Option<u32>,
    /// Transform to the parent's space at rest.
    pub rest: NodePose,
}

/// Transform of a node to its parent's space.
#[derive(Clone, Debug, PartialEq, Encode, Decode)]
pub enum NodePose {
    /// Translation, rotation (a unit quaternion x, y, z, w) and scale, applied in the order scale, rotation, translation.
    Parts {
        /// Scene units.
        translation: [f64; 3],
        /// Unit quaternion.
        rotation: [f64; 4],
        /// Factors.
        scale: [f64; 3],
    },
    /// Columns x, y, z and translation of an affine map; no animation moves the node.
    Matrix([[f64; 3]; 4]),
}

/// A mesh that deforms.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct RigMesh {
    /// First of its vertices in [`Rig::vertices`].
    pub first_vertex: u32,
    /// Number of its vertices.
    pub vertex_count: u32,
    /// Node that places the mesh; not used where it has joints.
    pub node: u32,
    /// Joints of its skin; empty for a mesh with morph targets alone.
    pub joints: Vec<RigJoint>,
    /// First of its morph targets' records in [`Rig::deltas`].
    pub first_delta: u32,
    /// Weights of its morph targets at rest, one for each.
    pub weights: Vec<f32>,
}

/// A joint of a skin.
#[derive(Clone, Debug, PartialEq, Encode, Decode)]
pub struct RigJoint {
    /// Its node.
    pub node: u32,
    /// Inverse bind matrix, from mesh space to the joint's: columns x, y, z and translation.
    pub inverse_bind: [[f32; 3]; 4],
}

/// Keyframes of nodes and of weights.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct RigAnimation {
    /// Its glTF name, or empty.
    pub name: String,
    /// Seconds.
    pub duration: f32,
    /// What moves.
    pub tracks: Vec<RigTrack>,
}

/// Keyframes of a node's translation, rotation or scale, or of a mesh's weights.
#[derive(Clone, Debug, PartialEq, Encode, Decode)]
pub struct RigTrack {
    /// What the keys move.
    pub target: RigTarget,
    /// Interpolation between keys.
    pub interpolation: RigInterpolation,
    /// Key times, seconds, strictly ascending; at least one.
    pub times: Vec<f32>,
    /// Values of each key: [`RigTrack::width`] numbers; with splines in-tangents, values and out-tangents of each key (glTF 2.0,
    /// appendix C.5).
    pub values: Vec<f32>,
}

/// What keys move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Encode, Decode)]
pub enum RigTarget {
    /// Translation of a node.
    Translation(u32),
    /// Rotation of a node.
    Rotation(u32),
    /// Scale of a node.
    Scale(u32),
    /// Weights of a mesh's morph targets.
    Weights(u32),
}

/// Interpolation between keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Encode, Decode)]
pub enum RigInterpolation {
    /// A straight line; of rotations the great circle.
    #[default]
    Linear,
    /// The previous key.
    Step,
    /// Cubic Hermite spline.
    CubicSpline,
}

/// A vertex before it is deformed; section `RIGV`. 36 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct RigVertex {
    /// Index in section `VERT`, where the vertex is at rest.
    pub vertex: u32,
    /// Mesh space, scene units.
    pub position: [f32; 3],
    /// Unit normal, mesh space, octahedral snorm16x2.
    pub normal: u32,
    /// Indices of four joints of the mesh, 16 bits each.
    pub joints: [u32; 2],
    /// Their weights, unorm16, which add up to 65535; the first is 65535 where the mesh has no joints.
    pub weights: [u32; 2],
}

/// What a morph target of weight 1 adds to a vertex; section `RIGM`. 24 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct MorphDelta {
    /// Added to the position, mesh space.
    pub position: [f32; 3],
    /// Added to the normal.
    pub normal: [f32; 3],
}

/// A point of the basis on a triangle that deforms; section `RIGP`. 24 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct RigPoint {
    /// Index in section `PNTS`.
    pub point: u32,
    /// Corners of the triangle: indices in [`Rig::vertices`], front faces counterclockwise.
    pub corners: [u32; 3],
    /// Barycentric coordinates of the second and third corner.
    pub barycentric: [f32; 2],
}

impl Rig {
    /// Whether nothing deforms.
    pub fn is_empty(&self) -> bool {
        self.layout.meshes.is_empty()
    }

    /// By index in section `VERT`, of `count` vertices: the index in [`Self::vertices`]; `None` for a vertex that does not deform.
    pub fn numbers(&self, count: usize) -> Vec<Option<u32>> {
        let mut numbers = vec![None; count];
        for (number, vertex) in (0..).zip(&self.vertices) {
            numbers[vertex.vertex as usize] = Some(number);
        }
        numbers
    }
}

impl RigLayout {
    /// Number of matrices of a pose: one for each joint of each mesh, one for a mesh without joints.
    pub fn matrix_count(&self) -> usize {
        self.meshes.iter().map(RigMesh::matrix_count).sum()
    }
}

impl RigMesh {
    /// Number of its matrices in a pose.
    pub fn matrix_count(&self) -> usize {
        self.joints.len().max(1)
    }
}

impl RigTrack {
    /// Numbers of a value.
    pub fn width(&self, layout: &RigLayout) -> usize {
        match self.target {
            RigTarget::Translation(_) | RigTarget::Scale(_) => 3,
            RigTarget::Rotation(_) => 4,
            RigTarget::Weights(mesh) => layout.meshes.get(mesh as usize).map_or(0, |mesh| mesh.weights.len()),
        }
    }

    /// Numbers of a key in [`Self::values`].
    pub fn stride(&self, layout: &RigLayout) -> usize {
        match self.interpolation {
            RigInterpolation::CubicSpline => 3 * self.width(layout),
            _ => self.width(layout),
        }
    }
}
