//! Radiance to what a screen shows: exposed and tone-mapped as in pictures, 8 bits of sRGB.

use super::texels::LightTexture;
use crate::io::picture::{Picture, png};
use glam::{Vec3, Vec4, Vec4Swizzles};
use rebounce_shared::tone::agx;

/// Opacity from which on a texel counts as opaque.
const OPAQUE: f32 = 254.5 / 255.0;

/// Exposure and tone mapping.
#[derive(Clone, Copy, Debug)]
pub struct Developed {
    /// Factor of radiance before tone mapping.
    pub exposure: f32,
}

impl Developed {
    /// Returns the displayed colour of a radiance, linear RGB from 0 to 1.
    pub fn colour(&self, radiance: Vec3) -> Vec3 {
        agx(radiance * self.exposure)
    }

    /// Encodes a texture of radiance as PNG; with alpha if it is not opaque everywhere.
    ///
    /// # Errors
    /// The problem of the encoder.
    pub fn png(&self, texture: &LightTexture) -> Result<Vec<u8>, String> {
        let pixels = texture.values.iter().map(|value| self.colour(value.xyz())).collect();
        let picture = Picture { width: texture.width, height: texture.height, pixels };
        if texture.values.iter().all(|value| value.w >= OPAQUE) {
            return png::encode_display(&picture);
        }
        let colours = png::display_bytes(&picture);
        let alpha = |value: &Vec4| (value.w.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        let rgba = colours.as_chunks::<3>().0.iter().zip(&texture.values);
        let rgba = rgba.flat_map(|([r, g, b], value)| [*r, *g, *b, alpha(value)]).collect();
        let image = image::RgbaImage::from_raw(texture.width, texture.height, rgba)
            .ok_or("the texture's size does not fit its texels")?;
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write_to(&mut bytes, image::ImageFormat::Png).map_err(|error| error.to_string())?;
        Ok(bytes.into_inner())
    }
}
