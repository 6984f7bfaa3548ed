//! The rig of a file: the hierarchy of joints, meshes before they are deformed, keyframes.

mod normals;
mod tracks;

use super::mesh::{self, MeshPart};
use super::node::{self, PlacedNode};
use super::notes::Told;
use super::place::origins;
use super::rest::{Rest, ancestors, joints, parents};
use super::source::Source;
use crate::scene::SceneError;
use crate::scene::rig::world;
use glam::{DMat4, DQuat, DVec3};
use normals::bind_normals;
use rebounce_shared::octahedral::pack_rounded;
use rebounce_shared::rbn::rig::{MAX_JOINTS, WHOLE};
use rebounce_shared::rig::{MorphDelta, NodePose, Rig, RigJoint, RigMesh, RigNode, RigVertex};
use std::collections::BTreeMap;

/// A rig that meshes are added to.
pub(super) struct RigBuilder<'a> {
    source: &'a Source<'a>,
    /// Parent of every node of the file.
    parents: Vec<Option<usize>>,
    /// Number of nodes of the file in the rig.
    nodes: BTreeMap<usize, u32>,
    /// Number of the mesh whose weights an animation of a node of the file changes.
    meshes: BTreeMap<usize, u32>,
    rig: Rig,
}

impl<'a> RigBuilder<'a> {
    /// A rig without meshes; the first of its nodes is the world.
    pub fn new(source: &'a Source<'a>) -> Self {
        let mut rig = Rig::default();
        rig.layout.nodes.push(RigNode { parent: None, rest: world(DVec3::ZERO) });
        let (nodes, meshes) = Default::default();
        Self { source, parents: parents(source), nodes, meshes, rig }
    }

    /// Adds the mesh of a node, whose parts have vertices from `first` on.
    ///
    /// # Errors
    /// Too many joints, or nodes that are their own ancestors.
    pub fn add(
        &mut self,
        placed: &PlacedNode,
        rest: &Rest,
        parts: &[MeshPart],
        matrix: &DMat4,
        first: u32,
        told: &mut Told,
    ) -> Result<(), SceneError> {
        let of_node = &self.source.root.nodes[placed.index];
        let index = of_node.mesh.map_or(0, |mesh| mesh.value());
        let mut own = match of_node.skin {
            Some(skin) => self.joints(skin.value(), index)?,
            None => Vec::new(),
        };
        // Parts of a skinned mesh without joints follow the node.
        let follows = |part: &MeshPart| part.bind.as_ref().is_some_and(|bind| bind.influences.is_none());
        let node_joint = own.len() as u32;
        if own.is_empty() || parts.iter().any(follows) {
            let node = self.node(placed.index)?;
            if !own.is_empty() {
                own.push(RigJoint { node, inverse_bind: columns(&DMat4::IDENTITY) });
            }
        }
        if own.len() > MAX_JOINTS {
            let (file, what) = (self.source.file.clone(), "joints of a skin");
            return Err(SceneError::TooLarge { file, what, count: own.len(), limit: MAX_JOINTS });
        }
        let node = match own.first() {
            Some(joint) => joint.node,
            None => self.nodes.get(&placed.index).copied().unwrap_or(0),
        };
        let targets = parts.iter().filter_map(|part| part.bind.as_ref()).map(|bind| bind.targets.len());
        let targets = targets.max().unwrap_or(0);
        let weight = |t: usize| rest.weights().get(t).map_or(0.0, |weight| *weight as f32);
        let (first_vertex, first_delta) = (self.rig.vertices.len() as u32, self.rig.deltas.len() as u32);
        let mut deltas: Vec<Vec<MorphDelta>> = vec![Vec::new(); targets];
        let mut vertex = first;
        let mut crowded = 0;
        for part in parts {
            let Some(bind) = &part.bind else { continue };
            let origins = origins(part, matrix);
            let (normals, of_targets) = bind_normals(part, bind, &origins);
            for (origin, normal) in origins.iter().map(|origin| *origin as usize).zip(normals) {
                let own = bind
                    .influences
                    .as_ref()
                    .map_or([(node_joint, WHOLE), (0, 0), (0, 0), (0, 0)], |i| i[origin]);
                let pack = |part: &dyn Fn((u32, u32)) -> u32| {
                    [part(own[0]) | part(own[1]) << 16, part(own[2]) | part(own[3]) << 16]
                };
                self.rig.vertices.push(RigVertex {
                    vertex,
                    position: bind.positions[origin].as_vec3().to_array(),
                    normal: pack_rounded(normal),
                    joints: pack(&|(joint, _)| joint),
                    weights: pack(&|(_, weight)| weight),
                });
                vertex += 1;
            }
            for (t, deltas) in deltas.iter_mut().enumerate() {
                let position = |i: u32| bind.targets.get(t).map_or(DVec3::ZERO, |moves| moves[i as usize][0]);
                let normal = |k: usize| of_targets.get(t).map_or(DVec3::ZERO, |normals| normals[k]);
                let delta = |(k, i): (usize, &u32)| MorphDelta {
                    position: position(*i).as_vec3().to_array(),
                    normal: normal(k).as_vec3().to_array(),
                };
                deltas.extend(origins.iter().enumerate().map(delta));
            }
            crowded += bind.crowded;
        }
        self.rig.deltas.extend(deltas.concat());
        if crowded > 0 {
            let problem = "more than four joints; the four of greatest weight count";
            told.notes
                .push(format!("{crowded} vertices of {} have {problem}", mesh::name(self.source, index)));
        }
        if rest.has_animated_weights() {
            self.meshes.insert(placed.index, self.rig.layout.meshes.len() as u32);
        }
        self.rig.layout.meshes.push(RigMesh {
            first_vertex,
            vertex_count: vertex - first,
            node,
            joints: own,
            first_delta,
            weights: (0..targets).map(weight).collect(),
        });
        Ok(())
    }

