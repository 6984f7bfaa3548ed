//! `rebounce bake --solver radiosity`: files whose nodes move, what is said of them, and pictures of what has moved.

use crate::common::program::{done, rebounce, said};
use rebounce_shared::baked::BakedScene;
use std::path::Path;

const SHOT: &str = r#"{"size":[32,18],"camera":{"position":[0,0,1.8],"target":[0,0,-1],"yfov_deg":70},
    "lights":[{"type":"point","position":[0.2,1.2,0.1],"intensity":4,"color":[1,1,1]}]}"#;
const MOVE: &str = r#""size":[32,18],"move":{"box":{"translation":[1,0.5,-0.5],"rotation_y_deg":30}}"#;

/// Writes a room with a box in it that lets a quarter of the light through: a cube with two-sided faces, twice.
fn write_room(folder: &Path) {
    let corner = |i: u32| [i & 1, i >> 1 & 1, i >> 2 & 1].map(|bit| bit as f32 - 0.5);
    let faces: [[u32; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut bytes: Vec<u8> = (0..8).flat_map(corner).flat_map(f32::to_le_bytes).collect();
    let triangles = faces.iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d]);
    bytes.extend(triangles.flat_map(|i| i.to_le_bytes()));
    std::fs::write(folder.join("cube.bin"), &bytes).unwrap();
    let gltf = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],
        "nodes":[{"name":"room","mesh":0,"scale":[4,4,4]},
            {"name":"box","mesh":1,"scale":[0.8,0.8,0.8],"translation":[-0.6,-0.8,-0.7]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]},
            {"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":1}]}],
        "materials":[{"doubleSided":true,"pbrMetallicRoughness":{"baseColorFactor":[0.6,0.5,0.4,1],"metallicFactor":0}},
            {"doubleSided":true,"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.4,0.75],"metallicFactor":0}}],
        "accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":8,"min":[-0.5,-0.5,-0.5],"max":[0.5,0.5,0.5]},
            {"bufferView":1,"componentType":5125,"type":"SCALAR","count":36}],
        "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":144}],
        "buffers":[{"uri":"cube.bin","byteLength":240}]}"#;
    std::fs::write(folder.join("room.gltf"), gltf).unwrap();
}

#[test]
fn nodes_are_listed_and_pictures_follow_their_motion() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write_room(at);
    let write = |name: &str, text: String| std::fs::write(at.join(name), text).unwrap();
    write("shot.json", SHOT.into());
    let moved = SHOT.replacen(r#""size":[32,18]"#, MOVE, 1);
    write("odd.json", moved.replace("box", "bxo"));
    write("moved.json", moved);
    let bake = ["bake", "room.gltf", "--solver", "radiosity", "--preset", "draft", "--functions", "1K"];
    for out in ["a.rbn", "b.rbn"] {
        done(at, &[&bake[..], &["--viewpoint", "0,0,1.8", "-o", out]].concat());
    }
    let bytes = |name: &str| std::fs::read(at.join(name)).unwrap();
    assert!(bytes("a.rbn") == bytes("b.rbn"), "two bakes differ");
    let baked = BakedScene::from_bytes(&bytes("a.rbn")).unwrap();
    let [room, glass] = [1, 2].map(|group| {
        let material = baked.groups.of_material.iter().position(|own| *own == group);
        baked.groups.transmittance_of(material.unwrap() as u32)
    });
    assert!(room == 0.0 && (glass - 0.25).abs() < 1e-3, "{room}, {glass}");
    let told = done(at, &["info", "a.rbn"]);
    for part in ["none; radiosity", "\"room\"", "\"box\"", "may move"] {
        assert!(told.contains(part), "no {part} in {told}");
    }
    let listed: serde_json::Value = serde_json::from_str(&done(at, &["info", "a.rbn", "--json"])).unwrap();
    assert_eq!(listed["by_radiosity"], true);
    assert_eq!((&listed["nodes"][0]["name"], &listed["groups"][1]["name"]), (&"room".into(), &"box".into()));
    let all: u64 = (0..2).filter_map(|i| listed["groups"][i]["points"].as_u64()).sum();
    assert_eq!(Some(all), listed["points"].as_u64());
    let picture = |shot: &str, out: &str| {
        done(at, &["render", "a.rbn", "--shot", shot, "--only", "indirect", "--spp", "4", "-o", out]);
        rebounce::io::picture::exr::read(&at.join(out)).unwrap().pixels
    };
    let (rest, moved) = (picture("shot.json", "rest.exr"), picture("moved.json", "moved.exr"));
    assert!(rest.iter().all(|pixel| pixel.min_element() > 0.0), "a dark pixel in a closed room");
    let other =
        rest.iter().zip(&moved).filter(|(a, b)| (**a - **b).abs().max_element() > 0.05 * a.max_element());
    assert!(other.count() > rest.len() / 20, "the box has not moved");
    let odd = rebounce(at, &["render", "a.rbn", "--shot", "odd.json", "-o", "odd.png"]);
    assert_eq!(odd.status.code(), Some(1));
    for word in ["a.rbn", "bxo", "box"] {
        assert!(said(&odd).contains(word), "no {word}: {}", said(&odd));
    }
    assert!(!at.join("odd.png").exists());
}
