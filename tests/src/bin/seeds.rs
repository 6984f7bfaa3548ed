//! `seeds FOLDER`: writes the seeds of the fuzz targets, a folder per target. Run by `cargo xtask fuzz`.

use anyhow::{Context, Result};
use rebounce::bake::{BakeSettings, Baker, Checkpoint, Identity, Preset};
use rebounce_shared::rbn::container;
use rebounce_tests::small::{charted, everything, lit, object, settings, shining, small, solved, walking};
use std::path::{Path, PathBuf};

fn main() -> Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).context("which folder?")?);
    let write = |target: &str, name: &str, bytes: &[u8]| {
        let folder = folder.join(target);
        std::fs::create_dir_all(&folder)
            .and_then(|()| std::fs::write(folder.join(name), bytes))
            .with_context(|| folder.display().to_string())
    };
    let seeds = [
        ("cornell-box", small("builtin:cornell-box", 12)?),
        ("two-rooms-door", small("builtin:two-rooms-door", 40)?),
        ("everything", everything(12)?),
        ("lit", lit(40)?),
        ("solved", solved(12)?),
        ("charted", charted(12)?),
        ("shining", shining(40)?),
        ("object", object(40)?),
        ("walking", walking(40)?),
    ];
    for (short, scene) in seeds {
        let file = scene.to_bytes()?;
        write("file", short, &file)?;
        write("scene", short, &file)?;
        // The first byte of a seed selects the section.
        for section in container::read(&file)? {
            const TOLD: [&[u8; 4]; 32] = [
                b"META", b"VERT", b"INDX", b"PNTS", b"CUTS", b"LINK", b"LATL", b"INST", b"COPY", b"SRCS",
                b"SRCL", b"LGRP", b"LVAL", b"LMAP", b"LMUV", b"LMOF", b"LMTX", b"GLSY", b"GLPT", b"GLCL",
                b"GLWT", b"GLBS", b"DTLY", b"DTCL", b"DTWT", b"DTBS", b"CMLY", b"CMTX", b"RIGL", b"RIGV",
                b"RIGM", b"RIGP",
            ];
            let told = (0u8..).zip(TOLD).find(|(_, name)| **name == section.name);
            let Some((which, _)) = told else { continue };
            let bytes = &file[section.offset..section.offset + section.len];
            let seed = format!("{short}-{}", section.name());
            write("section", &seed, &[&[which], bytes].concat())?;
            if matches!(&section.name, b"LINK" | b"LATL" | b"SRCL") {
                write("links", &seed, bytes)?;
            }
        }
    }
    write("checkpoint", "cornell-box", &checkpoint(&folder)?)?;
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
    write("shot", "spot", shot.as_bytes())?;
    // A step, a hole, a fold, a seam, a triangle across.
    write("simplify", "sheet", &[0, 40, 64, 0, 7, 9, 0, 0, 1, 30, 2, 2, 4, 77, 0, 0, 5, 3, 60, 30])
}

/// Returns the checkpoint of a small bake with the identity of a draft of the Cornell box, as expected by the target.
fn checkpoint(folder: &Path) -> Result<Vec<u8>> {
    let scene = rebounce::io::load("builtin:cornell-box")?;
    let identity = Identity::new(&scene, &BakeSettings::new(Preset::Draft));
    let path = folder.join("cornell-box.partial");
    let kept = Checkpoint::create(&path, &identity)?;
    Baker::new(&settings(20)).checkpoint(Some(&kept)).bake(&scene)?;
    kept.flush()?;
    let bytes = std::fs::read(&path)?;
    kept.remove();
    Ok(bytes)
}
