//! Pictures of linear radiance, read from files.

use anyhow::{Context, Result, bail};
use glam::Vec3;
use rebounce::io::picture::{Picture, exr};
use std::path::Path;

/// Reads an .exr, or a .f32: RGBA little-endian floats of a picture, with `WxH.f32` at the end of the file name.
///
/// # Errors
/// If the file cannot be read or is neither.
pub fn read(path: &Path) -> Result<Picture> {
    let name = || path.display().to_string();
    match path.extension().and_then(|e| e.to_str()) {
        Some("exr") => Ok(exr::read(path)?),
        Some("f32") => read_floats(path).with_context(name),
        _ => bail!("{}: neither .exr nor .f32", name()),
    }
}

fn read_floats(path: &Path) -> Result<Picture> {
    let stem = path.file_stem().and_then(|s| s.to_str()).unwrap_or_default();
    let size = stem.rsplit('-').next().and_then(|size| size.split_once('x'));
    let Some((Ok(width), Ok(height))) = size.map(|(w, h)| (w.parse::<u32>(), h.parse::<u32>())) else {
        bail!("the name does not end in -WIDTHxHEIGHT.f32");
    };
    let bytes = std::fs::read(path)?;
    if bytes.len() as u64 != 16 * u64::from(width) * u64::from(height) {
        bail!("{} bytes are no {width} by {height} pixels of 16", bytes.len());
    }
    let float = |b: &[u8]| f32::from_le_bytes(std::array::from_fn(|i| b[i]));
    let pixel = |b: &[u8]| Vec3::new(float(&b[..4]), float(&b[4..8]), float(&b[8..12]));
    Ok(Picture { width, height, pixels: bytes.chunks_exact(16).map(pixel).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_kinds_of_file_give_the_same_picture() {
        let dir = tempfile::tempdir().unwrap();
        let value = |i: usize| [(i % 3) as f32 + 0.25, (i / 3) as f32 * 100.0, 1e-3, 1.0];
        let picture =
            Picture { width: 3, height: 2, pixels: (0..6).map(|i| Vec3::from_slice(&value(i))).collect() };
        let exr = dir.path().join("picture.exr");
        picture.write(&exr, f32::INFINITY).unwrap();
        let floats = dir.path().join("a-picture-3x2.f32");
        let bytes: Vec<u8> = (0..6).flat_map(value).flat_map(f32::to_le_bytes).collect();
        std::fs::write(&floats, bytes).unwrap();
        assert_eq!(read(&exr).unwrap(), picture);
        assert_eq!(read(&floats).unwrap(), picture);
    }

    #[test]
    fn a_file_of_another_size_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("a-3x2.f32");
        std::fs::write(&file, [0; 80]).unwrap();
        assert!(read(&file).is_err());
    }
}
