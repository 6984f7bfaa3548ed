//! Equivalent glTF encodings of a scene (`gltf/README.md`) give the same ray hits.

use glam::Vec3;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Ray, Surfaces};
use rebounce::random::Stream;
use rebounce::scene::Scene;

fn load(name: &str) -> Scene {
    let path = format!("{}/tests/gltf/{name}.glb", env!("CARGO_MANIFEST_DIR"));
    rebounce::io::load(&path).unwrap_or_else(|error| panic!("{error}"))
}

/// World-space distance and albedo at the hits of rays from above; `None` for a miss.
fn looks(scene: &Scene) -> Vec<Option<(f32, Vec3)>> {
    let surfaces = TriangleSurfaces::from_scene(scene);
    let origin = glam::DVec3::from(scene.origin).as_vec3();
    let mut stream = Stream::new(7, 0);
    let rays = (0..4000).map(|_| {
        let (from, to) = (stream.sphere() * 3.0 + Vec3::Y * 4.0, stream.sphere() * Vec3::new(4.0, 0.8, 3.0));
        Ray {
            origin: from - origin,
            direction: (to - from).normalize(),
            max_distance: f32::INFINITY,
            spread: 0.0,
        }
    });
    rays.map(|ray| surfaces.cast(&ray, 0).map(|hit| (hit.distance, hit.albedo))).collect()
}

/// Compares two scenes: at most a share `missed` of the rays (along outlines) may differ, in distance by more than
/// `far` or in albedo by more than `colour`.
fn alike(name: &str, truth: &str, far: f32, colour: f32, missed: f32) {
    let (scene, truth) = (load(name), load(truth));
    assert_eq!(scene.triangles.len(), truth.triangles.len(), "{name}");
    assert!(scene.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3), "{name}");
    let (found, expected) = (looks(&scene), looks(&truth));
    assert!(expected.iter().flatten().count() > 3000);
    let differ = found.iter().zip(&expected).filter(|pair| match pair {
        (Some((d, a)), Some((e, b))) => (d - e).abs() > far || (*a - *b).abs().max_element() > colour,
        (None, None) => false,
        _ => true,
    });
    let share = differ.count() as f32 / found.len() as f32;
    assert!(share <= missed, "{name}: {share} of the rays differ");
}

#[test]
fn what_loses_nothing_is_the_same_scene() {
    for (name, truth) in [("instanced", "plain"), ("webp", "plain"), ("sparse", "sparse-plain")] {
        alike(name, truth, 1e-5, 1e-5, 0.001);
    }
    assert_ne!(looks(&load("sparse")), looks(&load("plain")), "sparse colours are read");
}

#[test]
fn quantised_and_compressed_meshes_are_the_same_within_their_steps() {
    for name in ["quantized", "meshopt", "meshopt-medium", "instanced-meshopt", "draco", "draco-sequential"] {
        alike(name, "plain", 3e-3, 0.02, 0.01);
    }
    for name in ["gltfpack", "gltfpack-khr", "gltfpack-fallback"] {
        alike(name, "plain", 3e-3, 0.02, 0.01);
    }
}

#[test]
fn pictures_of_basis_universal_are_the_same_within_their_blocks() {
    let texels = |name: &str| load(name).textures[0].texels.clone().unwrap();
    let truth = texels("plain");
    // UASTC uses eight bits per texel, ETC1S about two; both use blocks of four by four.
    for (name, mean, most) in [("uastc", 1.5, 16), ("etc1s", 4.0, 40)] {
        let (scene, found) = (load(name), texels(name));
        let texture = &scene.textures[0];
        assert_eq!(
            (texture.meta.mime.as_str(), texture.meta.width, texture.meta.height),
            ("image/png", 32, 32)
        );
        let errors: Vec<i32> = (found.rgba.as_flattened().iter().zip(truth.rgba.as_flattened()))
            .map(|(a, b)| (*a as i32 - *b as i32).abs())
            .collect();
        let (sum, worst) = (errors.iter().sum::<i32>(), errors.iter().max());
        assert!((sum as f32) < mean * errors.len() as f32, "{name}: {}", sum as f32 / errors.len() as f32);
        assert!(worst.is_some_and(|e| *e <= most), "{name}: {worst:?}");
    }
    assert_eq!((texels("webp"), load("webp").textures[0].meta.mime.as_str()), (truth, "image/webp"));
}

