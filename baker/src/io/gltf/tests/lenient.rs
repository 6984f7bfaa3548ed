//! Files that violate glTF but that browsers and importers read.

use super::*;
use std::path::Path;

/// JSON of the test square, with `buffer` as the members of the buffer.
fn file(buffer: &str) -> String {
    let whole = square("", r#","indices":1"#, "");
    let from = whole.find(r#""uri":"#).unwrap();
    let to = whole[from..].find('}').unwrap() + from;
    format!("{}{buffer}{}", &whole[..from], &whole[to..])
}

fn bytes() -> Vec<u8> {
    let positions = [[0f32, 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];
    let mut bytes: Vec<u8> = positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0u8, 1, 2, 0, 2, 3]);
    bytes
}

fn is_the_square(scene: &Scene) -> bool {
    (scene.triangles.len(), total_area(scene), scene.origin) == (2, 1.0, [0.5, 0.5, 0.0])
}

#[test]
fn null_and_minus_one_are_none() {
    let whole = square(r#","name":"node""#, r#","indices":1"#, "");
    for (from, to) in [
        (r#""name":"node""#, r#""name":null,"children":null,"matrix":null,"extensions":null,"camera":null"#),
        (r#""name":"node""#, r#""camera":-1,"skin":-1,"children":[-1],"extras":null"#),
        (r#""name":"node""#, r#""extensions":{"KHR_lights_punctual":{"light":-1}}"#),
        (r#""name":"node""#, r#""extensions":{"KHR_lights_punctual":null,"EXT_mesh_gpu_instancing":null}"#),
        (r#""indices":1"#, r#""indices":1,"material":-1,"mode":null,"targets":null"#),
        (r#""indices":1"#, r#""indices":1,"material":null,"extensions":{"KHR_draco_mesh_compression":null}"#),
        (r#""POSITION":0"#, r#""POSITION":0,"NORMAL":-1,"TEXCOORD_0":null"#),
        (r#""name":"square""#, r#""name":null,"weights":null"#),
        (r#""type":"VEC3""#, r#""type":"VEC3","sparse":null,"byteOffset":null,"normalized":null"#),
        (r#""scenes""#, r#""scene":-1,"scenes""#),
        (r#""scenes""#, r#""images":null,"textures":[null,{"source":-1,"sampler":null}],"scenes""#),
    ] {
        assert!(whole.contains(from), "{from}");
        let scene = parse(&whole.replacen(from, to, 1)).unwrap_or_else(|error| panic!("{to}: {error}"));
        assert!(is_the_square(&scene) && scene.lights.is_empty(), "{to}");
    }
    // A null element counts as a list index.
    let counted = whole.replacen(r#""nodes":[{"#, r#""nodes":[null,{"#, 1).replacen("[0]", "[1,null]", 1);
    assert!(is_the_square(&parse(&counted).unwrap()));
    // A missing required index is an error with the JSON path.
    for (from, to, says) in [
        (r#""buffer":0"#, r#""buffer":-1"#, "bufferViews[0].buffer"),
        (r#""POSITION":0"#, r#""POSITION":"0""#, "meshes[0].primitives[0].attributes.POSITION"),
        (r#""mesh":0"#, r#""mesh":-2"#, "nodes[0].mesh"),
    ] {
        let error = parse(&whole.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.contains(says) && error.contains("test.gltf"), "{error}");
    }
}

#[test]
fn textures_that_are_none_are_none() {
    for none in [r#"null"#, r#"{"index":-1}"#] {
        let material = format!(
            r#""pbrMetallicRoughness":{{"baseColorFactor":[0.5,0.5,0.5,1],"baseColorTexture":{none},
            "metallicRoughnessTexture":{none}}},"normalTexture":{none},"emissiveTexture":{none},"alphaMode":null,
            "doubleSided":null,"occlusionTexture":{none}"#
        );
        let scene = textured_with(&material);
        assert!(scene.textures.is_empty() && scene.materials[0].base_color == [0.5, 0.5, 0.5, 1.0], "{none}");
    }
}

#[test]
fn whole_numbers_may_be_written_with_a_point() {
    let whole = square(r#","rotation":[0.0,-0.0,0.0,1.0]"#, r#","indices":1,"mode":4.0"#, "");
    let digits = |json: &str| {
        [r#""bufferView":0"#, r#""bufferView":1"#, r#""count":4"#, r#""count":6"#, r#""componentType":5126"#]
            .iter()
            .chain(&[
                r#""byteLength":48"#,
                r#""byteOffset":48"#,
                r#""mesh":0"#,
                r#""indices":1"#,
                r#""buffer":0"#,
            ])
            .fold(json.to_owned(), |json, number| json.replace(number, &format!("{number}.0")))
    };
    let json = digits(&whole).replace(r#""nodes":[0]"#, r#""nodes":[0.0]"#);
    assert!(json.matches(".0").count() > 15, "{json}");
    assert!(is_the_square(&parse(&json).unwrap()));
}

#[test]
fn a_stride_of_zero_is_none() {
    let whole = square("", r#","indices":1"#, "");
    let json = whole.replace(r#""byteLength":48"#, r#""byteLength":48,"byteStride":0"#);
    assert!(is_the_square(&parse(&json).unwrap()));
}

#[test]
fn files_beside_are_found_by_bent_names_and_that_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    std::fs::create_dir(dir.join("geometry data")).unwrap();
    std::fs::write(dir.join("geometry data/Square.bin"), bytes()).unwrap();
    std::fs::write(dir.join("beside.bin"), bytes()).unwrap();
    let load_with = |uri: &str| {
        let path = dir.join("scene.gltf");
        std::fs::write(&path, file(&format!(r#""uri":"{uri}""#))).unwrap();
        load(&crate::io::files::Disk, &path, &LoadOptions::default())
    };
    for (uri, said) in [
        (r"geometry%20data/Square.bin", false),
        (r"geometry data/Square.bin?version=2", false),
        (r"geometry data\\Square.bin", true),
        (r"Geometry%20Data/square.BIN", true),
        (r"C:\\Users\\me\\beside.bin", true),
        (r"file:///home/nobody/BESIDE.bin", true),
    ] {
        let scene = load_with(uri).unwrap_or_else(|error| panic!("{uri}: {error}"));
        assert!(is_the_square(&scene) && scene.left_out.is_empty(), "{uri}");
        let notes = scene.notes.iter().filter(|note| note.to_lowercase().contains(".bin, read as "));
        assert_eq!(notes.count(), usize::from(said), "{uri}: {:?}", scene.notes);
    }
    for (uri, says) in [("gone.bin", "refers to"), ("https://example.com/gone.bin", "on the network")] {
        let error = load_with(uri).unwrap_err().to_string();
        assert!(error.contains(says) && error.contains("gone.bin"), "{error}");
    }
}

#[test]
fn zeros_after_json_and_a_mark_before_it_are_no_part_of_it() {
    let json = square("", r#","indices":1"#, "");
    for (before, after) in [("", "\0\0\0"), ("\u{feff}", ""), ("\u{feff}", " \n\0"), ("", "   ")] {
        let json = format!("{before}{json}{after}");
        assert!(is_the_square(&from_bytes("text.gltf", json.as_bytes()).unwrap()));
        let mut glb = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
        glb.extend((json.len() as u32).to_le_bytes());
        glb.extend(b"JSON");
        glb.extend(json.as_bytes());
        assert!(is_the_square(&from_bytes("packed.glb", &glb).unwrap()));
    }
    // Invalid UTF-8 in a name loses only the letters.
    let latin = json.replacen("square", "carr\u{e9}", 1).chars().map(|c| c as u8).collect::<Vec<_>>();
    assert!(is_the_square(&from_bytes("latin.gltf", &latin).unwrap()));
}

#[test]
fn another_gltf_is_named_and_not_parsed() {
    let old = r#"{"asset":{"version":"1.0"},"meshes":{"m":{"primitives":[]}},"techniques":{}}"#;
    let unnamed = r#"{"meshes":{"m":{"primitives":[]}},"techniques":{"t":{}},"nodes":{}}"#;
    let numbered = r#"{"asset":{"version":1.0},"nodes":{}}"#;
    for json in [old, unnamed, numbered] {
        let error = parse(json).unwrap_err();
        assert!(matches!(error, SceneError::Old { .. }), "{error}");
        let error = error.to_string();
        assert!(error.contains("test.gltf is glTF 1.0") && error.contains("gltf-pipeline"), "{error}");
    }
    let error =
        from_bytes("old.glb", b"glTF\x01\0\0\0\x20\0\0\0\x0c\0\0\0\0\0\0\0{}").unwrap_err().to_string();
    assert!(error.contains("old.glb is glTF 1.0"), "{error}");
    let whole = square("", r#","indices":1"#, "");
    let asset = |members: &str| parse(&whole.replacen(r#""version":"2.0""#, members, 1));
    for (members, says) in [
        (r#""version":"3.0""#, "\"3.0\""),
        (r#""version":"2.1","minVersion":"2.1""#, "readers of glTF 2.1"),
        (r#""generator":"none""#, "asset.version"),
    ] {
        let error = asset(members).unwrap_err().to_string();
        assert!(error.contains(says) && error.contains("glTF 2.0"), "{error}");
    }
    for members in [r#""version":"2.1","minVersion":"2.0""#, r#""version":2.0"#, r#""version":"2""#] {
        assert!(is_the_square(&asset(members).unwrap()), "{members}");
    }
}

#[test]
fn the_cases_of_other_programs_are_read() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/cases");
    if !cases.is_dir() {
        return;
    }
    for (name, notes) in [("backslash", 1), ("stride0", 0), ("nulls", 0)] {
        let scene = load(
            &crate::io::files::Disk,
            &cases.join(name).join(format!("{name}.gltf")),
            &LoadOptions::default(),
        )
        .unwrap_or_else(|e| panic!("{e}"));
        assert!(scene.triangles.len() >= 12 && scene.lights.len() == 1 && scene.cameras.len() == 1, "{name}");
        assert_eq!((scene.notes.len(), scene.left_out.len()), (notes, 0), "{name}: {:?}", scene.notes);
    }
}
