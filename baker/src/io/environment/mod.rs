//! Environments from files: equirectangular pictures of radiance.
//!
//! * [`hdr`] – Radiance RGBE; [`exr`] – OpenEXR;
//! * [`ultra_hdr`] – JPEG with a gain map; [`gain_map`] – its metadata; [`jpeg_segments`] – where they lie in the file.
//!
//! A format is known by its first bytes, not by its name.

mod exr;
mod gain_map;
mod hdr;
mod jpeg_segments;
mod ultra_hdr;

use super::Files;
use super::files::Disk;
use glam::Vec3;
use rebounce_shared::environment::Environment;
use std::path::{Path, PathBuf};

/// Pixels in a row above which an environment is reduced: 0.09° each, a third of the sun's radius.
pub const MAX_WIDTH: u32 = 4096;
/// Largest picture that is read, pixels in a row.
const MAX_READ: u32 = 16_384;
/// More pixels for a byte of a file than any format stores, but for pictures of one colour.
const PIXELS_PER_BYTE: u64 = 1024;
/// A picture of up to this many pixels may come from a file of any size.
const SMALL: u64 = 1024 * 512;

/// Reason for an unusable environment.
#[derive(Debug, thiserror::Error)]
pub enum EnvironmentError {
    /// The file could not be read.
    #[error("cannot read {path}: {source}; check the path and the permissions")]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The first bytes are those of no known format.
    #[error(
        "{name} is not an environment: it is neither Radiance (.hdr), nor OpenEXR (.exr), nor an Ultra HDR JPEG; \
         convert it to .hdr or .exr"
    )]
    Format {
        /// The file.
        name: String,
    },
    /// The file is truncated, damaged, or has something that is not read.
    #[error("{name} cannot be read as {format}: {problem}; save or download it again")]
    Damaged {
        /// The file.
        name: String,
        /// The format that its first bytes promise.
        format: &'static str,
        /// Description of the problem.
        problem: String,
    },
    /// A JPEG without radiance, or with radiance in a form that is not read.
    #[error("{name} is a JPEG {problem}; convert it to .hdr or .exr")]
    Jpeg {
        /// The file.
        name: String,
        /// What it is or lacks.
        problem: String,
    },
    /// No pixels.
    #[error("{name} has {width}x{height} pixels: there is no picture in it; save it again")]
    Empty {
        /// The file.
        name: String,
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// Not twice as wide as high.
    #[error(
        "{name} has {width}x{height} pixels, {ratio:.2}:1: an environment is equirectangular, 2:1; convert it from a \
         cube map or a cut-out to a full panorama"
    )]
    Ratio {
        /// The file.
        name: String,
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Width over height.
        ratio: f64,
    },
    /// More pixels than are read, or than so small a file can hold.
    #[error(
        "{name} claims {width}x{height} pixels in {bytes} bytes: more than 16384x8192, or more than such a file holds; \
         reduce it to {MAX_WIDTH} pixels in a row, or download it again"
    )]
    TooLarge {
        /// The file.
        name: String,
        /// Pixels in a row.
        width: u64,
        /// Rows.
        height: u64,
        /// Size of the file.
        bytes: usize,
    },
    /// A pixel whose radiance is no number, infinite or negative.
    #[error(
        "{name} has the radiance ({}, {}, {}) in pixel x = {x}, y = {y} (from the top left): it must be finite and not \
         negative; save it with 32-bit floats, or paint the pixel over", value.x, value.y, value.z
    )]
    Texel {
        /// The file.
        name: String,
        /// Column from the left, from 0.
        x: u32,
        /// Row from the top, from 0.
        y: u32,
        /// The pixel.
        value: Vec3,
    },
}

/// Reads an environment from a .hdr, .exr or Ultra HDR .jpg file. Besides it returns notes: what was changed or is
/// worth knowing, a sentence each.
///
/// # Errors
/// [`EnvironmentError`].
pub fn read(path: &Path) -> Result<(Environment, Vec<String>), EnvironmentError> {
    read_from(&Disk, path)
}

/// As [`read`], from any source of files.
///
/// # Errors
/// [`EnvironmentError`].
pub fn read_from(files: &dyn Files, path: &Path) -> Result<(Environment, Vec<String>), EnvironmentError> {
    let bytes =
        files.read(path).map_err(|source| EnvironmentError::Read { path: path.to_owned(), source })?;
    decode(&bytes, &path.display().to_string())
}

/// As [`read`], from the bytes of a file; `name` is for messages.
///
/// # Errors
/// [`EnvironmentError`].
pub fn decode(bytes: &[u8], name: &str) -> Result<(Environment, Vec<String>), EnvironmentError> {
    let file = EnvironmentFile { bytes, name };
    let mut notes = Vec::new();
    let picture = match bytes {
        [b'#', b'?', ..] => hdr::decode(&file, &mut notes)?,
        [0x76, 0x2f, 0x31, 0x01, ..] => exr::decode(&file)?,
        [0xff, 0xd8, 0xff, ..] => ultra_hdr::decode(&file, &mut notes)?,
        _ => return Err(EnvironmentError::Format { name: name.to_owned() }),
    };
    file.check_ratio(&picture)?;
    file.check_texels(&picture)?;
    if picture.width <= MAX_WIDTH {
        return Ok((picture, notes));
    }
    let reduced = picture.reduced(MAX_WIDTH);
    notes.push(format!(
        "{name} has {}x{} pixels and is reduced to {}x{}",
        picture.width, picture.height, reduced.width, reduced.height
    ));
    Ok((reduced, notes))
}

/// A file's bytes, and its name in messages.
struct EnvironmentFile<'a> {
    bytes: &'a [u8],
    name: &'a str,
}

impl EnvironmentFile<'_> {
    /// Checks the size that a header claims, before memory is taken for it.
    fn check_size(&self, width: u64, height: u64) -> Result<(), EnvironmentError> {
        let name = self.name.to_owned();
        let (w, h) = (width.min(u64::from(u32::MAX)) as u32, height.min(u64::from(u32::MAX)) as u32);
        if width == 0 || height == 0 {
            return Err(EnvironmentError::Empty { name, width: w, height: h });
        }
        let most = SMALL.max(self.bytes.len() as u64 * PIXELS_PER_BYTE);
        if width.max(height) > u64::from(MAX_READ) || width * height > most {
            return Err(EnvironmentError::TooLarge { name, width, height, bytes: self.bytes.len() });
        }
        Ok(())
    }

    /// Checks that a picture is twice as wide as high, within a pixel.
    fn check_ratio(&self, picture: &Environment) -> Result<(), EnvironmentError> {
        let (width, height) = (picture.width, picture.height);
        if width.abs_diff(2 * height) <= 1 {
            return Ok(());
        }
        let ratio = f64::from(width) / f64::from(height);
        Err(EnvironmentError::Ratio { name: self.name.to_owned(), width, height, ratio })
    }

    fn check_texels(&self, picture: &Environment) -> Result<(), EnvironmentError> {
        let is_wrong = |texel: &Vec3| !(texel.is_finite() && texel.min_element() >= 0.0);
        match picture.pixels.iter().position(is_wrong) {
            None => Ok(()),
            Some(at) => Err(EnvironmentError::Texel {
                name: self.name.to_owned(),
                x: (at % picture.width as usize) as u32,
                y: (at / picture.width as usize) as u32,
                value: picture.pixels[at],
            }),
        }
    }

    fn damaged(&self, format: &'static str, problem: impl ToString) -> EnvironmentError {
        EnvironmentError::Damaged { name: self.name.to_owned(), format, problem: problem.to_string() }
    }
}

#[cfg(test)]
mod tests;
