mod lenient;
mod meshes;
mod node_animation;
mod rest;
mod rig;
mod specular;
mod told;

use super::*;
use crate::geometry::mesh::TriangleSurfaces;
use crate::geometry::{Ray, Surfaces};
use glam::Vec3;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::meta::{Interpolation, Property};

fn parse(json: &str) -> Result<Scene, SceneError> {
    convert(
        &Source::parse(
            "test.gltf".into(),
            &crate::io::files::Disk,
            std::path::PathBuf::new(),
            json.as_bytes(),
        )?,
        "test".into(),
    )
}

fn base64(bytes: &[u8]) -> String {
    let letters = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let sextets = bytes.chunks(3).flat_map(|c| {
        let n = (c[0] as u32) << 16 | (*c.get(1).unwrap_or(&0) as u32) << 8 | *c.get(2).unwrap_or(&0) as u32;
        [18, 12, 6, 0].into_iter().take(c.len() + 1).map(move |s| letters[(n >> s & 63) as usize] as char)
    });
    sextets.collect()
}

/// A mesh with a unit square in the plane z = 0 as positions, seen from +z; `node`, `more` and `primitive` are JSON
/// members of the node, the root and the primitive.
fn square(node: &str, primitive: &str, more: &str) -> String {
    let positions = [[0f32, 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]];
    let mut bytes: Vec<u8> = positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0u8, 1, 2, 0, 2, 3]);
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0{node}}}],
        "meshes":[{{"name":"square","primitives":[{{"attributes":{{"POSITION":0}}{primitive}}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}},
                     {{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":6}}],
        "buffers":[{{"byteLength":54,"uri":"data:application/octet-stream;base64,{}"}}]{more}}}"#,
        base64(&bytes)
    )
}

fn total_area(scene: &Scene) -> f32 {
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| scene.positions[i as usize]);
        0.5 * (b - a).cross(c - a).length()
    };
    scene.triangles.iter().map(area).sum()
}

