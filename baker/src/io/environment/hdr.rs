//! Radiance RGBE (.hdr, .pic): Ward, *Real Pixels*, Graphics Gems II, 1991.

use super::{EnvironmentError, EnvironmentFile};
use glam::Vec3;
use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;
use rebounce_shared::environment::Environment;
use std::io::Cursor;

const FORMAT: &str = "a Radiance picture";

/// Decodes a picture. Exposure and colour correction of the header are divided out, as the format has it.
pub(super) fn decode(
    file: &EnvironmentFile,
    notes: &mut Vec<String>,
) -> Result<Environment, EnvironmentError> {
    // Writers begin with #?RADIANCE or #?RGBE; the strict decoder takes only the former.
    let decoder = HdrDecoder::new_nonstrict(Cursor::new(file.bytes)).map_err(|e| file.damaged(FORMAT, e))?;
    let (width, height) = decoder.dimensions();
    file.check_size(width.into(), height.into())?;
    let header = decoder.metadata();
    let mut pixels = vec![Vec3::ZERO; width as usize * height as usize];
    decoder
        .read_image(bytemuck::cast_slice_mut(&mut pixels))
        .map_err(|e| file.damaged(FORMAT, format!("{e} (it may be truncated)")))?;

    let (r, g, b) = header.color_correction.unwrap_or((1.0, 1.0, 1.0));
    let factor = Vec3::new(r, g, b) * header.exposure.unwrap_or(1.0);
    if !(factor.is_finite() && factor.min_element() > 0.0) {
        return Err(file.damaged(FORMAT, format!("its exposure and colour correction are {factor}")));
    }
    if factor != Vec3::ONE {
        pixels.iter_mut().for_each(|pixel| *pixel /= factor);
        notes.push(format!("{}: the exposure in its header, {factor}, is divided out", file.name));
    }
    Ok(Environment { width, height, pixels })
}
