//! Messages about a file: omissions, and likely mistakes.

use super::*;
use rebounce_shared::light::LightKind;

/// A file of meshes as lists of corners, three per triangle, with added members of the primitives and of the root.
fn file(meshes: &[(&str, Vec<[f32; 3]>)], primitive: &str, members: &str) -> String {
    let mut bytes: Vec<u8> = Vec::new();
    let (mut list, mut accessors, mut views) = (Vec::new(), Vec::new(), Vec::new());
    for (i, (name, corners)) in meshes.iter().enumerate() {
        let length = corners.len() * 12;
        views.push(format!(r#"{{"buffer":0,"byteOffset":{},"byteLength":{length}}}"#, bytes.len()));
        bytes.extend(corners.iter().flatten().flat_map(|x| x.to_le_bytes()));
        accessors.push(format!(
            r#"{{"bufferView":{i},"componentType":5126,"count":{},"type":"VEC3"}}"#,
            corners.len()
        ));
        list.push(format!(
            r#"{{"name":"{name}","primitives":[{{"attributes":{{"POSITION":{i}}}{primitive}}}]}}"#
        ));
    }
    format!(
        r#"{{"asset":{{"version":"2.0"}},"meshes":[{}],"accessors":[{}],"bufferViews":[{}],
        "buffers":[{{"byteLength":{},"uri":"data:;base64,{}"}}]{members}}}"#,
        list.join(","),
        accessors.join(","),
        views.join(","),
        bytes.len(),
        base64(&bytes)
    )
}

fn triangle() -> Vec<[f32; 3]> {
    vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]
}

/// The first `sides` sides of a cube with edges of length 2 `half`.
fn cube(half: f32, sides: usize) -> Vec<[f32; 3]> {
    let side = |side: usize| {
        let (axis, sign) = (side % 3, if side < 3 { half } else { -half });
        [(-1, -1), (1, -1), (1, 1), (-1, -1), (1, 1), (-1, 1)].map(|(u, v): (i8, i8)| {
            let mut corner = [sign; 3];
            corner[(axis + 1) % 3] = f32::from(u) * half;
            corner[(axis + 2) % 3] = f32::from(v) * half;
            corner
        })
    };
    (0..sides).flat_map(side).collect()
}

fn load_with(json: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    let source = Source::parse(
        "test.gltf".into(),
        &crate::io::files::Disk,
        std::path::PathBuf::new(),
        json.as_bytes(),
    )?;
    convert_with(&source, "test".into(), options)
}