    /// Joints of a skin.
    fn joints(&mut self, skin: usize, mesh: usize) -> Result<Vec<RigJoint>, SceneError> {
        let joints = joints(self.source, skin)?;
        if joints.is_empty() {
            let problem = format!("the skin {skin} of {} has no joints", mesh::name(self.source, mesh));
            return Err(self.source.malformed(problem));
        }
        let joint = |(node, bind): (usize, DMat4)| {
            Ok(RigJoint { node: self.node(node)?, inverse_bind: columns(&bind) })
        };
        joints.into_iter().map(joint).collect()
    }

    /// Number of a node of the file; it and those above it are added if they are new.
    fn node(&mut self, index: usize) -> Result<u32, SceneError> {
        let what = || node::name(self.source, index);
        let (chain, at) =
            ancestors(self.source, &self.parents, index, what, |node| self.nodes.contains_key(node))?;
        let mut number = at.and_then(|node| self.nodes.get(&node)).copied().unwrap_or(0);
        for node in chain.into_iter().rev() {
            let transform = self.source.exact.nodes.get(node);
            let rest = transform.map_or_else(
                || columns_of(&DMat4::IDENTITY),
                |transform| match transform.matrix {
                    Some(matrix) => columns_of(&DMat4::from_cols_array(&matrix)),
                    None => {
                        let pose = transform.pose();
                        let (translation, scale) = (pose.translation, pose.scale);
                        NodePose::Parts { translation, rotation: unit(pose.rotation), scale }
                    }
                },
            );
            let parent = Some(number);
            number = self.rig.layout.nodes.len() as u32;
            self.rig.layout.nodes.push(RigNode { parent, rest });
            self.nodes.insert(node, number);
        }
        Ok(number)
    }

    /// The rig with the keyframes of all animations that move it, and which animations of the file do.
    ///
    /// # Errors
    /// Keys that make no sense.
    pub fn finish(mut self, told: &mut Told) -> Result<(Rig, Vec<bool>), SceneError> {
        if self.rig.is_empty() {
            return Ok((Rig::default(), Vec::new()));
        }
        let mut deform = Vec::new();
        for place in 0..self.source.root.animations.len() {
            let animation = tracks::of_animation(&self, place, told)?;
            deform.push(animation.is_some());
            self.rig.layout.animations.extend(animation);
        }
        match deform.contains(&true) {
            true => Ok((self.rig, deform)),
            false => Ok((Rig::default(), deform)),
        }
    }
}

/// A quaternion of length 1; no turn where it has none.
fn unit(rotation: [f64; 4]) -> [f64; 4] {
    let rotation = DQuat::from_array(rotation);
    if rotation.length_squared() > 0.0 { rotation.normalize().to_array() } else { [0.0, 0.0, 0.0, 1.0] }
}

/// Columns of an affine map.
fn columns(matrix: &DMat4) -> [[f32; 3]; 4] {
    [matrix.x_axis, matrix.y_axis, matrix.z_axis, matrix.w_axis]
        .map(|column| column.truncate().as_vec3().to_array())
}

fn columns_of(matrix: &DMat4) -> NodePose {
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis, matrix.w_axis];
    NodePose::Matrix(columns.map(|column| column.truncate().to_array()))
}
