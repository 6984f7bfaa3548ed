//! Rest pose of meshes: morph targets with default weights (glTF 2.0, 3.7.2.2), then skins (3.7.3.3).

use super::bind::{Bind, each_joint, target_moves};
use super::primitive::PrimitiveReader;
use super::source::Source;
use crate::scene::SceneError;
use glam::{DMat3, DMat4, DVec3};
use gltf::json::accessor::Type;
use gltf::json::mesh::Primitive;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Deformation of a mesh by a node.
#[derive(Debug, Default)]
pub(super) struct Rest {
    /// Weights of the morph targets, in file order; targets beyond the end have weight 0.
    weights: Vec<f64>,
    skin: Option<Skin>,
    /// The parts of the deformation that animations change; `None` for a deformation at rest.
    animated: Option<AnimatedParts>,
}

/// What animations change of a deformation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct AnimatedParts {
    /// Whether they change the weights of morph targets; joints, or nodes above, otherwise.
    pub weights: bool,
}

/// Linear blend skinning.
#[derive(Debug)]
struct Skin {
    /// World from mesh space, by joint: global transform of the joint times inverse bind matrix.
    world_from_mesh: Rc<[DMat4]>,
    /// World from node space, used only for primitives without joints.
    world_from_node: DMat4,
}

impl Rest {
    /// The mesh's default deformation, for nodes without skin or weights.
    pub fn of_mesh(source: &Source, mesh: usize) -> Self {
        let weights = source.root.meshes.get(mesh).and_then(|mesh| mesh.weights.as_deref());
        Self { weights: as_f64(weights.unwrap_or_default()), skin: None, animated: None }
    }

    /// The same, deformed by animations.
    pub fn animated(self, animated: AnimatedParts) -> Self {
        Self { animated: Some(animated), ..self }
    }

    /// Weights of the morph targets, in file order.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Whether animations change the weights of morph targets.
    pub fn has_animated_weights(&self) -> bool {
        self.animated.is_some_and(|animated| animated.weights)
    }

    /// Reads the primitive before its animated deformation; `None` without animation. Morph targets with constant weights are applied.
    ///
    /// # Errors
    /// Morph targets or joints that are missing or of the wrong length.
    pub fn bind(
        &self,
        source: &Source,
        primitive: &Primitive,
        numbers: &PrimitiveReader,
        positions: &[DVec3],
        normals: Option<&[DVec3]>,
    ) -> Result<Option<Bind>, SceneError> {
        let Some(animated) = self.animated else { return Ok(None) };
        let (mut positions, mut normals) = (positions.to_vec(), normals.map(<[DVec3]>::to_vec));
        if !animated.weights {
            self.morph(source, primitive, numbers, &mut positions, normals.as_deref_mut())?;
        }
        let targets = if animated.weights { primitive.targets.as_deref() } else { None };
        Bind::read(source, targets.unwrap_or_default(), numbers, (positions, normals), self.is_skinned())
            .map(Some)
    }

    /// The deformation by a node that has a skin or weights; `None` without both.
    ///
    /// # Errors
    /// Skins, joints or matrices that are missing or not finite.
    pub fn of_node(
        source: &Source,
        node: usize,
        mesh: usize,
        world_from_node: DMat4,
        skins: &mut Skins,
    ) -> Result<Option<Self>, SceneError> {
        let found = &source.root.nodes[node];
        if found.skin.is_none() && found.weights.is_none() {
            return Ok(None);
        }
        let mut rest = Self::of_mesh(source, mesh);
        if let Some(weights) = &found.weights {
            rest.weights = as_f64(weights);
        }
        if let Some(skin) = found.skin {
            rest.skin = Some(Skin { world_from_mesh: skins.joints(source, skin.value())?, world_from_node });
        }
        Ok(Some(rest))
    }

    /// Whether deformed positions are in world space instead of mesh space.
    pub fn is_skinned(&self) -> bool {
        self.skin.is_some()
    }

    /// Deforms a primitive's vertices. Returns true if the deformation turns the triangles inside out.
    ///
    /// # Errors
    /// Morph targets or joints that are missing, of the wrong length, or not finite.
    pub fn apply(
        &self,
        source: &Source,
        primitive: &Primitive,
        numbers: &PrimitiveReader,
        positions: &mut [DVec3],
        normals: Option<&mut [DVec3]>,
    ) -> Result<bool, SceneError> {
        let mut normals = normals;
        self.morph(source, primitive, numbers, positions, normals.as_deref_mut())?;
        let is_mirrored = match &self.skin {
            Some(skin) => skin.apply(source, numbers, positions, normals)?,
            None => false,
        };
        if positions.iter().all(|p| p.is_finite()) {
            return Ok(is_mirrored);
        }
        Err(source.malformed(format!("{} is not finite once it is deformed", numbers.what())))
    }

