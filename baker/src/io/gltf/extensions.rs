//! Supported extensions, ignored extensions, and advice for unsupported extensions.

use super::document::Extensible;
use crate::scene::SceneError;
use gltf::json::Root;
use std::collections::BTreeSet;

/// Extensions that a file may require: supported extensions, and extensions that change only highlights and refraction, which
/// pictures can do without.
const FINE: [&str; 26] = [
    "EXT_lights_area",
    "EXT_lights_image_based",
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// The ignored extensions of `FINE`.
const IGNORED: [&str; 4] = [
    "KHR_materials_anisotropy",
    "KHR_materials_dispersion",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
];

/// Messages about extensions used but not read, grouped by the loss.
pub(super) fn unread(root: &Root) -> Vec<String> {
    let raw = [root.raw()].into_iter().chain(root.scenes.iter().map(Extensible::raw));
    let raw = raw.chain(root.nodes.iter().map(Extensible::raw));
    let raw = raw.chain(root.materials.iter().map(Extensible::raw));
    let raw = raw.flatten().flat_map(|extensions| extensions.keys());
    let used: BTreeSet<&str> = root.extensions_used.iter().chain(raw).map(String::as_str).collect();
    let (ignored, used): (Vec<_>, Vec<_>) = used.into_iter().partition(|name| IGNORED.contains(name));
    let used = used.into_iter().filter(|name| !FINE.contains(name));
    let (lights, others): (Vec<_>, Vec<_>) = used.partition(|name| name.to_lowercase().contains("light"));
    let mut out: Vec<String> = Vec::new();
    for name in lights {
        out.push(format!(
            "{name} is not read, and the light that it gives is missing: lamps are read from KHR_lights_punctual and EXT_lights_area"
        ));
    }
    if !others.is_empty() {
        out.push(format!("{}: not read; what such extensions add or change is missing", others.join(", ")));
    }
    if !ignored.is_empty() {
        out.push(format!(
            "{}: not read; they change how surfaces shine or refract, and not how light bounces",
            ignored.join(", ")
        ));
    }
    out
}

/// Refuses unsupported required extensions, in a single error.
pub(super) fn check(file: &str, required: &[String]) -> Result<(), SceneError> {
    let unknown: Vec<&String> = required.iter().filter(|name| !FINE.contains(&name.as_str())).collect();
    if unknown.is_empty() {
        return Ok(());
    }
    let advice: Vec<String> = unknown.iter().map(|name| format!("{name}: {}", advice(name))).collect();
    Err(SceneError::Extension {
        file: file.to_owned(),
        extensions: unknown.into_iter().cloned().collect(),
        advice: advice.join("; "),
    })
}

/// Advice for a file that requires an unsupported extension.
fn advice(extension: &str) -> &'static str {
    match extension {
        "EXT_texture_avif" => "convert its textures with `npx @gltf-transform/cli png in.glb out.glb`",
        "MSFT_texture_dds" => "export the scene again with PNG or JPEG textures",
        _ => "export the scene again without it",
    }
}
