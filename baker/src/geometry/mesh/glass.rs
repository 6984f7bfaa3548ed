//! Glass: surfaces with coloured transmission.

use crate::scene::texture::Sampler;
use glam::{Vec2, Vec3};
use rebounce_shared::rbn::extras::{Extras, Passage};
use rebounce_shared::rbn::meta::{DetailTexture, Material};

/// Parameters of a material for transmission.
#[derive(Clone, Debug)]
pub struct Glass {
    extras: Extras,
    metallic: f32,
    /// Textures of factors: red for the transmission, blue for the metalness.
    transmission_texture: Option<Detail>,
    metallic_texture: Option<Detail>,
}

/// Texture other than the base colour's, with a transform from the vertices' texture coordinates.
#[derive(Clone, Debug)]
pub(super) struct Detail {
    sampler: Sampler,
    rows: [Vec3; 2],
}

impl Detail {
    pub fn new(of: &Option<DetailTexture>, texture: &impl Fn(u32) -> Option<Sampler>) -> Option<Self> {
        let DetailTexture { texture: index, uv_from_vertex } = of.as_ref()?;
        Some(Self { sampler: texture(*index)?, rows: uv_from_vertex.map(Vec3::from) })
    }

    fn at(&self, uv: Vec2) -> Vec2 {
        let at = uv.extend(1.0);
        Vec2::new(self.rows[0].dot(at), self.rows[1].dot(at))
    }

    /// Returns a channel of the nearest texel, 0 to 1.
    pub(super) fn channel(&self, uv: Vec2, channel: usize) -> f32 {
        f32::from(self.sampler.nearest_texel(self.at(uv))[channel]) / 255.0
    }

    /// Returns the linear RGB colour around a place, averaged over about the fraction `share` of the base colour's
    /// texture.
    pub fn color(&self, uv: Vec2, share: f32) -> Vec3 {
        let larger = (self.rows[0].x * self.rows[1].y - self.rows[0].y * self.rows[1].x).abs();
        self.sampler.color(self.at(uv), share * larger, false)
    }
}

impl Glass {
    /// Creates the glass of a material; `None` without transmission. `texture` returns textures by number, at least
    /// the textures [needed by light](crate::scene::needed::of_light).
    pub fn new(material: &Material, texture: &impl Fn(u32) -> Option<Sampler>) -> Option<Box<Self>> {
        material.is_glass().then(|| {
            Box::new(Self {
                extras: material.extras,
                metallic: material.metallic,
                transmission_texture: Detail::new(&material.extras.transmission_texture, texture),
                metallic_texture: Detail::new(&material.metallic_roughness_texture, texture),
            })
        })
    }

    /// Returns the transmitted and reflected light at a texture coordinate, for this base colour and alpha.
    pub fn passage(&self, base: Vec3, alpha: f32, uv: Vec2) -> Passage {
        let channel =
            |detail: &Option<Detail>, channel| detail.as_ref().map_or(1.0, |d| d.channel(uv, channel));
        let metallic = self.metallic * channel(&self.metallic_texture, 2);
        self.extras.passage(base, alpha, metallic, channel(&self.transmission_texture, 0))
    }
}
