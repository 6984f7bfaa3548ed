//! `rebounce export` as a child process: its files, and what it refuses.

use crate::common::program;
use program::{names, rebounce, said};
use std::path::Path;

/// Asserts success; returns what was said.
fn works(folder: &Path, args: &[&str]) -> String {
    let output = rebounce(folder, args);
    assert!(output.status.success(), "{args:?}: {}", said(&output));
    said(&output)
}

/// Asserts failure with a sentence that contains `words`, and no new file.
fn fails(folder: &Path, code: i32, args: &[&str], words: &[&str]) {
    let before = names(folder);
    let output = rebounce(folder, args);
    assert_eq!(output.status.code(), Some(code), "{args:?}: {}", said(&output));
    for word in words {
        assert!(said(&output).contains(word), "no {word}: {}", said(&output));
    }
    assert!(!said(&output).contains("panicked"), "{}", said(&output));
    assert_eq!(names(folder), before, "{args:?}");
}

fn baked() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let few = ["--preset", "draft", "--functions", "200", "--levels", "2", "-o", "room.rbn"];
    works(folder.path(), &[&["bake", "builtin:cornell-box"], &few[..]].concat());
    folder
}

#[test]
fn three_forms_are_written_and_load_again() {
    let folder = baked();
    let at = folder.path();
    let told = works(at, &["export", "room.rbn", "-o", "lit.glb"]);
    assert!(told.contains("20.000 texels a metre") && told.contains("exposed by"), "{told}");
    let told =
        works(at, &["export", "room.rbn", "-o", "map.glb", "--lightmap-texture", "--texels-per-metre", "5"]);
    assert!(told.contains("map.exr") && told.contains("5.000 texels a metre"), "{told}");
    let told =
        works(at, &["export", "room.rbn", "-o", "colours.glb", "--vertex-colours", "--exposure", "0.5"]);
    assert!(told.contains("exposed by 0.500000"), "{told}");
    assert_eq!(names(at), ["colours.glb", "lit.glb", "map.exr", "map.glb", "room.rbn"]);
    for file in ["colours.glb", "lit.glb", "map.glb"] {
        let scene = rebounce::io::load(at.join(file).to_str().unwrap()).unwrap();
        assert_eq!(scene.triangles.len(), 30, "{file}");
    }
    let map = rebounce::io::picture::exr::read(&at.join("map.exr")).unwrap();
    assert!(map.pixels.iter().all(|pixel| pixel.is_finite() && pixel.min_element() >= 0.0));
    assert!(map.pixels.iter().any(|pixel| pixel.max_element() > 1.0), "irradiance near a lamp of 120 cd");
}

#[test]
fn a_texture_is_made_coarser_where_nobody_said_how_fine_it_is_to_be() {
    let folder = baked();
    let told = works(folder.path(), &["export", "room.rbn", "-o", "lit.glb", "--max-size", "128"]);
    assert!(told.contains("20 texels a metre do not fit 128 x 128; --max-size allows more"), "{told}");
}

#[test]
fn what_cannot_be_done_is_said_in_a_sentence() {
    let folder = baked();
    let at = folder.path();
    std::fs::write(at.join("room.glb"), b"glTF, or so").unwrap();
    std::fs::create_dir(at.join("folder.glb")).unwrap();
    fails(at, 1, &["export", "room.glb", "-o", "lit.glb"], &["room.glb"]);
    fails(at, 1, &["export", "missing.rbn", "-o", "lit.glb"], &["cannot read missing.rbn"]);
    fails(at, 1, &["export", "room.rbn", "-o", "lit.gltf"], &["lit.gltf", "must end in .glb"]);
    fails(at, 1, &["export", "room.rbn", "-o", "folder.glb"], &["folder.glb is a folder"]);
    fails(at, 1, &["export", "room.rbn", "-o", "none/lit.glb"], &["there is no folder none"]);
    let fine = ["export", "room.rbn", "-o", "lit.glb", "--texels-per-metre", "5000"];
    fails(
        at,
        1,
        &fine,
        &["5000 texels a metre", "do not fit a texture of 2048 x 2048", "give --texels-per-metre"],
    );
    let large = ["export", "room.rbn", "-o", "lit.glb", "--max-size", "100000"];
    fails(at, 2, &large, &["100000 is not in 64..=8192"]);
    let none = ["export", "room.rbn", "-o", "lit.glb", "--texels-per-metre", "0"];
    fails(at, 2, &none, &["give a number over zero"]);
    let both = ["export", "room.rbn", "-o", "lit.glb", "--vertex-colours", "--lightmap-texture"];
    fails(at, 2, &both, &["cannot be used with"]);
}
