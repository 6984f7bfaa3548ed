//! Pictures of linear radiance, read from files.

use anyhow::{Context, Result, bail};
use exr::prelude::{Vec2, read_first_rgba_layer_from_file};
use std::path::Path;

/// Linear radiance, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct FloatPicture {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Red, green, blue, alpha.
    pub rgba: Vec<[f32; 4]>,
}

/// Reads an .exr, or a .f32: RGBA little-endian floats of a picture whose name ends in `WxH.f32`.
///
/// # Errors
/// If the file cannot be read or is neither.
pub fn read(path: &Path) -> Result<FloatPicture> {
    let name = || path.display().to_string();
    match path.extension().and_then(|e| e.to_str()) {
        Some("exr") => read_exr(path),
        Some("f32") => read_floats(path),
        _ => bail!("{}: neither .exr nor .f32", name()),
    }
    .with_context(name)
}

fn read_exr(path: &Path) -> Result<FloatPicture> {
    let image = read_first_rgba_layer_from_file(
        path,
        |size: Vec2<usize>, _| FloatPicture { size: [size.0, size.1], rgba: vec![[0.0; 4]; size.area()] },
        |picture, at, (r, g, b, a): (f32, f32, f32, f32)| {
            let width = picture.size[0];
            picture.rgba[at.1 * width + at.0] = [r, g, b, a];
        },
    )?;
    Ok(image.layer_data.channel_data.pixels)
}

fn read_floats(path: &Path) -> Result<FloatPicture> {
    let stem = path.file_stem().and_then(|s| s.to_str()).unwrap_or_default();
    let size = stem.rsplit('-').next().and_then(|size| size.split_once('x'));
    let Some((Ok(width), Ok(height))) = size.map(|(w, h)| (w.parse::<usize>(), h.parse::<usize>())) else {
        bail!("the name does not end in -WIDTHxHEIGHT.f32");
    };
    let bytes = std::fs::read(path)?;
    if bytes.len() != width * height * 16 {
        bail!("{} bytes are no {width} by {height} pixels of 16", bytes.len());
    }
    let rgba = bytes
        .chunks_exact(16)
        .map(|pixel| std::array::from_fn(|c| f32::from_le_bytes(std::array::from_fn(|b| pixel[c * 4 + b]))))
        .collect();
    Ok(FloatPicture { size: [width, height], rgba })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_kinds_of_file_give_the_same_picture() {
        let dir = tempfile::tempdir().unwrap();
        let value = |x: usize, y: usize| [x as f32 + 0.25, y as f32 * 100.0, 1e-3, 1.0];
        let exr = dir.path().join("picture.exr");
        exr::prelude::write_rgba_file(&exr, 3, 2, |x, y| <(f32, f32, f32, f32)>::from(value(x, y))).unwrap();
        let floats = dir.path().join("a-picture-3x2.f32");
        let bytes: Vec<u8> = (0..6).flat_map(|i| value(i % 3, i / 3)).flat_map(f32::to_le_bytes).collect();
        std::fs::write(&floats, bytes).unwrap();
        let picture = read(&exr).unwrap();
        assert_eq!(picture, read(&floats).unwrap());
        assert_eq!(picture.rgba[4], value(1, 1));
    }

    #[test]
    fn a_file_of_another_size_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("a-3x2.f32");
        std::fs::write(&file, [0; 80]).unwrap();
        assert!(read(&file).is_err());
    }
}
