//! A material's references to textures, and texture coordinates.

use super::document::Extensible;
use glam::{DMat3, DVec3};
use gltf::json::extensions::texture::TextureTransform;
use gltf::json::material::NormalTexture;
use gltf::json::texture::Info;
use rebounce_shared::elementary::Elementary;

/// A material's reference to a texture.
pub(super) struct TextureInfo {
    /// Index into the file's textures.
    pub index: usize,
    /// Number of the TEXCOORD attribute, unless overridden by the transform.
    set: u32,
    transform: Option<TextureTransform>,
}

/// How a material reads its texture coordinates.
#[derive(Clone, Copy)]
pub(super) struct UvSource {
    /// Number of the TEXCOORD attribute.
    pub set: u32,
    /// Transform of (u, v, 1) of the attribute.
    pub matrix: DMat3,
}

impl TextureInfo {
    pub fn new(info: &Info) -> Self {
        let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.clone());
        Self { index: info.index.value(), set: info.tex_coord, transform }
    }

    /// Reads the reference of a normal texture; the crate leaves the transform raw.
    pub fn of_normals(info: &NormalTexture) -> Result<Self, String> {
        let transform = info.extension("KHR_texture_transform")?;
        Ok(Self { index: info.index.value(), set: info.tex_coord, transform })
    }

    /// The texture coordinates of KHR_texture_transform: scale, then rotate counter-clockwise as the
    /// picture is seen (v points down), then offset.
    pub fn uv_source(&self) -> UvSource {
        let Some(t) = &self.transform else {
            return UvSource { set: self.set, matrix: DMat3::IDENTITY };
        };
        let (sin, cos) = f64::from(t.rotation.0).sine_cosine();
        let [sx, sy] = t.scale.0.map(f64::from);
        let [x, y] = t.offset.0.map(f64::from);
        UvSource {
            set: t.tex_coord.unwrap_or(self.set),
            matrix: DMat3::from_cols(
                DVec3::new(cos * sx, -sin * sx, 0.0),
                DVec3::new(sin * sy, cos * sy, 0.0),
                DVec3::new(x, y, 1.0),
            ),
        }
    }
}
