//! The node tree: transforms, lights, cameras.

use super::schema::Node;
use super::source::Source;
use crate::scene::SceneError;
use glam::{DMat4, DQuat, DVec3};
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;

/// A node of the scene with its transform to world space.
pub(super) struct Placed {
    pub index: usize,
    /// The parent's place in the list.
    pub parent: Option<usize>,
    pub world: DMat4,
}

/// All visible nodes of the file's scene, parents before children.
pub(super) fn flatten(source: &Source) -> Result<Vec<Placed>, SceneError> {
    let root = &source.root;
    let roots: Vec<usize> = match root.scenes.get(root.scene.unwrap_or(0)) {
        Some(scene) => scene.nodes.clone(),
        None => {
            let mut is_child = vec![false; root.nodes.len()];
            for &child in root.nodes.iter().flat_map(|n| &n.children) {
                if let Some(slot) = is_child.get_mut(child) {
                    *slot = true;
                }
            }
            (0..root.nodes.len()).filter(|&i| !is_child[i]).collect()
        }
    };
    let mut seen = vec![false; root.nodes.len()];
    let mut out: Vec<Placed> = Vec::new();
    let mut stack: Vec<(usize, Option<usize>)> = roots.into_iter().rev().map(|i| (i, None)).collect();
    while let Some((index, parent)) = stack.pop() {
        let node =
            root.nodes.get(index).ok_or_else(|| source.malformed(format!("there is no node {index}")))?;
        if std::mem::replace(&mut seen[index], true) {
            let problem = format!("node {index} ({:?}) has two parents or is its own ancestor", node.name);
            return Err(source.malformed(problem));
        }
        if !node.extensions.visibility.visible {
            continue;
        }
        let world = parent.map_or(DMat4::IDENTITY, |p: usize| out[p].world) * local_matrix(node);
        if !world.is_finite() {
            return Err(source
                .malformed(format!("node {index} ({:?}) has a transform that is not finite", node.name)));
        }
        let place = Some(out.len());
        stack.extend(node.children.iter().rev().map(|&child| (child, place)));
        out.push(Placed { index, parent, world });
    }
    Ok(out)
}

fn local_matrix(node: &Node) -> DMat4 {
    node.matrix.map_or_else(|| Pose::of(node).matrix(), |m| DMat4::from_cols_array(&m))
}

/// A node's transform in parts; each of them may be animated.
#[derive(Clone, Copy)]
pub(super) struct Pose {
    pub translation: [f64; 3],
    pub rotation: [f64; 4],
    pub scale: [f64; 3],
}

impl Pose {
    /// As the file has it.
    pub fn of(node: &Node) -> Self {
        Self {
            translation: node.translation.unwrap_or([0.0; 3]),
            rotation: node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]),
            scale: node.scale.unwrap_or([1.0; 3]),
        }
    }

    pub fn matrix(&self) -> DMat4 {
        let rotation = DQuat::from_array(self.rotation);
        let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
        DMat4::from_scale_rotation_translation(
            DVec3::from(self.scale),
            rotation,
            DVec3::from(self.translation),
        )
    }
}

/// The node's KHR_lights_punctual light.
pub(super) fn light(source: &Source, node: &Placed) -> Result<Option<Light>, SceneError> {
    let Some(reference) = &source.root.nodes[node.index].extensions.light else {
        return Ok(None);
    };
    let lights = &source.root.extensions.lights.lights;
    let light = lights
        .get(reference.light)
        .ok_or_else(|| source.malformed(format!("there is no light {}", reference.light)))?;
    let (position, direction) = placement(&node.world);
    let (color, intensity) = (light.color, light.intensity);
    let light = match light.kind.as_str() {
        "point" => Light::Point { position, intensity, color },
        "directional" => Light::Directional { direction, intensity, color },
        "spot" => Light::Spot {
            position,
            direction,
            outer_cone_deg: light.spot.outer_cone_angle.to_degrees(),
            inner_cone_deg: Some(light.spot.inner_cone_angle.to_degrees()),
            intensity,
            color,
        },
        other => {
            let problem = format!("light {} is of the unknown type {other:?}", reference.light);
            return Err(source.malformed(problem));
        }
    };
    if light.is_usable() {
        return Ok(Some(light));
    }
    let problem = "has a place, cone or intensity that is not finite, or far too large";
    Err(source.malformed(format!("light {} {problem}", reference.light)))
}

/// Position and direction of a light or camera with this transform.
pub(super) fn placement(world: &DMat4) -> ([f64; 3], [f64; 3]) {
    let direction = (-world.z_axis.truncate()).try_normalize().unwrap_or(DVec3::NEG_Z);
    (world.w_axis.truncate().to_array(), direction.to_array())
}

/// The node's camera. `size` is the scene's diagonal: the point looked at is beside its middle.
/// An orthographic camera becomes a perspective one that sees as much at the scene's middle.
pub(super) fn camera(
    source: &Source,
    node: &Placed,
    origin: [f64; 3],
    size: f64,
) -> Result<Option<Camera>, SceneError> {
    let Some(index) = source.root.nodes[node.index].camera else {
        return Ok(None);
    };
    let camera = source
        .root
        .cameras
        .get(index)
        .ok_or_else(|| source.malformed(format!("there is no camera {index}")))?;
    let position = node.world.w_axis.truncate();
    let forward = (-node.world.z_axis.truncate()).try_normalize().unwrap_or(DVec3::NEG_Z);
    let up = node.world.y_axis.truncate().try_normalize().unwrap_or(DVec3::Y);
    let distance = forward.dot(DVec3::from(origin) - position).max(0.05 * size);
    let yfov = match (&camera.perspective, &camera.orthographic) {
        (Some(perspective), _) => perspective.yfov,
        (None, Some(orthographic)) => 2.0 * (orthographic.ymag.abs() / distance).atan(),
        (None, None) => return Err(source.malformed(format!("camera {index} is of no known type"))),
    };
    let camera = Camera {
        position: position.to_array(),
        target: (position + forward * distance).to_array(),
        up: up.to_array(),
        yfov_deg: yfov.to_degrees().clamp(1.0, 170.0),
    };
    if camera.is_usable() {
        return Ok(Some(camera));
    }
    let problem = "has a place or field of view that is not finite, or far too large";
    Err(source.malformed(format!("camera {index} {problem}")))
}
