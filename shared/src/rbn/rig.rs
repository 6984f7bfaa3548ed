//! A [rig](crate::rig): meshes that animations deform. Optional sections; the other sections have the meshes at rest.
//!
//! | section | contents |
//! |---|---|
//! | `RIGL` | [`RigLayout`], bincode 2 standard configuration |
//! | `RIGV` | [`RigVertex`], mesh after mesh |
//! | `RIGM` | [`MorphDelta`]: mesh after mesh, target after target, vertex after vertex |
//! | `RIGP` | [`RigPoint`], by ascending point |

use super::codec::columns::{Columns, Kind};
use super::limits::{LARGEST, MAX_BYTES, all_sane, sane};
use super::rig_layout::{
    MorphDelta, NodePose, Rig, RigAnimation, RigLayout, RigMesh, RigNode, RigPoint, RigTarget, RigTrack,
    RigVertex,
};
use super::{RbnError, small};

/// Greatest number of joints of a mesh: a vertex names them with 16 bits.
pub const MAX_JOINTS: usize = 0xffff;
/// Greatest number of records of morph targets.
pub const MAX_DELTAS: usize = 1 << 25;
/// Sum of the weights of a vertex.
pub const WHOLE: u32 = 0xffff;
/// Greatest difference of a quaternion's squared length from 1, and of a barycentric coordinate from its range.
const ROUNDING: f64 = 1e-3;

impl Columns for RigVertex {
    const KINDS: &'static [Kind] = &[
        Kind::Number,
        Kind::Float,
        Kind::Float,
        Kind::Float,
        Kind::Pair,
        Kind::Pair,
        Kind::Pair,
        Kind::Pair,
        Kind::Pair,
    ];
}

impl Columns for MorphDelta {
    const KINDS: &'static [Kind] = &[Kind::Float; 6];
}

impl Columns for RigPoint {
    const KINDS: &'static [Kind] =
        &[Kind::Number, Kind::Number, Kind::Number, Kind::Number, Kind::Float, Kind::Float];
}

/// Encodes section `RIGL`.
///
/// # Errors
/// [`RbnError::TooLarge`] past [`MAX_BYTES`].
pub fn encode(layout: &RigLayout) -> Result<Vec<u8>, RbnError> {
    let too_large = || {
        format!(
            "joints and keyframes of what animations deform need over {MAX_BYTES} bytes: bake with --still, or shorten \
             the animations"
        )
    };
    small::encode(layout, too_large)
}

/// Decodes section `RIGL`; the caller checks it.
///
/// # Errors
/// [`RbnError::Invalid`].
pub fn decode(bytes: &[u8]) -> Result<RigLayout, RbnError> {
    small::decode("RIGL", bytes)
}

/// Checks a rig of unknown origin, for so many vertices to draw and points.
///
/// # Errors
/// [`RbnError::Invalid`], and [`RbnError::TooLarge`] past [`MAX_DELTAS`].
pub fn check(rig: &Rig, [vertices, points]: [usize; 2]) -> Result<(), RbnError> {
    if *rig == Rig::default() {
        return Ok(());
    }
    if rig.deltas.len() > MAX_DELTAS {
        return Err(RbnError::TooLarge(format!(
            "morph targets move {} vertices; a file holds at most {MAX_DELTAS}: bake with --still",
            rig.deltas.len()
        )));
    }
    let layout = &rig.layout;
    if layout.meshes.is_empty() {
        return Err(RbnError::invalid("RIGL", "there is no mesh"));
    }
    if let Some(node) = layout.nodes.iter().enumerate().position(|(i, node)| !is_node(i, node)) {
        return Err(RbnError::invalid("RIGL", format!("node {node}")));
    }
    if !all_sane(layout.bounds.as_flattened()) {
        return Err(RbnError::invalid("RIGL", "bounds are not finite, or far too large"));
    }
    check_meshes(rig)?;
    for animation in &layout.animations {
        if !is_animation(animation, layout) {
            return Err(RbnError::invalid("RIGL", format!("animation \"{}\"", animation.name)));
        }
    }
    check_vertices(rig, vertices)?;
    if !rig.deltas.iter().all(|delta| all_sane(&delta.position) && all_sane(&delta.normal)) {
        return Err(RbnError::invalid("RIGM", "a number is not finite, or far too large"));
    }
    let is_point = |point: &RigPoint| {
        let [v, w] = point.barycentric.map(f64::from);
        (point.point as usize) < points
            && point.corners.iter().all(|corner| (*corner as usize) < rig.vertices.len())
            && [v, w, 1.0 - v - w].iter().all(|share| *share >= -ROUNDING)
    };
    if !rig.points.iter().all(is_point) {
        return Err(RbnError::invalid("RIGP", "a point or a corner is out of range"));
    }
    if !rig.points.windows(2).all(|pair| pair[0].point < pair[1].point) {
        return Err(RbnError::invalid("RIGP", "the points are out of order"));
    }
    Ok(())
}