#[test]
fn every_way_to_list_triangles_gives_the_same_surface() {
    for primitive in [r#","indices":1"#, r#","mode":6"#] {
        let scene = parse(&square("", primitive, "")).unwrap();
        assert_eq!((scene.triangles.len(), total_area(&scene)), (2, 1.0), "{primitive}");
        assert!(scene.normals.iter().all(|&n| n == Vec3::Z), "{primitive}");
        assert_eq!(scene.origin, [0.5, 0.5, 0.0]);
    }
    // Strip: 0 1 2, then 1 3 2 – both counter-clockwise in corner order.
    let strip = parse(&square("", r#","mode":5"#, "")).unwrap();
    assert_eq!(strip.triangles.len(), 2);
    assert_eq!(strip.normals[0], Vec3::Z);
}

#[test]
fn a_mirrored_node_keeps_its_front() {
    let plain = parse(&square("", r#","indices":1"#, "")).unwrap();
    let mirrored = parse(&square(r#","scale":[-2,1,1]"#, r#","indices":1"#, "")).unwrap();
    for (scene, width) in [(plain, 1.0), (mirrored, 2.0)] {
        assert_eq!(total_area(&scene), width);
        let surfaces = TriangleSurfaces::from_scene(&scene);
        let ray =
            Ray { origin: Vec3::new(0.1, 0.2, 1.0), direction: -Vec3::Z, max_distance: 2.0, spread: 0.0 };
        let hit = surfaces.cast(&ray, 0).unwrap();
        assert_eq!((hit.normal, hit.albedo), (Vec3::Z, Vec3::ONE));
    }
}

#[test]
fn millimetres_far_from_the_origin_keep_their_shape() {
    let node = r#","translation":[1e7,-2e7,3e7],"scale":[0.001,0.001,0.001]"#;
    let scene = parse(&square(node, r#","indices":1"#, "")).unwrap();
    assert!((total_area(&scene) - 1e-6).abs() < 1e-9);
    assert!((scene.origin[0] - 1e7).abs() < 0.01);
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let ray =
        Ray { origin: Vec3::new(1e-4, 2e-4, 1e-3), direction: -Vec3::Z, max_distance: 1.0, spread: 0.0 };
    assert!((surfaces.cast(&ray, 0).unwrap().distance - 1e-3).abs() < 1e-8);
}

#[test]
fn a_matrix_and_its_parts_are_the_same() {
    let parts =
        r#","translation":[1,2,3],"rotation":[0,0.7071067811865476,0,0.7071067811865476],"scale":[2,3,4]"#;
    let matrix = r#","matrix":[0,0,-2,0, 0,3,0,0, 4,0,0,0, 1,2,3,1]"#;
    let (a, b) = (parse(&square(parts, "", "")).unwrap(), parse(&square(matrix, "", "")).unwrap());
    assert!(a.positions.iter().zip(&b.positions).all(|(p, q)| p.distance(*q) < 1e-6));
    assert!(a.normals[0].distance(Vec3::X) < 1e-6 && b.normals[0].distance(Vec3::X) < 1e-6);
}

#[test]
fn sparse_values_replace_those_of_the_buffer() {
    let json = square("", "", "").replacen(
        r#""count":4,"type":"VEC3""#,
        r#""count":4,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":3}}"#,
        1,
    );
    // Index 2 of the list of indices is the number 2; the value is vertex 1.
    let views =
        r#"{"buffer":0,"byteOffset":50,"byteLength":1},{"buffer":0,"byteOffset":12,"byteLength":12}]"#;
    let json = json.replacen(r#""byteLength":6}]"#, &format!(r#""byteLength":6}},{views}"#), 1);
    let scene = parse(&json).unwrap_err();
    assert!(matches!(scene, SceneError::Empty { .. }), "corners 0, 1, 1 have no area: {scene}");
}

#[test]
fn lights_and_cameras_stand_where_their_nodes_are() {
    let node = r#","translation":[0,5,0],"rotation":[-0.7071067811865476,0,0,0.7071067811865476],"camera":0,
        "extensions":{"KHR_lights_punctual":{"light":0}}"#;
    let more = r#","cameras":[{"type":"perspective","perspective":{"yfov":1.0}}],
        "extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","intensity":7,"spot":{"outerConeAngle":0.5}}]}}"#;
    let scene = parse(&square(node, "", more)).unwrap();
    let Light::Spot { position, direction, outer_cone_deg, inner_cone_deg, intensity, .. } = &scene.lights[0]
    else {
        panic!("{:?}", scene.lights)
    };
    assert_eq!((*position, *intensity, *inner_cone_deg), ([0.0, 5.0, 0.0], 7.0, Some(0.0)));
    assert!((direction[1] + 1.0).abs() < 1e-9 && (outer_cone_deg - 0.5f64.to_degrees()).abs() < 1e-9);
    let camera = &scene.cameras[0];
    assert!(camera.target[1] < 5.0 && (camera.yfov_deg - 1f64.to_degrees()).abs() < 1e-9);
}

#[test]
fn lights_and_cameras_have_their_own_names_or_those_of_their_nodes() {
    for (own, named) in [("", "node"), (r#""name":"own","#, "own"), (r#""name":"","#, "node")] {
        let node = r#","name":"node","camera":0,"extensions":{"KHR_lights_punctual":{"light":0}}"#;
        let more = format!(
            r#","cameras":[{{{own}"type":"perspective","perspective":{{"yfov":1.0}}}}],
            "extensions":{{"KHR_lights_punctual":{{"lights":[{{{own}"type":"point"}}]}}}}"#
        );
        let scene = parse(&square(node, "", &more)).unwrap();
        assert_eq!(scene.light_names, [named]);
        assert_eq!(scene.camera_names, [named]);
    }
}

/// The square with texture coordinates (x, 1 − y) and a picture of four texels: red, green above
/// blue, white. glTF has v = 0 at the top, so the picture is upright.
fn textured(info: &str) -> Scene {
    textured_with(&format!(
        r#""pbrMetallicRoughness":{{"baseColorFactor":[0.5,1,1,1],"baseColorTexture":{{"index":0{info}}}}}"#
    ))
}

/// The square with texture coordinates; `material` are the members of its material. Texture 0 is a picture of 2 x 2.
fn textured_with(material: &str) -> Scene {
    let mut picture = image::RgbaImage::new(2, 2);
    for (x, y, rgb) in [(0, 0, [255, 0, 0]), (1, 0, [0, 255, 0]), (0, 1, [0, 0, 255]), (1, 1, [255; 3])] {
        picture.put_pixel(x, y, image::Rgba([rgb[0], rgb[1], rgb[2], 255]));
    }
    let mut png = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
    // Normalised bytes: (0, 1), (1, 1), (1, 0), (0, 0), four bytes apart.
    let uvs = [0u8, 255, 0, 0, 255, 255, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0];
    let accessor = r#","count":6,"type":"SCALAR"},{"bufferView":2,"componentType":5121,"normalized":true,"count":4,"type":"VEC2"}]"#;
    let views = r#""byteLength":6},{"buffer":1,"byteLength":16,"byteStride":4}]"#;
    let more = format!(
        r#"}},{{"byteLength":16,"uri":"data:;base64,{}"}}],"images":[{{"uri":"data:image/jpeg;base64,{}"}}],
        "textures":[{{"source":0,"sampler":0}}],"samplers":[{{"magFilter":9728}}],
        "materials":[{{{material}}}]}}"#,
        base64(&uvs),
        base64(&png.into_inner())
    );
    let json = square("", r#","indices":1,"material":0"#, "")
        .replacen(r#""POSITION":0"#, r#""POSITION":0,"TEXCOORD_0":2"#, 1)
        .replacen(r#","count":6,"type":"SCALAR"}]"#, accessor, 1)
        .replacen(r#""byteLength":6}]"#, views, 1);
    let json = json.strip_suffix("}]}").unwrap().to_owned() + &more;
    parse(&json).unwrap()
}

fn albedo_at(scene: &Scene, x: f32, y: f32) -> Vec3 {
    let surfaces = TriangleSurfaces::from_scene(scene);
    let origin = Vec3::new(x - 0.5, y - 0.5, 1.0);
    surfaces.cast(&Ray { origin, direction: -Vec3::Z, max_distance: 2.0, spread: 0.0 }, 0).unwrap().albedo
}

#[test]
fn pictures_stand_upright_and_are_multiplied_with_the_factor() {
    // The picture calls itself a JPEG and is a PNG.
    let scene = textured("");
    assert_eq!((scene.textures[0].meta.mime.as_str(), scene.textures[0].meta.width), ("image/png", 2));
    assert_eq!(albedo_at(&scene, 0.25, 0.75), Vec3::new(0.5, 0.0, 0.0));
    assert_eq!(albedo_at(&scene, 0.75, 0.75), Vec3::new(0.0, 1.0, 0.0));
    assert_eq!(albedo_at(&scene, 0.25, 0.25), Vec3::new(0.0, 0.0, 1.0));
    assert_eq!(albedo_at(&scene, 0.75, 0.25), Vec3::new(0.5, 1.0, 1.0));
}

#[test]
fn texture_transforms_scale_then_rotate_then_move() {
    let info = |t: &str| format!(r#","extensions":{{"KHR_texture_transform":{{{t}}}}}"#);
    let moved = textured(&info(r#""offset":[0.5,0]"#));
    assert_eq!(albedo_at(&moved, 0.25, 0.75), Vec3::new(0.0, 1.0, 0.0));
    let scaled = textured(&info(r#""scale":[2,2]"#));
    assert_eq!(albedo_at(&scaled, 0.375, 0.875), Vec3::new(0.0, 1.0, 0.0));
    // A quarter turn of the coordinates counter-clockwise turns the picture clockwise: (u, v) reads
    // the picture at (v, −u), here (0.25, 0.25) at (0.25, 0.75).
    let turned = textured(&info(r#""rotation":1.5707963267948966"#));
    assert_eq!(albedo_at(&turned, 0.25, 0.75), Vec3::new(0.0, 0.0, 1.0));
}

#[test]
fn required_extensions_that_are_unknown_are_refused_by_name_all_at_once() {
    let required = |names: &str| parse(&square("", "", &format!(r#","extensionsRequired":[{names}]"#)));
    let error = required(r#""VENDOR_odd","KHR_texture_transform","EXT_texture_avif""#).unwrap_err();
    let SceneError::Extension { extensions, .. } = &error else { panic!("{error}") };
    assert_eq!(extensions, &["VENDOR_odd", "EXT_texture_avif"]);
    let error = error.to_string();
    for says in ["VENDOR_odd: export", "EXT_texture_avif: convert", "gltf-transform/cli png", "test.gltf"] {
        assert!(error.contains(says), "{says}: {error}");
    }
    assert!(required(r#""KHR_texture_transform","KHR_draco_mesh_compression""#).is_ok());
}

#[test]
fn broken_files_give_sentences() {
    let whole = square("", r#","indices":1"#, "");
    for (from, to, says) in [
        (r#""count":4"#, r#""count":5"#, "POSITION of mesh 0 (\"square\")"),
        (r#""count":4"#, r#""count":18446744073709551615"#, "outside its buffer view"),
        (r#""count":4"#, r#""count":2"#, "has the index 2, but 2 vertices"),
        (r#""bufferView":1"#, r#""bufferView":9"#, "no buffer view 9"),
        (r#""byteLength":54"#, r#""byteLength":99"#, "buffer 0 should have 99 bytes"),
        (r#""byteOffset":48"#, r#""byteOffset":18446744073709551615"#, "outside its buffer"),
        (r#""nodes":[0]"#, r#""nodes":[3]"#, "no node 3"),
        (r#""mesh":0"#, r#""mesh":0,"children":[0]"#, "its own ancestor"),
        (r#""mesh":0"#, r#""mesh":2"#, "no mesh 2"),
        (r#""indices":1"#, r#""indices":1,"material":4"#, "no material 4"),
        ("base64,AAAAAAAAAAA", "base64,AADAfwAAwH8", "not a finite number"),
        (r#""version":"2.0""#, r#""version":"1.0""#, "glTF 2.0"),
        (r#"{"asset""#, r#"["asset""#, "not a glTF 2.0 file"),
    ] {
        assert!(whole.contains(from), "{from}");
        let error = parse(&whole.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.contains(says) && error.contains("test.gltf"), "{from} became {to}: {error}");
    }
    for len in 0..whole.len() {
        assert!(parse(&whole[..len]).is_err());
    }
}

/// A file with a square, a spot light at node 1, the child of node 2, and animations over `floats`.
fn animated(floats: &[f32], accessors: &str, animations: &str) -> String {
    let bytes: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
    let more = format!(
        r#","extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"spot","intensity":5}}]}}}},
        "animations":[{animations}]"#
    );
    let whole = square("", r#","indices":1"#, &more);
    let buffer = format!(
        r#""buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}},"#,
        bytes.len(),
        base64(&bytes)
    );
    let light =
        r#"{"translation":[0,1,0],"extensions":{"KHR_lights_punctual":{"light":0}}},{"children":[1]}"#;
    whole
        .replacen(r#""nodes":[0]"#, r#""nodes":[0,2]"#, 1)
        .replacen(r#"[{"mesh":0}]"#, &format!(r#"[{{"mesh":0}},{light}]"#), 1)
        .replacen(r#""buffers":["#, &buffer, 1)
        .replacen(
            r#""bufferViews":[{"buffer":0"#,
            &format!(r#""bufferViews":[{{"buffer":0,"byteLength":{}}},{{"buffer":1"#, bytes.len()),
            1,
        )
        .replacen(r#"{"buffer":0,"byteOffset":48"#, r#"{"buffer":1,"byteOffset":48"#, 1)
        .replacen(r#""accessors":[{"bufferView":0"#, r#""accessors":[{"bufferView":1"#, 1)
        .replacen(r#"{"bufferView":1,"componentType":5121"#, r#"{"bufferView":2,"componentType":5121"#, 1)
        .replacen(r#""type":"SCALAR"}]"#, &format!(r#""type":"SCALAR"}},{accessors}]"#), 1)
}

fn floats(offset: usize, count: usize, kind: &str) -> String {
    format!(
        r#"{{"bufferView":0,"byteOffset":{},"componentType":5126,"count":{count},"type":"{kind}"}}"#,
        4 * offset
    )
}

#[test]
fn a_light_follows_its_parent_s_keyframes() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    // Two times; two places of the parent; a quarter turn about x.
    let numbers = [0., 2., 1., 0., 0., 3., 0., 4., 0., 0., 0., 1., half, 0., 0., half];
    let accessors = [floats(0, 2, "SCALAR"), floats(2, 2, "VEC3"), floats(8, 2, "VEC4")].join(",");
    let animation = |channels: &str, samplers: &str| {
        format!(r#"{{"name":"way","channels":[{channels}],"samplers":[{samplers}]}}"#)
    };
    let moved =
        animation(r#"{"sampler":0,"target":{"node":2,"path":"translation"}}"#, r#"{"input":2,"output":3}"#);
    let scene = parse(&animated(&numbers, &accessors, &moved)).unwrap();
    let [way] = scene.animations.as_slice() else { panic!("{:?}", scene.animations) };
    assert_eq!((way.name.as_str(), way.duration, way.tracks.len()), ("way", 2.0, 1));
    let track = &way.tracks[0];
    assert_eq!((track.property, track.interpolation), (Property::Position, Interpolation::Linear));
    assert_eq!(
        (track.times.as_slice(), track.values.as_slice()),
        (&[0.0, 2.0][..], &[1., 1., 0., 3., 1., 4.][..])
    );

    // Turned, the light swings on an arc from above to the front, and its direction turns from −z to +y.
    let turned =
        animation(r#"{"sampler":0,"target":{"node":2,"path":"rotation"}}"#, r#"{"input":2,"output":4}"#);
    let scene = parse(&animated(&numbers, &accessors, &turned)).unwrap();
    let [position, direction] = scene.animations[0].tracks.as_slice() else { panic!() };
    assert_eq!((position.property, direction.property), (Property::Position, Property::Direction));
    assert!(position.times.len() >= 60);
    for (position, direction) in
        position.values.as_chunks::<3>().0.iter().zip(direction.values.as_chunks::<3>().0)
    {
        let [position, direction] = [*position, *direction].map(Vec3::from);
        assert!((position.length() - 1.0).abs() < 1e-5 && (direction.length() - 1.0).abs() < 1e-5);
        assert!(position.dot(direction).abs() < 1e-5);
    }
    assert!((Vec3::from_slice(&direction.values[direction.values.len() - 3..]) - Vec3::Y).length() < 1e-5);

    // By steps, the keys stay as they are.
    let stepped = turned.replace(r#""output":4"#, r#""output":4,"interpolation":"STEP""#);
    let scene = parse(&animated(&numbers, &accessors, &stepped)).unwrap();
    let track = &scene.animations[0].tracks[0];
    assert_eq!((track.interpolation, track.times.len()), (Interpolation::Step, 2));

    // Animations that move no light are left out and named.
    let other = moved.replace(r#""node":2"#, r#""node":0"#);
    let scene = parse(&animated(&numbers, &accessors, &other)).unwrap();
    assert!(scene.animations.is_empty() && scene.left_out[0].contains("way"));

    let reversed = [2., 0., 1., 0., 0., 3., 0., 4., 0., 0., 0., 1., half, 0., 0., half];
    let error = parse(&animated(&reversed, &accessors, &moved)).unwrap_err().to_string();
    assert!(error.contains("channel 0 of \"way\"") && error.contains("out of order"), "{error}");
}

#[test]
fn splines_pass_through_their_keys_and_pointers_reach_intensities() {
    // Times, then in-tangent, value and out-tangent of two keys.
    let numbers = [0., 1., 0., 2., 4., 4., 6., 0.];
    let accessors = [floats(0, 2, "SCALAR"), floats(2, 6, "SCALAR")].join(",");
    let animation = r#"{"channels":[{"sampler":0,"target":{"path":"pointer","extensions":{"KHR_animation_pointer":
        {"pointer":"/extensions/KHR_lights_punctual/lights/0/intensity"}}}}],
        "samplers":[{"input":2,"output":3,"interpolation":"CUBICSPLINE"}]}"#;
    let scene = parse(&animated(&numbers, &accessors, animation)).unwrap();
    let track = &scene.animations[0].tracks[0];
    assert_eq!((track.property, track.light), (Property::Intensity, 0));
    assert_eq!((track.values[0], *track.values.last().unwrap()), (2.0, 6.0));
    // Tangents as steep as the chord: a straight line.
    for (time, value) in track.times.iter().zip(&track.values) {
        assert!((value - (2.0 + 4.0 * time)).abs() < 1e-5, "{value} at {time}");
    }
}

#[test]
fn detail_textures_keep_their_coordinates_relative_to_the_first() {
    let info = |index: u32, offset: &str| {
        format!(
            r#"{{"index":{index},"extensions":{{"KHR_texture_transform":{{"offset":{offset},"scale":[2,4]}}}}}}"#
        )
    };
    let material = format!(
        r#""pbrMetallicRoughness":{{"baseColorTexture":{},"metallicFactor":0.25,"roughnessFactor":0.5}},
        "normalTexture":{},"emissiveTexture":{{"index":0,"texCoord":1}}"#,
        info(0, "[0,0]"),
        info(0, "[0.5,0.25]")
    );
    let scene = textured_with(&material);
    let m = &scene.materials[0];
    assert_eq!((m.metallic, m.roughness, m.specular, m.normal_scale), (0.25, 0.5, 1.0, 1.0));
    let normal = m.normal_texture.unwrap();
    assert_eq!(normal.uv_from_vertex, [[1.0, 0.0, 0.5], [0.0, 1.0, 0.25]]);
    let (base, normal) = (m.base_color_texture.unwrap(), normal.texture);
    assert!(base != normal, "colours and numbers are uploaded differently");
    assert!(!scene.textures[base as usize].meta.data && scene.textures[normal as usize].meta.data);
    assert_eq!(scene.textures[base as usize].bytes, scene.textures[normal as usize].bytes);
    // Coordinates of a different set are ignored; only the picture loses detail.
    assert!(m.emission_texture.is_none() && scene.left_out[0].contains("TEXCOORD_1"), "{:?}", scene.left_out);
}
