//! Which required extensions are fine, and what to do about the others.

use crate::scene::SceneError;

/// Extensions that a file may require: those that are supported, and those that change only how
/// a surface shines, which a Lambertian surface ignores.
const FINE: [&str; 13] = [
    "KHR_animation_pointer",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Refuses the first required extension that is not supported.
pub(super) fn check(file: &str, required: &[String]) -> Result<(), SceneError> {
    let Some(extension) = required.iter().find(|name| !FINE.contains(&name.as_str())) else {
        return Ok(());
    };
    let advice = match extension.as_str() {
        "KHR_draco_mesh_compression" | "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
            "decompress with `gltf-transform copy in.glb out.glb` (npm install -g @gltf-transform/cli)"
        }
        "EXT_texture_webp" | "EXT_texture_avif" => {
            "convert its textures with `gltf-transform png in.glb out.glb` (npm install -g @gltf-transform/cli)"
        }
        "KHR_texture_basisu" | "MSFT_texture_dds" => "export the scene again with PNG or JPEG textures",
        "EXT_mesh_gpu_instancing" => "export the scene again with one node per instance",
        "KHR_materials_pbrSpecularGlossiness" => {
            "convert with `gltf-transform metalrough in.glb out.glb` (npm install -g @gltf-transform/cli)"
        }
        _ => "export the scene again without it",
    };
    Err(SceneError::Extension {
        file: file.to_owned(),
        extension: extension.clone(),
        advice: advice.to_owned(),
    })
}
