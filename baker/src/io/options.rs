//! Options for loading a scene.

/// Options for loading a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// Name or number of the glTF scene; the file's default scene when absent.
    pub scene: Option<String>,
    /// Linear RGB albedo of meshes without a material; glTF's default, 1, when absent.
    pub albedo: Option<[f32; 3]>,
    /// Names of nodes: what shines at and below each is a group of its own.
    pub light_groups: Vec<String>,
    /// Nodes and materials that are reconstruction groups.
    pub groups: Vec<GroupOption>,
    /// Whether every node with a mesh may move, and is a reconstruction group.
    pub all_nodes_move: bool,
    /// The moment of an animation that nodes, skins and morph targets are in; at rest when absent.
    pub pose: Option<PoseOption>,
    /// Whether what animations deform stands still, as it does in a pose.
    pub is_still: bool,
}

/// A moment of an animation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PoseOption {
    /// Name or number of the animation; the file's first when absent.
    pub animation: Option<String>,
    /// Seconds; beyond an animation's keys its first or last one holds.
    pub time: f64,
}

/// A reconstruction group: all that is at and below the nodes of this name, or the surfaces of the material.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupOption {
    /// Name of a node or a material.
    pub name: String,
    /// Functions for an area, relative to other surfaces.
    pub density: f32,
}

impl LoadOptions {
    /// Refuses a pose for a file that has no animations.
    ///
    /// # Errors
    /// [`SceneError::NoAnimation`](crate::scene::SceneError::NoAnimation).
    #[cfg(any(feature = "step", feature = "demo-scenes"))]
    pub(super) fn at_rest(&self, file: &str) -> Result<(), crate::scene::SceneError> {
        let Some(pose) = &self.pose else { return Ok(()) };
        Err(crate::scene::SceneError::NoAnimation {
            file: file.to_owned(),
            wanted: pose.animation.clone().unwrap_or_default(),
            advice: NO_ANIMATIONS.to_owned(),
        })
    }
}

/// Advice for a pose of a file without animations.
#[cfg(any(feature = "gltf", feature = "step", feature = "demo-scenes"))]
pub(super) const NO_ANIMATIONS: &str = "it has none: leave out the animation and its time";

/// Note for an unused albedo for meshes without a material.
#[cfg(any(feature = "gltf", feature = "demo-scenes"))]
pub(super) const UNUSED_ALBEDO: &str = "--albedo changes nothing: all meshes have materials";
