//! OpenEXR: linear RGB, 32-bit floats.

use super::{Picture, PictureError};
use ::exr::prelude::*;
use std::io::Cursor;
use std::path::Path;

/// The bytes of an EXR file with the channels R, G and B, compressed without loss.
pub(super) fn encode(picture: &Picture) -> std::result::Result<Vec<u8>, String> {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let pixel = |at: Vec2<usize>| {
        let p = picture.pixels[at.y() * width + at.x()];
        (p.x, p.y, p.z)
    };
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let image = Image::from_encoded_channels((width, height), encoding, SpecificChannels::rgb(pixel));
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).map_err(|e| e.to_string())?;
    Ok(bytes.into_inner())
}

/// Reads the channels R, G and B of an EXR file, whatever their precision.
///
/// # Errors
/// [`PictureError::Format`].
pub fn read(path: &Path) -> std::result::Result<Picture, PictureError> {
    let image = ::exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| Picture {
                width: size.width() as u32,
                height: size.height() as u32,
                pixels: vec![glam::Vec3::ZERO; size.area()],
            },
            |picture: &mut Picture, at, (r, g, b): (f32, f32, f32)| {
                let index = at.y() * picture.width as usize + at.x();
                picture.pixels[index] = glam::Vec3::new(r, g, b);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(|e| PictureError::Format {
            path: path.to_owned(),
            problem: format!("cannot be read as an EXR picture: {e}"),
        })?;
    Ok(image.layer_data.channel_data.pixels)
}
