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
}

/// A reconstruction group: all that is at and below the nodes of this name, or the surfaces of the material.
#[derive(Clone, Debug, PartialEq)]
pub struct GroupOption {
    /// Name of a node or a material.
    pub name: String,
    /// Functions for an area, relative to other surfaces.
    pub density: f32,
}

/// Note for an unused albedo for meshes without a material.
#[cfg(any(feature = "gltf", feature = "demo-scenes"))]
pub(super) const UNUSED_ALBEDO: &str = "--albedo changes nothing: all meshes have materials";
