//! How a surface shines: KHR_materials_ior, _specular, _clearcoat.

use super::document::Extensible;
use gltf::json::Material;
use gltf::json::texture::Info;
use rebounce_shared::rbn;
use rebounce_shared::rbn::specular::{DEFAULT_IOR, SpecularExtras};
use serde::Deserialize;

/// Names of extensions unknown to the `gltf` crate.
const IOR: &str = "KHR_materials_ior";
const CLEARCOAT: &str = "KHR_materials_clearcoat";

/// JSON of KHR_materials_ior.
#[derive(Debug, Deserialize)]
#[serde(default)]
struct Ior {
    ior: f32,
}

impl Default for Ior {
    fn default() -> Self {
        Self { ior: DEFAULT_IOR }
    }
}

/// JSON of KHR_materials_clearcoat. Of the normal texture it matters only that there is one.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Clearcoat {
    clearcoat_factor: f32,
    clearcoat_texture: Option<Info>,
    clearcoat_roughness_factor: f32,
    clearcoat_roughness_texture: Option<Info>,
    clearcoat_normal_texture: Option<Info>,
}

/// How a material shines besides metalness and roughness.
pub(super) struct Shine {
    /// `specularFactor`, 0 to 1.
    pub specular: f32,
    /// The rest.
    pub extras: SpecularExtras,
    /// Textures that are left out, by what they hold.
    pub left_out: Vec<&'static str>,
}

impl Shine {
    /// Reads a material's extensions.
    ///
    /// # Errors
    /// A description of what is wrong.
    pub fn new(material: &Material) -> Result<Self, String> {
        let specular = material.extensions.as_ref().and_then(|e| e.specular.clone()).unwrap_or_default();
        let Ior { ior } = material.extension(IOR)?.unwrap_or_default();
        let coat: Clearcoat = material.extension(CLEARCOAT)?.unwrap_or_default();
        let strength = specular.specular_factor.0;
        let color = specular.specular_color_factor.0;
        let factors = [strength, ior, coat.clearcoat_factor, coat.clearcoat_roughness_factor];
        if !factors.iter().chain(&color).all(|x| x.abs() < rbn::LARGEST) {
            return Err("has a factor that is not finite, or far too large".into());
        }
        let clearcoat = coat.clearcoat_factor.clamp(0.0, 1.0);
        let textures = [
            (specular.specular_texture.is_some() && strength > 0.0, "specular"),
            (specular.specular_color_texture.is_some() && strength > 0.0, "specular colour"),
            (coat.clearcoat_texture.is_some() && clearcoat > 0.0, "clearcoat"),
            (coat.clearcoat_roughness_texture.is_some() && clearcoat > 0.0, "clearcoat roughness"),
            (coat.clearcoat_normal_texture.is_some() && clearcoat > 0.0, "clearcoat normal"),
        ];
        let extras = SpecularExtras {
            // 0 stands for a mirror, and no other number is under 1.
            ior: if ior == 0.0 { 0.0 } else { ior.max(1.0) },
            specular_color: color.map(|c| c.max(0.0)),
            clearcoat,
            // Without a layer its roughness is none.
            clearcoat_roughness: if clearcoat > 0.0 {
                coat.clearcoat_roughness_factor.clamp(0.0, 1.0)
            } else {
                0.0
            },
        };
        let left_out = textures.into_iter().filter(|(is_there, _)| *is_there).map(|(_, what)| what);
        Ok(Self { specular: strength.clamp(0.0, 1.0), extras, left_out: left_out.collect() })
    }
}