/// Whether the numbers of a node are usable, and its parent comes before it.
fn is_node(i: usize, node: &RigNode) -> bool {
    let sane = |numbers: &[f64]| numbers.iter().all(|x| x.abs() < f64::from(LARGEST));
    let is_pose = match &node.rest {
        NodePose::Matrix(columns) => sane(columns.as_flattened()),
        NodePose::Parts { translation, rotation, scale } => {
            let length: f64 = rotation.iter().map(|x| x * x).sum();
            sane(translation) && sane(scale) && (length - 1.0).abs() < ROUNDING
        }
    };
    is_pose && node.parent.is_none_or(|parent| (parent as usize) < i)
}

/// Checks that meshes have nodes, and that vertices and records of morph targets follow each other without a gap.
fn check_meshes(rig: &Rig) -> Result<(), RbnError> {
    let nodes = rig.layout.nodes.len();
    let (mut vertices, mut deltas) = (0u64, 0u64);
    for (i, mesh) in rig.layout.meshes.iter().enumerate() {
        let is_sound = (mesh.node as usize) < nodes
            && mesh.joints.len() <= MAX_JOINTS
            && mesh
                .joints
                .iter()
                .all(|joint| (joint.node as usize) < nodes && all_sane(joint.inverse_bind.as_flattened()))
            && all_sane(&mesh.weights)
            && mesh.vertex_count > 0
            && u64::from(mesh.first_vertex) == vertices
            && u64::from(mesh.first_delta) == deltas;
        if !is_sound {
            return Err(RbnError::invalid("RIGL", format!("mesh {i}")));
        }
        vertices += u64::from(mesh.vertex_count);
        deltas += u64::from(mesh.vertex_count) * mesh.weights.len() as u64;
    }
    if vertices != rig.vertices.len() as u64 {
        return Err(RbnError::invalid("RIGV", "it does not fit the meshes"));
    }
    if deltas != rig.deltas.len() as u64 {
        return Err(RbnError::invalid("RIGM", "it does not fit the morph targets"));
    }
    Ok(())
}

/// Checks places, joints and weights of the vertices, and that each vertex to draw is there once at most.
fn check_vertices(rig: &Rig, count: usize) -> Result<(), RbnError> {
    let mut is_taken = vec![false; count];
    for mesh in &rig.layout.meshes {
        let first = mesh.first_vertex as usize;
        for vertex in &rig.vertices[first..first + mesh.vertex_count as usize] {
            let Some(is_taken) = is_taken.get_mut(vertex.vertex as usize) else {
                return Err(RbnError::invalid("RIGV", "a vertex lies outside section VERT"));
            };
            if std::mem::replace(is_taken, true) {
                return Err(RbnError::invalid("RIGV", format!("vertex {} is there twice", vertex.vertex)));
            }
            if !all_sane(&vertex.position) {
                return Err(RbnError::invalid("RIGV", "a number is not finite, or far too large"));
            }
            if !is_weighted(vertex, mesh) {
                return Err(RbnError::invalid("RIGV", "joints or weights of a vertex"));
            }
        }
    }
    Ok(())
}

/// Whether a vertex has joints of its mesh, with weights that add up; without joints it has the mesh's one matrix.
fn is_weighted(vertex: &RigVertex, mesh: &RigMesh) -> bool {
    let halves = |[a, b]: [u32; 2]| [a & 0xffff, a >> 16, b & 0xffff, b >> 16];
    let weights = halves(vertex.weights);
    let joints = halves(vertex.joints);
    joints.iter().all(|joint| (*joint as usize) < mesh.matrix_count())
        && weights.iter().sum::<u32>() == WHOLE
        && (!mesh.joints.is_empty() || weights[0] == WHOLE)
}

/// Whether an animation can be played.
fn is_animation(animation: &RigAnimation, layout: &RigLayout) -> bool {
    let is_track = |track: &RigTrack| {
        let is_target = match track.target {
            RigTarget::Translation(node) | RigTarget::Rotation(node) | RigTarget::Scale(node) => {
                let node = layout.nodes.get(node as usize);
                node.is_some_and(|node| matches!(node.rest, NodePose::Parts { .. }))
            }
            RigTarget::Weights(mesh) => {
                layout.meshes.get(mesh as usize).is_some_and(|mesh| !mesh.weights.is_empty())
            }
        };
        is_target
            && track.times.first().is_some_and(|first| *first >= 0.0)
            && track.times.last().is_some_and(|last| *last <= animation.duration)
            && track.times.windows(2).all(|pair| pair[0] < pair[1])
            && track.times.len().checked_mul(track.stride(layout)) == Some(track.values.len())
            && all_sane(&track.times)
            && all_sane(&track.values)
    };
    animation.duration >= 0.0 && sane(animation.duration) && animation.tracks.iter().all(is_track)
}