    fn morph(
        &self,
        source: &Source,
        primitive: &Primitive,
        numbers: &PrimitiveReader,
        positions: &mut [DVec3],
        mut normals: Option<&mut [DVec3]>,
    ) -> Result<(), SceneError> {
        let targets = primitive.targets.as_deref().unwrap_or_default();
        for (t, (target, &weight)) in targets.iter().zip(&self.weights).enumerate() {
            if weight == 0.0 {
                continue;
            }
            let add = |accessor: usize, of: &mut [DVec3], name: &str| {
                let moves = target_moves(source, numbers, accessor, (name, t), of.len())?;
                of.iter_mut().zip(moves).for_each(|(at, by)| *at += weight * by);
                Ok(())
            };
            if let Some(accessor) = target.positions {
                add(accessor.value(), positions, "POSITION")?;
            }
            if let Some((accessor, normals)) = target.normals.zip(normals.as_deref_mut()) {
                add(accessor.value(), normals, "NORMAL")?;
            }
        }
        Ok(())
    }
}

impl Skin {
    fn apply(
        &self,
        source: &Source,
        numbers: &PrimitiveReader,
        positions: &mut [DVec3],
        normals: Option<&mut [DVec3]>,
    ) -> Result<bool, SceneError> {
        let blended = self.blended(source, numbers, positions.len())?;
        for (position, matrix) in positions.iter_mut().zip(&blended) {
            *position = matrix.transform_point3(*position);
        }
        let linear = || blended.iter().map(|matrix| DMat3::from_mat4(*matrix));
        for (normal, linear) in normals.into_iter().flatten().zip(linear()) {
            *normal = (normals_along(linear) * *normal).try_normalize().unwrap_or(DVec3::ZERO);
        }
        // A mirroring matrix flips a triangle; where the corners differ, the majority of the primitive's vertices
        // decides.
        let mirrored = linear().filter(|linear| linear.determinant() < 0.0).count();
        Ok(2 * mirrored > blended.len())
    }

    /// Returns the matrix of each vertex: the weighted mean of joint matrices.
    fn blended(
        &self,
        source: &Source,
        numbers: &PrimitiveReader,
        count: usize,
    ) -> Result<Vec<DMat4>, SceneError> {
        let mut sums = vec![(DMat4::ZERO, 0.0); count];
        let first = each_joint(source, numbers, count, |vertex, joint, weight| {
            let matrix = self.matrix(joint).ok_or_else(|| self.no_joint(source, numbers, joint))?;
            let (sum, total) = sums[vertex];
            sums[vertex] = (sum + matrix * weight, total + weight);
            Ok(())
        })?;
        let Some(first) = first else { return Ok(vec![self.world_from_node; count]) };
        let of_vertex = |((sum, total), joint): ((DMat4, f64), f64)| {
            if total > 0.0 {
                return Ok(sum * (1.0 / total));
            }
            // A vertex without weights follows the first joint.
            self.matrix(joint).ok_or_else(|| self.no_joint(source, numbers, joint))
        };
        sums.into_iter().zip(first).map(of_vertex).collect()
    }

    fn matrix(&self, joint: f64) -> Option<DMat4> {
        self.world_from_mesh.get(joint as usize).copied()
    }

    fn no_joint(&self, source: &Source, numbers: &PrimitiveReader, joint: f64) -> SceneError {
        let count = self.world_from_mesh.len();
        source.malformed(format!("{} has the joint {joint}, but its skin {count}", numbers.what()))
    }
}

/// Matrix for normals: the inverse transpose up to scale, as cofactor matrix times sign of the determinant.
pub(super) fn normals_along(linear: DMat3) -> DMat3 {
    let sign = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
    DMat3::from_cols(
        linear.y_axis.cross(linear.z_axis),
        linear.z_axis.cross(linear.x_axis),
        linear.x_axis.cross(linear.y_axis),
    ) * sign
}

