//! Which required extensions are fine, and what to do about the others.

use crate::scene::SceneError;

/// Extensions that a file may require: those that are supported, and those that change only how
/// a surface shines, which a Lambertian surface ignores.
const FINE: [&str; 24] = [
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

/// Refuses the required extensions that are not supported, all of them in one error.
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

/// What to do about a file that requires an extension.
fn advice(extension: &str) -> &'static str {
    match extension {
        "EXT_texture_avif" => "convert its textures with `npx @gltf-transform/cli png in.glb out.glb`",
        "MSFT_texture_dds" => "export the scene again with PNG or JPEG textures",
        _ => "export the scene again without it",
    }
}
