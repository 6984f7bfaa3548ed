//! Which textures of a material are decoded: those that light needs.

use rebounce_shared::rbn::meta::Material;

/// The textures that light needs of a material: that of its base colour, and where it lets light through, those of
/// transmission and metalness.
pub fn of_light(material: &Material) -> impl Iterator<Item = u32> {
    let through = material.is_glass();
    let details = [&material.extras.transmission_texture, &material.metallic_roughness_texture];
    let details = details.map(|detail| detail.as_ref().filter(|_| through).map(|d| d.texture));
    details.into_iter().chain([material.base_color_texture]).flatten()
}

/// The texture that a material's emission has in pictures.
pub fn of_emission(material: &Material) -> Option<u32> {
    material.emission_texture.filter(|_| material.emission != [0.0; 3]).map(|detail| detail.texture)
}