#[test]
fn area_lights_stand_at_their_nodes_and_broken_ones_are_named() {
    let nodes = [
        // Turned from -z down; twice as large at most.
        r#"{"translation":[1,2,3],"rotation":[-0.7071067811865476,0,0,0.7071067811865476],"scale":[1,2,0.5],"name":"panel","extensions":{"EXT_lights_area":{"light":0}}}"#,
        r#"{"extensions":{"EXT_lights_area":{"light":1}}}"#,
        r#"{"extensions":{"EXT_lights_area":{"light":2}}}"#,
        r#"{"extensions":{"EXT_lights_area":{"light":3}}}"#,
        r#"{"extensions":{"EXT_lights_area":{"light":4}}}"#,
    ];
    let lights = r#"{"type":"rect","size":0.5,"rect":{"aspect":3},"intensity":8,"color":[1,0.5,0.25]},
        {"type":"disk","name":"round","size":0.4},{"type":"tube","name":"neon"},
        {"type":"disk","size":0,"name":"flat"},{"type":"rect","intensity":-1,"name":"drain"}"#;
    let members = format!(
        r#"{WHITE},"nodes":[{{"mesh":0}},{}],"extensionsUsed":["EXT_lights_area"],
        "extensionsRequired":["EXT_lights_area"],"extensions":{{"EXT_lights_area":{{"lights":[{lights}]}}}}"#,
        nodes.join(",")
    );
    let scene = parse(&file(&[("floor", triangle())], r#","material":0"#, &members)).unwrap();
    let [Light::Rectangle { position, direction, up, width, height, intensity, color }, round, drain] =
        &scene.lights[..]
    else {
        panic!("{:?}", scene.lights)
    };
    let near = |a: &[f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
    assert!(
        near(position, [1.0, 2.0, 3.0]) && near(direction, [0.0, -1.0, 0.0]) && near(up, [0.0, 0.0, -1.0])
    );
    assert!((width - 3.0).abs() < 1e-9 && (height - 1.0).abs() < 1e-9);
    assert_eq!((*intensity, *color), (8.0, [1.0, 0.5, 0.25]));
    let expected = Light::Disk {
        position: [0.0; 3],
        direction: [0.0, 0.0, -1.0],
        radius: 0.2,
        intensity: 1000.0,
        color: [1.0; 3],
    };
    assert_eq!((round, drain.intensity()), (&expected, 0.0));
    assert_eq!(scene.light_names, ["panel", "round", "drain"]);
    let said = scene.left_out.join("; ");
    assert!(
        said.contains("\"neon\"") && said.contains("rect or disk") && said.contains("\"flat\""),
        "{said}"
    );
    assert!(scene.notes.iter().any(|note| note.contains("\"drain\"")), "{:?}", scene.notes);
}

#[test]
fn shining_surfaces_are_grouped_by_material_or_as_their_nodes_say() {
    let nodes = r#","materials":[{"name":"tube","emissiveFactor":[1,1,1]}],"nodes":[{"mesh":0,"name":"hall"},
        {"mesh":0,"extras":{"rebounce":{"light":"stage"}}},
        {"mesh":0,"name":"desk","children":[4,5]},{"mesh":0,"extras":{"rebounce":{"light":"stage"}}},
        {"mesh":0},{"mesh":0,"extras":{"rebounce":{"light":7}}}]"#;
    let json = file(&[("tube", triangle())], r#","material":0"#, nodes);
    let groups = |light_groups: &[&str]| {
        let light_groups = light_groups.iter().map(|name| (*name).to_owned()).collect();
        let scene = load_with(&json, &LoadOptions { light_groups, ..LoadOptions::default() }).unwrap();
        let groups = crate::scene::emissive_groups(&scene);
        let count = |materials: &[u32]| {
            scene.triangle_material.iter().filter(|material| materials.contains(material)).count()
        };
        let named: Vec<(String, usize)> =
            groups.iter().map(|group| (group.name.clone(), count(&group.materials))).collect();
        (named, scene.notes.join("; "))
    };
    let named =
        |list: &[(&str, usize)]| list.iter().map(|(name, n)| ((*name).to_owned(), *n)).collect::<Vec<_>>();
    let (found, notes) = groups(&[]);
    assert_eq!(found, named(&[("tube", 4), ("stage", 2)]));
    assert!(notes.contains("extras.rebounce.light is no name"), "{notes}");
    let (found, notes) = groups(&["desk", "attic"]);
    assert_eq!(found, named(&[("tube", 1), ("stage", 2), ("desk", 3)]));
    assert!(notes.contains("\"attic\"") && !notes.contains("\"desk\": no"), "{notes}");
}

const WHITE: &str = r#","materials":[{"name":"white"}]"#;

#[test]
fn lights_that_are_none_are_named_and_the_others_keep_their_places() {
    let node = |light: usize| format!(r#"{{"extensions":{{"KHR_lights_punctual":{{"light":{light}}}}}}}"#);
    let nodes: Vec<String> = (0..7).map(node).collect();
    let strange: Vec<String> =
        (0..5).map(|i| format!(r#"{{"name":"panel {i}","type":"area","intensity":3}}"#)).collect();
    let members = format!(
        r#"{WHITE},"nodes":[{{"mesh":0}},{}],"extensionsUsed":["KHR_lights_punctual"],
        "extensions":{{"KHR_lights_punctual":{{"lights":[{},{{"type":"point","intensity":-4,"name":"drain"}},
        {{"type":"point","intensity":7}}]}}}}"#,
        nodes.join(","),
        strange.join(",")
    );
    let scene = parse(&file(&[("floor", triangle())], r#","material":0"#, &members)).unwrap();
    let intensity = |light: &Light| match light {
        Light::Point { intensity, .. } => *intensity,
        other => panic!("{other:?}"),
    };
    assert_eq!(scene.lights.iter().map(intensity).collect::<Vec<_>>(), [0.0, 7.0]);
    let [left_out] = &scene.left_out[..] else { panic!("{:?}", scene.left_out) };
    for says in ["light 0 (\"panel 0\")", "\"area\"", "2 more (5 in all)", "point, spot or directional"] {
        assert!(left_out.contains(says), "{left_out}");
    }
    let [note] = &scene.notes[..] else { panic!("{:?}", scene.notes) };
    assert!(note.contains("light 5 (\"drain\")") && note.contains("counts as 0"), "{note}");
}

#[test]
fn an_image_based_light_is_the_sky_and_a_broken_one_is_named() {
    let png = |texel: [u8; 4]| {
        let mut png = std::io::Cursor::new(Vec::new());
        image::RgbaImage::from_pixel(2, 2, image::Rgba(texel))
            .write_to(&mut png, image::ImageFormat::Png)
            .unwrap();
        format!(r#"{{"uri":"data:image/png;base64,{}"}}"#, base64(&png.into_inner()))
    };
    // Bright above, dark elsewhere.
    let images: Vec<String> = (0..6).map(|i| png([255, 255, 255, if i == 2 { 51 } else { 254 }])).collect();
    let scene = |light: &str, index: usize| {
        let members = format!(
            r#"{WHITE},"nodes":[{{"mesh":0}}],"images":[{}],"extensionsUsed":["EXT_lights_image_based"],
            "scenes":[{{"nodes":[0],"extensions":{{"EXT_lights_image_based":{{"light":{index}}}}}}}],
            "extensions":{{"EXT_lights_image_based":{{"lights":[{light}]}}}}"#,
            images.join(",")
        );
        parse(&file(&[("floor", triangle())], r#","material":0"#, &members))
    };
    let whole = r#"{"name":"dusk","intensity":3,"specularImageSize":2,"specularImages":[[0,1,2,3,4,5]]}"#;
    let found = scene(whole, 0).unwrap();
    assert_eq!((found.lights[0].kind(), found.lights[0].intensity()), (LightKind::Environment, 3.0));
    assert_eq!((found.light_names.as_slice(), found.left_out.len()), (&["dusk".to_owned()][..], 0));
    let sky = found.environment.unwrap();
    assert!((sky.radiance(Vec3::Y).x - 5.0).abs() < 1e-4 && (sky.radiance(Vec3::X).x - 1.004).abs() < 1e-2);
    for (light, says) in [
        (r#"{"name":"dusk","specularImages":[]}"#, "six sides"),
        (r#"{"name":"dusk","specularImages":[[0,1,2,3,4,9]]}"#, "no image 9"),
        (r#"{"name":"dusk","intensity":-1,"specularImages":[[0,1,2,3,4,5]]}"#, "intensity"),
        (r#"{"name":"dusk","rotation":[0,0,0,0],"specularImages":[[0,1,2,3,4,5]]}"#, "rotation"),
    ] {
        let found = scene(light, 0).unwrap();
        let said = found.left_out.join("; ");
        assert!(found.environment.is_none() && said.contains("\"dusk\"") && said.contains(says), "{said}");
    }
    assert!(scene(whole, 1).unwrap_err().to_string().contains("no image-based light 1"));
}

#[test]
fn extensions_that_are_not_read_are_named_once() {
    let members = format!(
        r#"{WHITE},"nodes":[{{"mesh":0,"extensions":{{"MSFT_lod":{{"ids":[1]}}}}}}],
        "extensionsUsed":["KHR_materials_sheen","EXT_lights_gobo","KHR_texture_transform","KHR_audio"],
        "extensions":{{"EXT_lights_gobo":{{"lights":[]}},"KHR_lights_environment":{{}}}}"#
    );
    let scene = parse(&file(&[("floor", triangle())], r#","material":0"#, &members)).unwrap();
    let [image, environment, others, shine] = &scene.left_out[..] else { panic!("{:?}", scene.left_out) };
    assert!(image.starts_with("EXT_lights_gobo") && image.contains("KHR_lights_punctual"), "{image}");
    assert!(environment.starts_with("KHR_lights_environment"), "{environment}");
    assert!(others.starts_with("KHR_audio, MSFT_lod: not read"), "{others}");
    assert!(shine.starts_with("KHR_materials_sheen: ") && scene.notes.is_empty(), "{shine}");
}

#[test]
fn a_texture_without_coordinates_is_one_texel_and_that_is_said() {
    let scene = textured_with(
        r#""name":"tiles","pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":3,
        "extensions":{"KHR_texture_transform":{"offset":[0.75,0.25]}}}}"#,
    );
    // The second of four texels, everywhere.
    for (x, y) in [(0.25, 0.25), (0.75, 0.25), (0.3, 0.8), (0.9, 0.9)] {
        assert_eq!(albedo_at(&scene, x, y), Vec3::Y);
    }
    let [note] = &scene.notes[..] else { panic!("{:?}", scene.notes) };
    for says in ["mesh 0 (\"square\"), primitive 0", "TEXCOORD_3", "\"tiles\"", "one colour"] {
        assert!(note.contains(says), "{note}");
    }
}

#[test]
fn the_scene_with_meshes_is_taken_or_the_one_that_is_asked_for() {
    let with = |scenes: &str| {
        let members = format!(
            r#"{WHITE},"nodes":[{{"name":"empty"}},{{"children":[2]}},{{"mesh":0}},{{"mesh":1}}],"scenes":[{scenes}]"#
        );
        let big = triangle().into_iter().map(|c| c.map(|x| 10.0 * x)).collect();
        file(&[("small", triangle()), ("big", big)], r#","material":0"#, &members)
    };
    let take = |json: &str, scene: Option<&str>| {
        load_with(json, &LoadOptions { scene: scene.map(str::to_owned), ..LoadOptions::default() })
    };
    let width = |scene: &Scene| (scene.bounds().1 - scene.bounds().0).x;
    // The default scene is empty, and exactly one scene is not.
    let two = with(r#"{"nodes":[0],"name":"notes"},{"nodes":[1],"name":"house"}"#);
    let scene = take(&two, None).unwrap();
    assert_eq!(width(&scene), 1.0);
    let [note] = &scene.notes[..] else { panic!("{:?}", scene.notes) };
    assert!(note.contains("scene 1 (\"house\") is taken") && note.contains("scene 0 (\"notes\")"), "{note}");
    // Several scenes are not empty: the user must select by number or name.
    let three = with(r#"{"nodes":[0]},{"nodes":[1],"name":"house"},{"nodes":[3],"name":"1"}"#);
    let error = take(&three, None).unwrap_err().to_string();
    for says in ["test.gltf", "scene 0, its default", "--scene", "scene 1 (\"house\"), scene 2 (\"1\")"] {
        assert!(error.contains(says), "{error}");
    }
    for (wanted, expected) in [("house", 1.0), ("1", 10.0), ("2", 10.0)] {
        let scene = take(&three, Some(wanted)).unwrap();
        assert_eq!((width(&scene), scene.notes.len(), scene.left_out.len()), (expected, 0, 0), "{wanted}");
    }
    let error = take(&three, Some("attic")).unwrap_err().to_string();
    assert!(error.contains("no scene `attic`") && error.contains("scene 1 (\"house\")"), "{error}");
    // A mesh in an unselected scene only is reported; a mesh in both scenes is not.
    let scene = take(&with(r#"{"nodes":[1]},{"nodes":[1,3],"name":"all"},{"nodes":[2]}"#), None).unwrap();
    let [left_out] = &scene.left_out[..] else { panic!("{:?}", scene.left_out) };
    assert!(left_out.contains("scene 1 (\"all\")") && left_out.contains("--scene"), "{left_out}");
    let scene = take(&with("").replace(r#""scenes""#, r#""scene":4,"scenes""#), None).unwrap();
    assert!(scene.triangles.len() == 2 && scene.notes[0].contains("no scene 4"), "{:?}", scene.notes);
}

#[test]
fn a_lamp_within_its_own_bulb_is_named_with_it() {
    // A floor ten units wide, and a lamp at (0, 0, 2) within a cube.
    let floor: Vec<[f32; 3]> = triangle().into_iter().map(|c| c.map(|x| 10.0 * x - 5.0)).collect();
    let said = |bulb: Vec<[f32; 3]>, lamp: &str, material: &str| {
        let members = format!(
            r#","nodes":[{{"mesh":0}},{{"mesh":1,"translation":[0.01,0.02,2]}},{{"translation":[0,0,2],
            "extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}],"materials":[{{{material}}}],
            "extensions":{{"KHR_lights_punctual":{{"lights":[{{"name":"lamp",{lamp}}}]}}}}"#
        );
        let scene = parse(&file(&[("floor", floor.clone()), ("bulb", bulb)], r#","material":0"#, &members));
        scene.unwrap().notes.join("\n")
    };
    let point = r#""type":"point""#;
    let note = said(cube(0.1, 6), point, "");
    assert!(note.contains("light 0 (\"lamp\") is enclosed by mesh 1 (\"bulb\")"), "{note}");
    assert!(!note.contains('\n'), "{note}");
    // An open shade and glass let the light out; a room around the lamp holds the lit surfaces: no note.
    assert_eq!(said(cube(0.1, 5), point, ""), "");
    assert_eq!(said(cube(0.1, 6), point, r#""alphaMode":"BLEND""#), "");
    assert_eq!(said(cube(4.0, 6), point, ""), "");
    assert_eq!(said(cube(0.1, 6), r#""type":"directional""#, ""), "");
    // A spot shines down: sides 5 (below) and the walls, or none below.
    let spot = r#""type":"spot","spot":{"outerConeAngle":0.3}"#;
    assert!(said(cube(0.1, 6), spot, "").contains("light 0 (\"lamp\")"));
    assert_eq!(said(cube(0.1, 5), spot, ""), "");
}

#[test]
fn what_has_no_material_is_white_or_as_is_asked() {
    let json = file(&[("bare", triangle())], "", r#","nodes":[{"mesh":0}]"#);
    let scene = parse(&json).unwrap();
    assert_eq!(scene.materials[0].base_color, [1.0; 4]);
    let [note] = &scene.notes[..] else { panic!("{:?}", scene.notes) };
    assert!(note.contains("mesh 0 (\"bare\")") && note.contains("--albedo"), "{note}");
    let options = LoadOptions { albedo: Some([0.5, 0.25, 0.75]), ..LoadOptions::default() };
    let scene = load_with(&json, &options).unwrap();
    assert_eq!(scene.materials[0].base_color, [0.5, 0.25, 0.75, 1.0]);
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    let json =
        file(&[("painted", triangle())], r#","material":0"#, &format!(r#"{WHITE},"nodes":[{{"mesh":0}}]"#));
    let scene = load_with(&json, &options).unwrap();
    assert!(scene.materials[0].base_color == [1.0; 4] && scene.notes[0].contains("--albedo changes nothing"));
}
