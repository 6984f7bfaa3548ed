//! Materials of a .glb file: as they are in the scene, or unlit.

use rebounce_shared::rbn::meta::{Alpha, DetailTexture, Material, Texture, Wrap};
use rebounce_shared::rbn::specular::DEFAULT_IOR;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// Greatest share of a texture transform that may be shear, which glTF cannot say.
const SHEAR: f32 = 1e-3;

/// Numbers of glTF's samplers.
const NEAREST: u32 = 9728;
const LINEAR: u32 = 9729;
const MIPMAPS: u32 = 9987;
/// Wrap mode of coordinates outside [0, 1] that keeps the border's colour.
pub(super) const CLAMP: u32 = 33071;

/// Returns the sampler of a scene's texture.
pub(super) fn sampler(texture: &Texture) -> Value {
    let wrap = |wrap: Wrap| match wrap {
        Wrap::Repeat => 10497,
        Wrap::MirroredRepeat => 33648,
        Wrap::ClampToEdge => CLAMP,
    };
    let (least, most) = if texture.linear_filter { (MIPMAPS, LINEAR) } else { (NEAREST, NEAREST) };
    json!({
        "minFilter": least, "magFilter": most, "wrapS": wrap(texture.wrap_u), "wrapT": wrap(texture.wrap_v)
    })
}

/// Returns the sampler of a texture of light: without mip levels, in which charts would run into each other.
pub(super) fn light_sampler() -> Value {
    json!({ "minFilter": LINEAR, "magFilter": LINEAR, "wrapS": CLAMP, "wrapT": CLAMP })
}

/// Returns a material with this base colour that shows it as it is.
pub(super) fn unlit(name: &str, base_color: [f32; 4], texture: Option<Value>, alpha: Alpha) -> Value {
    let mut pbr = json!({ "baseColorFactor": base_color, "metallicFactor": 0.0, "roughnessFactor": 1.0 });
    if let Some(texture) = texture {
        pbr["baseColorTexture"] = texture;
    }
    let mut out = json!({ "pbrMetallicRoughness": pbr, "extensions": { "KHR_materials_unlit": {} } });
    set_alpha(&mut out, alpha);
    set_name(&mut out, name);
    out
}

/// Returns a material as it is, with the `strength` of its emission; `texture` gives the file's number of a texture.
/// Inserts the names of its extensions into `used`.
pub(super) fn original(
    material: &Material,
    strength: [f32; 3],
    mut texture: impl FnMut(u32) -> usize,
    used: &mut BTreeSet<&'static str>,
) -> Value {
    let m = material;
    let base = m.base_color_texture.map(|number| json!({ "index": texture(number) }));
    if m.extras.unlit {
        used.insert("KHR_materials_unlit");
        return unlit(&m.name, m.base_color, base, m.alpha);
    }
    let mut pbr = json!({
        "baseColorFactor": m.base_color, "metallicFactor": m.metallic, "roughnessFactor": m.roughness
    });
    if let Some(base) = base {
        pbr["baseColorTexture"] = base;
    }
    let mut detail = |detail: &DetailTexture| reference(detail, texture(detail.texture), used);
    if let Some(shine) = &m.metallic_roughness_texture {
        pbr["metallicRoughnessTexture"] = detail(shine);
    }
    let mut out = json!({ "pbrMetallicRoughness": pbr });
    if let Some(normal) = &m.normal_texture {
        out["normalTexture"] = detail(normal);
        out["normalTexture"]["scale"] = m.normal_scale.into();
    }
    if let Some(emissive) = &m.emission_texture {
        out["emissiveTexture"] = detail(emissive);
    }
    let mut extensions = json!({});
    if m.extras.transmission > 0.0 {
        let mut value = json!({ "transmissionFactor": m.extras.transmission });
        if let Some(through) = &m.extras.transmission_texture {
            value["transmissionTexture"] = detail(through);
        }
        extensions["KHR_materials_transmission"] = value;
    }
    if m.extras.scattered > 0.0 {
        extensions["KHR_materials_diffuse_transmission"] = json!({
            "diffuseTransmissionFactor": m.extras.scattered,
            "diffuseTransmissionColorFactor": m.extras.scattered_color,
        });
    }
    let specular = &m.specular_extras;
    if m.specular != 1.0 {
        extensions["KHR_materials_specular"] = json!({ "specularFactor": m.specular });
    }
    if specular.specular_color != [1.0; 3] {
        extensions["KHR_materials_specular"]["specularColorFactor"] = json!(specular.specular_color);
    }
    if specular.ior != DEFAULT_IOR {
        extensions["KHR_materials_ior"] = json!({ "ior": specular.ior });
    }
    if specular.clearcoat > 0.0 {
        extensions["KHR_materials_clearcoat"] = json!({
            "clearcoatFactor": specular.clearcoat, "clearcoatRoughnessFactor": specular.clearcoat_roughness,
        });
    }
    let emission: [f32; 3] = std::array::from_fn(|i| m.emission[i] * strength[i]);
    let largest = emission.into_iter().fold(0.0, f32::max);
    if largest > 0.0 {
        // A factor is at most 1.
        out["emissiveFactor"] = json!(emission.map(|e| if largest > 1.0 { e / largest } else { e }));
        if largest > 1.0 {
            extensions["KHR_materials_emissive_strength"] = json!({ "emissiveStrength": largest });
        }
    }
    if let Some(map) = extensions.as_object().filter(|map| !map.is_empty()) {
        used.extend(EXTENSIONS.iter().filter(|name| map.contains_key(**name)));
        out["extensions"] = extensions;
    }
    set_alpha(&mut out, m.alpha);
    set_name(&mut out, &m.name);
    out
}

