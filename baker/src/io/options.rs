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
}

/// Note for an unused albedo for meshes without a material.
#[cfg(any(feature = "gltf", feature = "demo-scenes"))]
pub(super) const UNUSED_ALBEDO: &str = "--albedo changes nothing: all meshes have materials";
