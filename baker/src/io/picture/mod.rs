//! Pictures: reading and writing.
//!
//! * [`exr`] – linear radiance, the form for measuring;
//! * [`png`] – tone mapped, the form for looking.

pub mod exr;
pub mod png;

use crate::io::write::{WriteError, write_whole};
use glam::Vec3;
use std::path::{Path, PathBuf};

/// Linear RGB radiance, row after row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width · height` pixels.
    pub pixels: Vec<Vec3>,
}

/// Components of light to show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Only {
    /// Direct light, bounced light, and emission of surfaces.
    #[default]
    All,
    /// Light from a lamp directly to the visible surface.
    Direct,
    /// Light with at least one bounce before the visible surface.
    Indirect,
}

/// Why a picture could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file name does not imply a format.
    #[error("{path}: the name must end in .exr (linear radiance) or .png (tone mapped)")]
    UnknownFormat {
        /// The file asked for.
        path: PathBuf,
    },
    /// The picture could not be encoded or decoded.
    #[error("{path}: {problem}")]
    Format {
        /// The file.
        path: PathBuf,
        /// Description of the problem.
        problem: String,
    },
    /// The file could not be written.
    #[error("cannot write {0}")]
    Write(#[from] WriteError),
}

/// Checks that [`Picture::write`] supports the file name; for use before a long computation.
///
/// # Errors
/// [`PictureError::UnknownFormat`].
pub fn check_name(path: &Path) -> Result<(), PictureError> {
    match extension(path).as_str() {
        "exr" | "png" => Ok(()),
        _ => Err(PictureError::UnknownFormat { path: path.to_owned() }),
    }
}

fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}

impl Picture {
    /// Returns the sum of two pictures of equal size.
    pub fn plus(&self, other: &Self) -> Self {
        let pixels = self.pixels.iter().zip(&other.pixels).map(|(a, b)| a + b).collect();
        Self { pixels, ..*self }
    }

    /// Returns the mean of two pictures of equal size.
    pub fn mean(&self, other: &Self) -> Self {
        let pixels = self.pixels.iter().zip(&other.pixels).map(|(a, b)| 0.5 * (a + b)).collect();
        Self { pixels, ..*self }
    }

    /// Returns pictures of equal height side by side.
    pub fn beside(pictures: &[&Self]) -> Self {
        let height = pictures.iter().map(|p| p.height).min().unwrap_or(0);
        let row = |y: u32| {
            let part = move |p: &&Self| {
                let first = (y * p.width) as usize;
                p.pixels[first..first + p.width as usize].to_vec()
            };
            pictures.iter().flat_map(part)
        };
        Self {
            width: pictures.iter().map(|p| p.width).sum(),
            height,
            pixels: (0..height).flat_map(row).collect(),
        }
    }

    /// Writes an EXR or a PNG, selected by the file extension, atomically. A PNG is exposed
    /// automatically; the radiance is multiplied by at most `most_exposure`.
    ///
    /// # Errors
    /// [`PictureError`].
    pub fn write(&self, path: &Path, most_exposure: f32) -> Result<(), PictureError> {
        check_name(path)?;
        let is_exr = extension(path) == "exr";
        let encoded = if is_exr { exr::encode(self) } else { png::encode(self, most_exposure) };
        let bytes = encoded.map_err(|problem| PictureError::Format { path: path.to_owned(), problem })?;
        Ok(write_whole(path, &bytes)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exr_keeps_every_float() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let pixels =
            (0..35).map(|i| Vec3::new(i as f32 * 0.1, 1e-9 * i as f32, 1e9 / (1.0 + i as f32))).collect();
        let picture = Picture { width: 7, height: 5, pixels };
        picture.write(&path, 1.0).unwrap();
        assert_eq!(exr::read(&path).unwrap(), picture);
        assert!(exr::read(&folder.path().join("none.exr")).is_err());
    }

    #[test]
    fn a_name_without_a_known_ending_is_refused() {
        let picture = Picture { width: 1, height: 1, pixels: vec![Vec3::ONE] };
        let error = picture.write(Path::new("out.jpg"), 1.0).unwrap_err().to_string();
        assert!(error.contains(".exr") && error.contains(".png"), "{error}");
    }
}
