//! BMP, GIF, TGA and TIFF pictures, outside glTF but written by exporters: converted to PNG.

use super::texture_size::check_size;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageFormat, ImageReader, ImageResult};
use std::io::Cursor;

/// Detects the format of a picture from the first bytes, among the formats that are converted to PNG.
pub(super) fn format(bytes: &[u8]) -> Option<ImageFormat> {
    match bytes {
        [b'B', b'M', ..] => Some(ImageFormat::Bmp),
        [b'G', b'I', b'F', b'8', ..] => Some(ImageFormat::Gif),
        [b'I', b'I', 42, 0, ..] | [b'M', b'M', 0, 42, ..] => Some(ImageFormat::Tiff),
        // TGA has no signature: the header must be plausible.
        [_, colours @ 0..=1, kind @ (1..=3 | 9..=11), rest @ ..] => {
            let (&[width_low, width_high, height_low, height_high, depth, flags], _) =
                rest.get(9..)?.split_first_chunk()?;
            let has_size = (width_low, width_high) != (0, 0) && (height_low, height_high) != (0, 0);
            let is_listed = matches!(kind, 1 | 9);
            let has_depth = matches!(depth, 8 | 15 | 16 | 24 | 32);
            (has_size && has_depth && flags < 64 && is_listed == (*colours == 1)).then_some(ImageFormat::Tga)
        }
        _ => None,
    }
}

/// Width and height, from the header.
pub(super) fn size(bytes: &[u8]) -> Option<(u64, u64)> {
    let reader = ImageReader::with_format(Cursor::new(bytes), format(bytes)?);
    reader.into_dimensions().ok().map(|(width, height)| (width.into(), height.into()))
}

/// Converts a picture of these formats to PNG, lossless at 8 bits per channel; the first frame of an animation. The
/// error is a sentence with the problem.
pub(super) fn to_png(bytes: &[u8], format: ImageFormat) -> Result<Vec<u8>, String> {
    let name = format.extensions_str().first().map_or_else(String::new, |name| name.to_uppercase());
    let damaged = |problem: String| {
        format!("its {name} picture cannot be decoded ({problem}): save it again as PNG or JPEG")
    };
    if !cfg!(feature = "more-pictures") {
        return Err(format!("its {name} picture is none that glTF knows: save it as PNG or JPEG"));
    }
    let (width, height) = size(bytes).ok_or_else(|| damaged("its header is damaged".to_owned()))?;
    check_size(width, height, bytes.len())?;
    let decoded = ImageReader::with_format(Cursor::new(bytes), format).decode();
    let picture = decoded.map_err(|e| damaged(e.to_string()))?.into_rgba8();
    png(picture.as_raw(), picture.width(), picture.height()).map_err(|e| damaged(e.to_string()))
}

/// Encodes texels as PNG, without alpha if all texels are opaque.
pub(super) fn png(rgba: &[u8], width: u32, height: u32) -> ImageResult<Vec<u8>> {
    let mut png = Vec::new();
    let encoder = PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive);
    let texels = rgba.as_chunks::<4>().0;
    if texels.iter().all(|t| t[3] == 255) {
        let rgb: Vec<u8> = texels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
        encoder.write_image(&rgb, width, height, ExtendedColorType::Rgb8)?;
    } else {
        encoder.write_image(rgba, width, height, ExtendedColorType::Rgba8)?;
    }
    Ok(png)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::texture::{Texels, Texture};
    use rebounce_shared::rbn::meta;

    #[test]
    fn pictures_of_each_format_keep_their_texels() {
        let picture =
            image::RgbaImage::from_fn(5, 3, |x, y| image::Rgba([x as u8 * 50, y as u8 * 90, 7, 255]));
        let truth = image::DynamicImage::from(picture);
        for format in [ImageFormat::Bmp, ImageFormat::Gif, ImageFormat::Tga, ImageFormat::Tiff] {
            let mut bytes = Cursor::new(Vec::new());
            truth.write_to(&mut bytes, format).unwrap();
            let bytes = bytes.into_inner();
            assert_eq!(super::format(&bytes), Some(format));
            assert_eq!(size(&bytes), Some((5, 3)), "{format:?}");
            let texels = Texels::decode(&to_png(&bytes, format).unwrap()).unwrap();
            assert_eq!((texels.width, texels.height), (5, 3), "{format:?}");
            assert_eq!(texels.rgba.as_flattened(), truth.as_bytes(), "{format:?}");
            // In a scene the picture is a PNG, decoded or not.
            for decoded in [true, false] {
                let read =
                    Texture::new("scene.glb", meta::Texture::default(), bytes.clone(), decoded).unwrap();
                let kind =
                    (read.meta.mime.as_str(), read.meta.width, read.meta.height, read.texels.is_some());
                assert_eq!(kind, ("image/png", 5, 3, decoded), "{format:?}");
            }
            // A truncated picture is an error, or decodes as far as present.
            for len in 0..bytes.len() {
                if let Err(problem) = to_png(&bytes[..len], format) {
                    assert!(problem.contains("PNG or JPEG") || problem.contains("texels"), "{problem}");
                }
            }
        }
        for other in [
            b"\x89PNG\r\n\x1a\n0000000000000".as_slice(),
            b"\xff\xd8\xff\xe00000000000000000000",
            b"DDS 0",
            b"",
        ] {
            assert_eq!(super::format(other), None, "{other:?}");
        }
    }
}
