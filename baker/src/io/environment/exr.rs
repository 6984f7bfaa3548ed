//! OpenEXR: the channels R, G and B of the first layer that has them, of any precision.

use super::{EnvironmentError, EnvironmentFile};
use ::exr::prelude::*;
use rebounce_shared::environment::Environment;
use std::io::Cursor;

const FORMAT: &str = "an OpenEXR picture";

/// Decodes a picture.
pub(super) fn decode(file: &EnvironmentFile) -> std::result::Result<Environment, EnvironmentError> {
    let damaged = |e: ::exr::error::Error| file.damaged(FORMAT, e);
    let reader = ::exr::block::read(Cursor::new(file.bytes), false).map_err(damaged)?;
    for header in reader.headers() {
        let size = header.layer_size;
        file.check_size(size.width() as u64, size.height() as u64)?;
        let display = header.shared_attributes.display_window;
        if display.size != size {
            let (whole, part) = (display.size, size);
            let problem = format!(
                "its data window of {}x{} pixels is not the whole picture of {}x{}",
                part.0, part.1, whole.0, whole.1
            );
            return Err(file.damaged(FORMAT, problem));
        }
    }
    let image = ::exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| Environment {
                width: size.width() as u32,
                height: size.height() as u32,
                pixels: vec![glam::Vec3::ZERO; size.area()],
            },
            |picture: &mut Environment, at, (r, g, b): (f32, f32, f32)| {
                let index = at.y() * picture.width as usize + at.x();
                picture.pixels[index] = glam::Vec3::new(r, g, b);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_chunks(reader)
        .map_err(damaged)?;
    Ok(image.layer_data.channel_data.pixels)
}
