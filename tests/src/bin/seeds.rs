//! `seeds FOLDER`: what the fuzz targets begin with, a folder each. Run by `cargo xtask fuzz`.

use anyhow::{Context, Result};
use rebounce::bake::{BakeSettings, Preset, bake};
use rebounce::scene;
use rebounce_shared::rbn::container;
use std::path::{Path, PathBuf};

fn main() -> Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).context("which folder?")?);
    let write = |target: &str, name: &str, bytes: &[u8]| {
        let folder = folder.join(target);
        std::fs::create_dir_all(&folder)
            .and_then(|()| std::fs::write(folder.join(name), bytes))
            .with_context(|| folder.display().to_string())
    };
    for (name, functions) in [("builtin:cornell-box", 40), ("builtin:two-rooms-door", 120)] {
        let file = small(name, functions)?;
        let short = name.trim_start_matches("builtin:");
        write("file", short, &file)?;
        let sections = container::read(&file)?;
        let mut together = Vec::new();
        for section in &sections {
            let bytes = &file[section.offset..section.offset + section.len];
            together.extend_from_slice(&(bytes.len() as u16).to_le_bytes());
            together.extend_from_slice(bytes);
            if matches!(&section.name, b"LINK" | b"LATL") {
                write("links", &format!("{short}-{}", section.name.escape_ascii()), bytes)?;
            }
        }
        write("section", short, &together)?;
    }
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../baker/tests/gltf");
    for entry in std::fs::read_dir(&fixtures).with_context(|| fixtures.display().to_string())? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "glb") {
            let name = path.file_name().and_then(|name| name.to_str()).context("a fixture's name")?;
            write("gltf", name, &std::fs::read(&path)?)?;
        }
    }
    let shot = r#"{"size": [8, 4], "camera": {"position": [0, 1, 2], "target": [0, 0, 0], "up": [0, 1, 0],
        "yfov_deg": 45}, "lights": [{"type": "spot", "position": [0, 1, 0], "direction": [0, -1, 0],
        "intensity": 3, "color": [1, 1, 1], "inner_cone_deg": 20, "outer_cone_deg": 30}]}"#;
    write("shot", "spot", shot.as_bytes())
}

/// A bake of a few functions, whose sections are shorter than 64 kB.
fn small(name: &str, functions: usize) -> Result<Vec<u8>> {
    let mut settings = BakeSettings::new(Preset::Draft);
    (settings.place.levels, settings.place.functions) = (3, functions);
    settings.operator.rays = vec![64];
    settings.operator.later_levels = 1;
    let (file, _) = bake(&scene::load(name)?, &settings.normalised(), &())?;
    Ok(file.to_bytes()?)
}
