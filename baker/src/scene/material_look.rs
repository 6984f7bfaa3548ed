//! Looks of materials, by name: what a file of CAD parts does not say.

use super::Scene;
use glam::Vec3;
use std::collections::BTreeMap;

/// What replaces properties of a material; those that are absent stay.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialLook {
    /// Linear RGB reflectance, 0 to 1; replaces a texture, too.
    pub color: Option<[f32; 3]>,
    /// Roughness, 0 to 1; the surface has highlights then.
    pub roughness: Option<f32>,
    /// Metalness, 0 to 1.
    pub metallic: Option<f32>,
    /// Emitted linear RGB radiance, nits; replaces a texture, too.
    pub emission: Option<[f32; 3]>,
    /// Whether the back reflects.
    pub double_sided: Option<bool>,
}

impl MaterialLook {
    /// What is wrong with the numbers, if anything.
    pub fn problem(&self) -> Option<&'static str> {
        let is_share = |x: f32| (0.0..=1.0).contains(&x);
        let shares = [self.roughness, self.metallic].into_iter().flatten();
        let mut emission = self.emission.into_iter().flatten();
        match () {
            () if !self.color.into_iter().flatten().all(is_share) => {
                Some("color is three numbers from 0 to 1")
            }
            () if !shares.into_iter().all(is_share) => Some("roughness and metallic are from 0 to 1"),
            () if !emission.all(|x| (0.0..=1e18).contains(&x)) => {
                Some("emission is three numbers from 0 to 1e18")
            }
            () => None,
        }
    }
}

impl Scene {
    /// Replaces properties of the materials of these names. Returns the names that no material has.
    pub fn apply_looks(&mut self, looks: &BTreeMap<String, MaterialLook>) -> Vec<String> {
        let mut is_used: BTreeMap<&str, bool> = looks.keys().map(|name| (name.as_str(), false)).collect();
        let mut recoloured = vec![None; self.materials.len()];
        for (material, recoloured) in self.materials.iter_mut().zip(&mut recoloured) {
            let Some(look) = looks.get(&material.name) else { continue };
            is_used.insert(material.name.as_str(), true);
            if let Some([r, g, b]) = look.color {
                material.base_color = [r, g, b, material.base_color[3]];
                material.base_color_texture = None;
                *recoloured = Some(Vec3::new(r, g, b));
            }
            if let Some(roughness) = look.roughness {
                material.roughness = roughness;
                material.metallic_roughness_texture = None;
                material.specular = 1.0;
            }
            if let Some(metallic) = look.metallic {
                material.metallic = metallic;
            }
            if let Some(emission) = look.emission {
                material.emission = emission;
                material.emission_texture = None;
            }
            material.double_sided = look.double_sided.unwrap_or(material.double_sided);
        }
        for (colors, material) in self.corner_colors.iter_mut().zip(&self.triangle_material) {
            if let Some(color) = recoloured[*material as usize] {
                *colors = [color; 3];
            }
        }
        is_used.into_iter().filter(|(_, used)| !used).map(|(name, _)| name.to_owned()).collect()
    }
}
