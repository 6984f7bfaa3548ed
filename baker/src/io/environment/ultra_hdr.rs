//! JPEG with a gain map (Google's *Ultra HDR Image Format* 1.1): a base picture in sRGB, and a second JPEG with the
//! logarithm of what the radiance is of it. White of the base picture is 1 W/(sr m²).

use super::gain_map::{GainMap, has_gain_map};
use super::jpeg_segments::JpegSegments;
use super::{EnvironmentError, EnvironmentFile};
use glam::Vec3;
use image::codecs::jpeg::JpegDecoder;
use image::{DynamicImage, ImageDecoder, RgbImage};
use rebounce_shared::elementary::Elementary;
use rebounce_shared::environment::Environment;
use std::io::Cursor;

const FORMAT: &str = "an Ultra HDR JPEG";
/// Signature of the segment of ISO 21496-1 metadata.
const ISO: &[u8] = b"urn:iso:std:iso:ts:21496:-1\0";

/// Decodes a picture and applies its gain map in full.
pub(super) fn decode(
    file: &EnvironmentFile,
    notes: &mut Vec<String>,
) -> Result<Environment, EnvironmentError> {
    let segments = JpegSegments::new(file.bytes);
    let Some(end) = segments.end else {
        return Err(file.damaged(FORMAT, "it ends within its base picture (it is truncated)"));
    };
    let other = segments.others().into_iter().find_map(|bytes| {
        let inner = JpegSegments::new(bytes);
        inner.xmp().filter(|xmp| has_gain_map(xmp)).map(|xmp| (bytes, xmp, inner))
    });
    let Some((map, xmp, inner)) = other else {
        return Err(missing(file, &segments));
    };
    let Some(map_end) = inner.end else {
        return Err(file.damaged(FORMAT, "it ends within its gain map (it is truncated)"));
    };
    let problem = |problem| EnvironmentError::Jpeg { name: file.name.to_owned(), problem };
    let gain = GainMap::parse(&xmp).map_err(problem)?;
    let base = picture(file, &file.bytes[..end])?;
    let map = picture(file, &map[..map_end])?;
    if segments.has_profile() {
        notes.push(format!("{} has a colour profile: its colours are taken as sRGB", file.name));
    }

    let linear: [f32; 256] = std::array::from_fn(|i| linear(i as f32 / 255.0));
    let (width, height) = base.dimensions();
    let pixels = base.enumerate_pixels().map(|(x, y, pixel)| {
        let place = [(x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32];
        gain.apply(Vec3::from_array(pixel.0.map(|c| linear[c as usize])), bilinear(&map, place))
    });
    Ok(Environment { width, height, pixels: pixels.collect() })
}

/// Why a JPEG has no gain map that is read.
fn missing(file: &EnvironmentFile, segments: &JpegSegments) -> EnvironmentError {
    let announced = segments.xmp().is_some_and(|xmp| xmp.contains("hdrgm:Version"));
    let has_iso =
        segments.has_app2(ISO) || segments.others().iter().any(|b| JpegSegments::new(b).has_app2(ISO));
    let problem = if has_iso {
        "whose gain map is described by ISO 21496-1 alone, which is not read"
    } else if announced {
        return file.damaged(FORMAT, "its gain map is missing (it is truncated)");
    } else {
        "without a gain map, so it has no radiance"
    };
    EnvironmentError::Jpeg { name: file.name.to_owned(), problem: problem.to_owned() }
}

/// Decodes one JPEG picture to RGB of 8 bits.
fn picture(file: &EnvironmentFile, bytes: &[u8]) -> Result<RgbImage, EnvironmentError> {
    let damaged = |e: image::ImageError| file.damaged(FORMAT, e);
    let decoder = JpegDecoder::new(Cursor::new(bytes)).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    file.check_size(width.into(), height.into())?;
    Ok(DynamicImage::from_decoder(decoder).map_err(damaged)?.into_rgb8())
}

/// sRGB to linear, both from 0 to 1.
fn linear(c: f32) -> f32 {
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).power(2.4) }
}

/// Bilinear value of a picture, from 0 to 1, at a place from 0 to 1; wraps around sidewards.
fn bilinear(picture: &RgbImage, [u, v]: [f32; 2]) -> Vec3 {
    let (width, height) = picture.dimensions();
    let (x, y) = (u * width as f32 - 0.5, (v * height as f32 - 0.5).clamp(0.0, (height - 1) as f32));
    let left = (x.floor() as i64).rem_euclid(i64::from(width)) as u32;
    let texel = |x: u32, y: u32| {
        Vec3::from_array(picture.get_pixel(x % width, y.min(height - 1)).0.map(f32::from)) / 255.0
    };
    let row = |y: u32| texel(left, y).lerp(texel(left + 1, y), x - x.floor());
    row(y as u32).lerp(row(y as u32 + 1), y - y.floor())
}