/// The extensions of materials that may be written.
const EXTENSIONS: [&str; 6] = [
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_transmission",
];

fn set_alpha(out: &mut Value, alpha: Alpha) {
    match alpha {
        Alpha::Opaque => {}
        Alpha::Mask { cutoff } => {
            out["alphaMode"] = "MASK".into();
            out["alphaCutoff"] = cutoff.into();
        }
        Alpha::Blend => out["alphaMode"] = "BLEND".into(),
    }
}

fn set_name(out: &mut Value, name: &str) {
    if !name.is_empty() {
        out["name"] = name.into();
    }
}

/// Returns a reference to a texture, with its transform; a shear is left out.
fn reference(detail: &DetailTexture, index: usize, used: &mut BTreeSet<&'static str>) -> Value {
    let [[a, b, x], [c, d, y]] = detail.uv_from_vertex;
    let mut out = json!({ "index": index });
    if detail.uv_from_vertex == [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
        return out;
    }
    // Translation, rotation [[cos, sin], [−sin, cos]] and scale.
    let (rotation, scale_u) = ((-c).atan2(a), a.hypot(c));
    let (sin, cos) = rotation.sin_cos();
    let scale_v = b * sin + d * cos;
    let shear = b * cos - d * sin;
    if shear.abs() > SHEAR * scale_v.abs().max(scale_u) {
        return out;
    }
    used.insert("KHR_texture_transform");
    out["extensions"] = json!({ "KHR_texture_transform": {
        "offset": [x, y], "rotation": rotation, "scale": [scale_u, scale_v]
    } });
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_texture_transform_is_the_matrix_that_it_was() {
        let (sin, cos) = 0.7f32.sin_cos();
        let uv_from_vertex = [[2.0 * cos, -3.0 * -sin, 0.25], [-2.0 * sin, 3.0 * cos, -0.5]];
        let mut used = BTreeSet::new();
        let said = reference(&DetailTexture { texture: 0, uv_from_vertex }, 4, &mut used);
        let transform = &said["extensions"]["KHR_texture_transform"];
        let number = |value: &Value| value.as_f64().unwrap() as f32;
        assert!((number(&transform["rotation"]) - 0.7).abs() < 1e-6 && said["index"] == 4, "{said}");
        assert!((number(&transform["scale"][0]) - 2.0).abs() < 1e-5, "{said}");
        assert!((number(&transform["scale"][1]) - 3.0).abs() < 1e-5, "{said}");
        assert_eq!(transform["offset"], json!([0.25, -0.5]));
        assert!(used.contains("KHR_texture_transform"));
    }

    #[test]
    fn emission_over_one_has_a_strength_and_keeps_its_colour() {
        let material = Material { emission: [2.0, 1.0, 0.5], specular: 1.0, ..Material::default() };
        let mut used = BTreeSet::new();
        let out = original(&material, [2.0, 2.0, 2.0], |_| 0, &mut used);
        assert_eq!(out["emissiveFactor"], json!([1.0, 0.5, 0.25]));
        assert_eq!(out["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"], 4.0);
        assert_eq!(used.into_iter().collect::<Vec<_>>(), ["KHR_materials_emissive_strength"]);
    }

    #[test]
    fn specular_extras_are_in_the_extensions_that_they_came_from() {
        use rebounce_shared::rbn::specular::SpecularExtras;
        let with = |specular: f32, specular_extras: SpecularExtras| {
            let mut used = BTreeSet::new();
            let material = Material { specular, specular_extras, ..Material::default() };
            let out = original(&material, [0.0; 3], |_| 0, &mut used);
            (out["extensions"].clone(), used.into_iter().collect::<Vec<_>>())
        };
        assert_eq!(with(1.0, SpecularExtras::default()), (Value::Null, vec![]));
        let extras = SpecularExtras {
            ior: 1.25,
            specular_color: [0.5, 1.0, 2.0],
            clearcoat: 0.75,
            clearcoat_roughness: 0.25,
        };
        let expected = json!({
            "KHR_materials_specular": { "specularColorFactor": [0.5, 1.0, 2.0] },
            "KHR_materials_ior": { "ior": 1.25 },
            "KHR_materials_clearcoat": { "clearcoatFactor": 0.75, "clearcoatRoughnessFactor": 0.25 },
        });
        let names = ["KHR_materials_clearcoat", "KHR_materials_ior", "KHR_materials_specular"];
        assert_eq!(with(1.0, extras), (expected, names.to_vec()));
    }
}