#[test]
fn colours_of_vertices_are_interpolated_at_hits() {
    let scene = load("plain");
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let origin = glam::DVec3::from(scene.origin).as_vec3();
    // First ball: the colour is one half plus or minus the position in the ball; the base colour is 0.8.
    let centre = Vec3::new(-3.0, 0.75, -1.0);
    let mut stream = Stream::new(3, 0);
    for _ in 0..200 {
        let away = stream.sphere();
        let ray = Ray {
            origin: centre + 0.7 * away - origin,
            direction: -away,
            max_distance: f32::INFINITY,
            spread: 0.0,
        };
        let hit = surfaces.cast(&ray, 0).unwrap();
        let place = hit.position + origin - centre;
        let expected = 0.8 * (0.5 + Vec3::new(place.x, place.y, -place.x));
        assert!(hit.albedo.distance(expected) < 1e-5, "{} {expected}", hit.albedo);
    }
}

#[test]
fn pictures_show_as_much_colour_as_the_light_meets() {
    let scene = load("plain");
    let mut sums = [Vec3::ZERO; 2];
    for ((t, material), colors) in
        scene.triangles.iter().zip(&scene.triangle_material).zip(&scene.corner_colors)
    {
        let [a, b, c] = t.map(|i| scene.positions[i as usize]);
        let area = 0.5 * (b - a).cross(c - a).length();
        let [r, g, b, _] = scene.materials[*material as usize].base_color;
        sums[0] += area * Vec3::new(r, g, b);
        sums[1] += area * (colors[0] + colors[1] + colors[2]) / 3.0;
    }
    assert!((sums[0] / sums[1] - 1.0).abs().max_element() < 1e-4, "{sums:?}");
    assert!((3..30).contains(&scene.materials.len()), "{} materials", scene.materials.len());
    let noted = scene.left_out.iter().filter(|n| n.contains("vertex colours of 1")).count();
    assert_eq!(noted, 1, "{:?}", scene.left_out);
    // A scene without vertex colours is unchanged.
    let plain = rebounce::io::load("builtin:cornell-box").unwrap();
    assert!(plain.corner_colors.is_empty() && plain.left_out.is_empty());
}

/// A .glb file with `count` materials, each with its own texture of the same bytes.
fn with_pictures(count: usize, picture: &[u8]) -> Vec<u8> {
    let positions: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut binary: Vec<u8> = positions.iter().flat_map(|x| x.to_le_bytes()).collect();
    binary.extend(picture);
    binary.resize(binary.len().next_multiple_of(4), 0);
    let each = |f: &dyn Fn(usize) -> String| (0..count).map(f).collect::<Vec<_>>().join(",");
    let mut json = format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": {}}}], "nodes": [{{"mesh": 0}}],
        "scenes": [{{"nodes": [0]}}], "scene": 0, "bufferViews": [{{"buffer": 0, "byteLength": 36}},
        {{"buffer": 0, "byteOffset": 36, "byteLength": {}}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}],
        "images": [{}], "textures": [{}], "materials": [{}], "meshes": [{{"primitives": [{}]}}]}}"#,
        binary.len(),
        picture.len(),
        each(&|_| r#"{"bufferView": 1, "mimeType": "image/png"}"#.to_owned()),
        each(&|i| format!(r#"{{"source": {i}}}"#)),
        each(&|i| format!(r#"{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": {i}}}}}}}"#)),
        each(&|i| format!(r#"{{"attributes": {{"POSITION": 0}}, "material": {i}}}"#)),
    );
    json.extend(std::iter::repeat_n(' ', json.len().next_multiple_of(4) - json.len()));
    let length = |bytes: usize| (bytes as u32).to_le_bytes();
    let whole = length(28 + json.len() + binary.len());
    let head = [b"glTF\x02\0\0\0", &whole[..], &length(json.len()), b"JSON"].concat();
    [&head, json.as_bytes(), &length(binary.len()), b"BIN\0", &binary].concat()
}

#[test]
fn pictures_are_bounded_together() {
    let mut png = Vec::new();
    let tightly = image::codecs::png::PngEncoder::new_with_quality(
        &mut png,
        image::codecs::png::CompressionType::Best,
        image::codecs::png::FilterType::NoFilter,
    );
    image::GrayImage::new(4096, 4096).write_with_encoder(tightly).unwrap();
    assert!(png.len() < 64 << 10, "{} bytes", png.len());
    // One uniform texture is read, as from ordinary exporters; a large number of large textures is a bomb.
    let scene = rebounce::io::from_bytes("one.glb", &with_pictures(1, &png)).unwrap();
    assert_eq!(scene.textures[0].texels.as_ref().unwrap().width, 4096);
    let refused = rebounce::io::from_bytes("bomb.glb", &with_pictures(50, &png)).unwrap_err().to_string();
    assert!(refused.contains("bomb.glb") && refused.contains("838860800 texels"), "{refused}");
}
