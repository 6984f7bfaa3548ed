//! A rig at a moment of an animation.

use super::keys::{between_rotations, cubic_hermite};
use super::{NodePose, Rig, RigAnimation, RigInterpolation, RigLayout, RigTarget, RigTrack};
use crate::rbn::bulk::Instance;
use glam::{Affine3A, DAffine3, DMat3, DQuat, DVec3};

/// Matrices and weights of a pose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// Mesh after mesh, one for each joint, or one for a mesh without joints: local space from mesh space.
    pub matrices: Vec<Instance>,
    /// Mesh after mesh, weights of its morph targets.
    pub weights: Vec<f32>,
}

impl Pose {
    /// The pose at rest.
    pub fn rest(rig: &Rig) -> Self {
        Self::of(rig, &RigAnimation::default(), 0.0)
    }

    /// The pose at a time of an animation, seconds. Before the first key and after the last, a value is that of the key (glTF
    /// 2.0, 3.11); what no track moves is at rest.
    pub fn of(rig: &Rig, animation: &RigAnimation, time: f32) -> Self {
        let layout = &rig.layout;
        let mut nodes: Vec<NodePose> = layout.nodes.iter().map(|node| node.rest.clone()).collect();
        let mut weights: Vec<Vec<f32>> = layout.meshes.iter().map(|mesh| mesh.weights.clone()).collect();
        for track in &animation.tracks {
            apply(layout, track, time, &mut nodes, &mut weights);
        }
        let mut world: Vec<DAffine3> = Vec::with_capacity(nodes.len());
        for (node, pose) in layout.nodes.iter().zip(&nodes) {
            let above = node.parent.map_or(DAffine3::IDENTITY, |parent| world[parent as usize]);
            world.push(above * matrix(pose));
        }
        let mut matrices = Vec::with_capacity(layout.matrix_count());
        for mesh in &layout.meshes {
            for joint in &mesh.joints {
                matrices.push(single(&(world[joint.node as usize] * affine(&joint.inverse_bind))));
            }
            if mesh.joints.is_empty() {
                matrices.push(single(&world[mesh.node as usize]));
            }
        }
        Self { matrices, weights: weights.concat() }
    }
}

/// Puts a track's value at a time into what it moves.
fn apply(layout: &RigLayout, track: &RigTrack, time: f32, nodes: &mut [NodePose], weights: &mut [Vec<f32>]) {
    let value = value(layout, track, time);
    match track.target {
        RigTarget::Translation(node) | RigTarget::Rotation(node) | RigTarget::Scale(node) => {
            let Some(NodePose::Parts { translation, rotation, scale }) = nodes.get_mut(node as usize) else {
                return;
            };
            let part: &mut [f64] = match track.target {
                RigTarget::Rotation(_) => rotation,
                RigTarget::Scale(_) => scale,
                _ => translation,
            };
            part.iter_mut().zip(value).for_each(|(to, value)| *to = f64::from(value));
        }
        RigTarget::Weights(mesh) => {
            if let Some(weights) = weights.get_mut(mesh as usize) {
                weights.iter_mut().zip(value).for_each(|(weight, value)| *weight = value);
            }
        }
    }
}

/// Value of a track at a time.
fn value(layout: &RigLayout, track: &RigTrack, time: f32) -> Vec<f32> {
    let (width, stride) = (track.width(layout), track.stride(layout));
    let is_spline = track.interpolation == RigInterpolation::CubicSpline;
    // The part of a key: 0 its in-tangent, 1 its value, 2 its out-tangent; without splines there is the value alone.
    let part = |key: usize, part: usize| -> &[f32] {
        let first = key * stride + if is_spline { part * width } else { 0 };
        track.values.get(first..first + width).unwrap_or_default()
    };
    let next = track.times.partition_point(|key| *key <= time);
    if next == 0 || next == track.times.len() {
        return part(next.saturating_sub(1), 1).to_vec();
    }
    let key = next - 1;
    let step = track.times[next] - track.times[key];
    let s = (time - track.times[key]) / step;
    let (a, b) = (part(key, 1), part(next, 1));
    match track.interpolation {
        RigInterpolation::Step => a.to_vec(),
        RigInterpolation::Linear if matches!(track.target, RigTarget::Rotation(_)) => {
            let quaternion = |x: &[f32]| std::array::from_fn(|i| f64::from(x[i]));
            between_rotations(quaternion(a), quaternion(b), f64::from(s)).map(|x| x as f32).to_vec()
        }
        RigInterpolation::Linear => a.iter().zip(b).map(|(a, b)| a + s * (b - a)).collect(),
        RigInterpolation::CubicSpline => {
            let (leaving, arriving) = (part(key, 2), part(next, 0));
            let [step, s] = [step, s].map(f64::from);
            let at = |c: usize| {
                let [a, leaving, arriving, b] = [a[c], leaving[c], arriving[c], b[c]].map(f64::from);
                cubic_hermite([a, leaving], [arriving, b], step, s) as f32
            };
            (0..width).map(at).collect()
        }
    }
}

fn matrix(pose: &NodePose) -> DAffine3 {
    match pose {
        NodePose::Matrix(columns) => {
            let [x, y, z, at] = columns.map(DVec3::from);
            DAffine3 { matrix3: DMat3::from_cols(x, y, z), translation: at }
        }
        NodePose::Parts { translation, rotation, scale } => {
            let rotation = DQuat::from_array(*rotation);
            let rotation =
                if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
            DAffine3::from_scale_rotation_translation((*scale).into(), rotation, (*translation).into())
        }
    }
}

fn affine(columns: &[[f32; 3]; 4]) -> DAffine3 {
    matrix(&NodePose::Matrix(columns.map(|column| column.map(f64::from))))
}

fn single(matrix: &DAffine3) -> Instance {
    let [x, y, z, at] = matrix.to_cols_array_2d().map(|column| column.map(|x| x as f32));
    Instance::from(&Affine3A::from_cols_array_2d(&[x, y, z, at]))
}
