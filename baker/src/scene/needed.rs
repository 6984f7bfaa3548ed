//! Selection of a material's textures to decode: the textures that light needs.

use rebounce_shared::rbn::meta::Material;

/// Textures of a material that light needs: base colour and, if the material lets light through, transmission and
/// metalness.
pub fn of_light(material: &Material) -> impl Iterator<Item = u32> {
    let through = material.is_glass();
    let details = [&material.extras.transmission_texture, &material.metallic_roughness_texture];
    let details = details.map(|detail| detail.as_ref().filter(|_| through).map(|d| d.texture));
    details.into_iter().chain([material.base_color_texture]).flatten()
}

/// Texture of roughness and metalness of a material, for gloss; `None` where it changes nothing.
pub fn of_gloss(material: &Material) -> Option<u32> {
    let shines = material.metallic > 0.0 || material.specular > 0.0;
    material.metallic_roughness_texture.filter(|_| shines).map(|detail| detail.texture)
}

/// Emission texture of a material in pictures; `None` without emission.
pub fn of_emission(material: &Material) -> Option<u32> {
    material.emission_texture.filter(|_| material.emission != [0.0; 3]).map(|detail| detail.texture)
}
