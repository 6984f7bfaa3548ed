//! PNG for the eye: exposed automatically, tone mapped, sRGB.
//!
//! Exposure and tone mapping: as in the page (`rebounce_shared::exposure`, [`agx`]).

use super::Picture;
use glam::Vec3;
use rebounce_shared::colour::luminance;
use rebounce_shared::exposure;
use rebounce_shared::tone::agx;

/// Automatic exposure factor of a picture, at most `most`; 1 for a black picture. `is_surface` returns whether the
/// centre of pixel [x, y] is on a surface.
pub fn automatic_exposure(picture: &Picture, most: f32, is_surface: impl Fn([u32; 2]) -> bool) -> f32 {
    let looked = exposure::looked([picture.width, picture.height]).filter(|pixel| is_surface(*pixel));
    let light = looked.map(|[x, y]| luminance(picture.pixels[(y * picture.width + x) as usize]));
    exposure::key(&light.collect::<Vec<_>>(), most)
}

/// Automatic exposure without knowledge of surfaces: every pixel other than black counts as surface.
pub fn exposure_of_lit(picture: &Picture, most: f32) -> f32 {
    automatic_exposure(picture, most, |[x, y]| picture.pixels[(y * picture.width + x) as usize] != Vec3::ZERO)
}

/// Linear to sRGB, 8 bits.
fn srgb(c: f32) -> u8 {
    let c = c.clamp(0.0, 1.0);
    let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0 + 0.5) as u8
}

/// An exposed, tone-mapped picture: linear RGB from 0 to 1.
pub fn developed(picture: &Picture, exposure: f32) -> Picture {
    let pixels = picture.pixels.iter().map(|&p| agx(p * exposure)).collect();
    Picture { pixels, ..*picture }
}

/// Encodes a picture as PNG, with the automatic exposure, at most `most`.
pub(super) fn encode(picture: &Picture, most: f32) -> Result<Vec<u8>, String> {
    encode_display(&developed(picture, exposure_of_lit(picture, most)))
}

/// Pixels of a picture of linear RGB from 0 to 1: sRGB, three bytes each.
pub fn display_bytes(picture: &Picture) -> Vec<u8> {
    picture.pixels.iter().flat_map(|p| p.to_array().map(srgb)).collect()
}

/// Encodes linear RGB from 0 to 1 as PNG, without exposure and tone mapping.
pub fn encode_display(picture: &Picture) -> Result<Vec<u8>, String> {
    let image = image::RgbImage::from_raw(picture.width, picture.height, display_bytes(picture))
        .ok_or("the picture's size does not fit its pixels")?;
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).map_err(|e| e.to_string())?;
    Ok(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposure_does_not_depend_on_the_unit() {
        let picture = |k: f32| Picture {
            width: 2,
            height: 2,
            pixels: vec![Vec3::ZERO, Vec3::splat(k), Vec3::splat(4.0 * k), Vec3::splat(2.0 * k)],
        };
        let key = |k: f32| exposure_of_lit(&picture(k), f32::INFINITY);
        assert!((key(1e6) * 1e6 / key(1.0) - 1.0).abs() < 1e-5);
        let encoded = |k: f32| encode(&picture(k), f32::INFINITY);
        assert_eq!(encoded(1.0), encoded(1024.0));
        assert_eq!(encode(&picture(1.0), 1e-6), encode(&picture(0.0), 1.0), "black at so little");
    }
}