/// Cache of joint matrices: nodes may share a skin, and joints may share ancestors.
#[derive(Default)]
pub(super) struct Skins {
    /// World from mesh space, by skin and joint.
    found: BTreeMap<usize, Rc<[DMat4]>>,
    /// Parent of every node, in any scene.
    parents: Vec<Option<usize>>,
    /// World from node space, by node.
    worlds: BTreeMap<usize, DMat4>,
}

impl Skins {
    fn joints(&mut self, source: &Source, index: usize) -> Result<Rc<[DMat4]>, SceneError> {
        if let Some(found) = self.found.get(&index) {
            return Ok(found.clone());
        }
        let of_joint = |(j, (joint, bind)): (usize, (usize, DMat4))| {
            let matrix = self.world(source, joint)? * bind;
            let problem = || source.malformed(format!("joint {j} of skin {index} is not finite"));
            if matrix.is_finite() { Ok(matrix) } else { Err(problem()) }
        };
        let joints = joints(source, index)?.into_iter().enumerate().map(of_joint);
        let joints: Rc<[DMat4]> = joints.collect::<Result<_, _>>()?;
        self.found.insert(index, joints.clone());
        Ok(joints)
    }

    /// Returns a node's world transform, along the chain of parents.
    fn world(&mut self, source: &Source, joint: usize) -> Result<DMat4, SceneError> {
        if self.parents.is_empty() {
            self.parents = parents(source);
        }
        let what = || format!("joint node {joint}");
        let (chain, at) =
            ancestors(source, &self.parents, joint, what, |node| self.worlds.contains_key(node))?;
        let mut world = at.and_then(|node| self.worlds.get(&node)).copied().unwrap_or(DMat4::IDENTITY);
        for node in chain.into_iter().rev() {
            let transform = source.exact.nodes.get(node);
            let transform = transform.ok_or_else(|| source.malformed(format!("there is no node {node}")))?;
            world *= transform.local();
            self.worlds.insert(node, world);
        }
        Ok(world)
    }
}

/// Joints of a skin: nodes, and their inverse bind matrices.
///
/// # Errors
/// A skin that is missing, or has fewer matrices than joints.
pub(super) fn joints(source: &Source, index: usize) -> Result<Vec<(usize, DMat4)>, SceneError> {
    let skin = source.root.skins.get(index);
    let skin = skin.ok_or_else(|| source.malformed(format!("there is no skin {index}")))?;
    let what = format!("the inverse bind matrices of skin {index}");
    let binds = match skin.inverse_bind_matrices {
        Some(accessor) => Some(source.read::<16>(accessor.value(), Type::Mat4, &what)?),
        None => None,
    };
    if binds.as_ref().is_some_and(|binds| binds.len() < skin.joints.len()) {
        return Err(source.malformed(format!("{what} are fewer than its joints")));
    }
    let bind = |j: usize| binds.as_ref().map_or(DMat4::IDENTITY, |binds| DMat4::from_cols_array(&binds[j]));
    Ok(skin.joints.iter().enumerate().map(|(j, joint)| (joint.value(), bind(j))).collect())
}

/// Returns a node and the nodes above it up to below the first that is known, or up to the top; and the known one.
///
/// # Errors
/// A node that is missing, or its own ancestor; `what` names the first.
pub(super) fn ancestors(
    source: &Source,
    parents: &[Option<usize>],
    node: usize,
    what: impl Fn() -> String,
    is_known: impl Fn(&usize) -> bool,
) -> Result<(Vec<usize>, Option<usize>), SceneError> {
    let mut chain = Vec::new();
    let mut at = Some(node);
    while let Some(node) = at.filter(|node| !is_known(node)) {
        if chain.len() > parents.len() {
            return Err(source.malformed(format!("{} is its own ancestor", what())));
        }
        chain.push(node);
        let parent = parents.get(node);
        at = *parent.ok_or_else(|| source.malformed(format!("there is no node {node}")))?;
    }
    Ok((chain, at))
}

/// Parent of every node, in any scene.
pub(super) fn parents(source: &Source) -> Vec<Option<usize>> {
    let mut parents = vec![None; source.root.nodes.len()];
    for (i, node) in source.root.nodes.iter().enumerate() {
        for child in node.children.iter().flatten() {
            if let Some(parent) = parents.get_mut(child.value()) {
                *parent = Some(i);
            }
        }
    }
    parents
}

fn as_f64(weights: &[f32]) -> Vec<f64> {
    weights.iter().map(|&weight| f64::from(weight)).collect()
}
