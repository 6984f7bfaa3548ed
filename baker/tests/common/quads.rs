//! A .glb of quadrilaterals with materials.

use glam::Vec3;
use std::fmt::Write;

/// A parallelogram around `middle` with half sides `u` and `v`; the front is on the side of their cross product.
#[derive(Clone, Copy)]
pub struct Quad {
    pub middle: Vec3,
    pub u: Vec3,
    pub v: Vec3,
    pub material: usize,
}

/// Bytes of the file. `materials` are JSON objects; `picture` is the PNG of texture 0, mapped onto every
/// quadrilateral; `more` holds further JSON members of the root, with a comma before each.
pub fn glb(quads: &[Quad], materials: &[String], picture: Option<&[u8]>, more: &str) -> Vec<u8> {
    let mut bin: Vec<u8> = Vec::new();
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    for quad in quads {
        for (a, b) in corners {
            let place = quad.middle + quad.u * a + quad.v * b;
            bin.extend(place.to_array().iter().flat_map(|x| x.to_le_bytes()));
        }
    }
    let uvs = bin.len();
    bin.extend(corners.iter().flat_map(|(a, b)| [0.5 + 0.5 * a, 0.5 + 0.5 * b]).flat_map(f32::to_le_bytes));
    let image = bin.len();
    bin.extend(picture.unwrap_or_default());
    let rest = bin.len() - image;
    bin.resize(bin.len().next_multiple_of(4), 0);

    let (mut primitives, mut accessors) = (String::new(), String::new());
    for (i, quad) in quads.iter().enumerate() {
        write!(
            primitives,
            r#"{}{{"attributes":{{"POSITION":{},"TEXCOORD_0":0}},"mode":6,"material":{}}}"#,
            if i > 0 { "," } else { "" },
            i + 1,
            quad.material
        )
        .unwrap();
        write!(
            accessors,
            r#",{{"bufferView":0,"byteOffset":{},"componentType":5126,"count":4,"type":"VEC3"}}"#,
            48 * i
        )
        .unwrap();
    }
    let pictures = match picture {
        Some(_) => {
            r#","images":[{"bufferView":2,"mimeType":"image/png"}],"textures":[{"source":0,"sampler":0}],
            "samplers":[{"magFilter":9728}]"#
        }
        None => "",
    };
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{primitives}]}}],"materials":[{}],
        "accessors":[{{"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"}}{accessors}],
        "bufferViews":[{{"buffer":0,"byteLength":{uvs}}},{{"buffer":0,"byteOffset":{uvs},"byteLength":32}},
        {{"buffer":0,"byteOffset":{image},"byteLength":{}}}],"buffers":[{{"byteLength":{}}}]{pictures}{more}}}"#,
        materials.join(","),
        rest.max(1),
        bin.len().max(image + 4)
    );
    bin.resize(bin.len().max(image + 4), 0);
    let mut json = json.into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = Vec::new();
    out.extend(b"glTF");
    out.extend(2u32.to_le_bytes());
    out.extend((28 + json.len() as u32 + bin.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &bin)] {
        out.extend((chunk.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(chunk);
    }
    out
}
