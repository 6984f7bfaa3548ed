//! Instances, quantised attributes, vertex colours, and messages and errors about meshes.

use super::*;
use glam::DVec3;

/// Builder of a file with a triangle in the plane z = 0, as accessor 0, and added accessors.
struct Built {
    bytes: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

impl Built {
    fn new() -> Self {
        let mut built = Self { bytes: Vec::new(), views: Vec::new(), accessors: Vec::new() };
        built.add(
            5126,
            "VEC3",
            false,
            &[0f32, 0., 0., 1., 0., 0., 0., 1., 0.].map(f32::to_le_bytes).concat(),
        );
        built
    }

    /// Adds an accessor over `bytes` and returns the index.
    fn add(&mut self, component: u32, kind: &str, normalized: bool, bytes: &[u8]) -> usize {
        let size = [1, 1, 2, 2, 0, 4, 4][component as usize - 5120];
        let width = ["SCALAR", "", "VEC3", "VEC4"].iter().position(|k| *k == kind).unwrap() + 1;
        let width = if kind == "VEC2" { 2 } else { width };
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(format!(
            r#"{{"buffer":0,"byteOffset":{},"byteLength":{}}}"#,
            self.bytes.len(),
            bytes.len()
        ));
        self.accessors.push(format!(
            r#"{{"bufferView":{},"componentType":{component},"normalized":{normalized},"type":"{kind}","count":{}}}"#,
            self.views.len() - 1,
            bytes.len() / (size * width)
        ));
        self.bytes.extend(bytes);
        self.accessors.len() - 1
    }

    /// Loads the file, with added members of the node, attributes of the primitive, and members of the root.
    fn parse(&self, node: &str, attributes: &str, more: &str) -> Result<Scene, SceneError> {
        parse(&format!(
            r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"name":"the node","mesh":0{node}}}],
            "meshes":[{{"name":"the mesh","primitives":[{{"attributes":{{"POSITION":0{attributes}}}}}]}}],
            "accessors":[{}],"bufferViews":[{}],
            "buffers":[{{"byteLength":{},"uri":"data:;base64,{}"}}]{more}}}"#,
            self.accessors.join(","),
            self.views.join(","),
            self.bytes.len(),
            base64(&self.bytes)
        ))
    }
}

fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

#[test]
fn instances_stand_where_their_attributes_say_inside_their_node() {
    let mut file = Built::new();
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let places = file.add(5126, "VEC3", false, &floats(&[0., 0., 0., 10., 0., 0.]));
    // A quarter turn about z: normalised bytes are too coarse; then as shorts.
    let turns = file.add(5126, "VEC4", false, &floats(&[0., 0., 0., 1., 0., 0., half, half]));
    let sizes = file.add(5126, "VEC3", false, &floats(&[1., 1., 1., 2., 3., 1.]));
    let instances = |attributes: &str| {
        format!(
            r#","translation":[0,0,5],"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{{attributes}}}}}}}"#
        )
    };
    let all = format!(r#""TRANSLATION":{places},"ROTATION":{turns},"SCALE":{sizes},"_ID":0"#);
    let scene = file.parse(&instances(&all), "", "").unwrap();
    assert_eq!(scene.triangles.len(), 2);
    let world = |i: usize| scene.positions[i].as_dvec3() + DVec3::from(scene.origin);
    let corners: Vec<DVec3> = scene.triangles[1].iter().map(|&i| world(i as usize)).collect();
    let expected = [DVec3::new(10., 0., 5.), DVec3::new(10., 2., 5.), DVec3::new(7., 0., 5.)];
    for (found, expected) in corners.iter().zip(expected) {
        assert!(found.distance(expected) < 1e-5, "{corners:?}");
    }
    assert!(scene.normals.iter().all(|n| n.distance(Vec3::Z) < 1e-6));
    // Unknown instance count: a single instance at the node.
    assert_eq!(file.parse(&instances(r#""_ID":0"#), "", "").unwrap().triangles.len(), 1);
    let error = file.parse(&instances(&format!(r#""TRANSLATION":{places},"SCALE":0"#)), "", "").unwrap_err();
    assert!(
        error.to_string().contains("different lengths") && error.to_string().contains("the node"),
        "{error}"
    );
}

#[test]
fn quantised_positions_and_coordinates_mean_what_the_specification_says() {
    for (component, normalized, bytes, one) in [
        (5120, false, vec![0, 0, 0, 100, 0, 0, 0, 100, 0], 100.0),
        (5121, true, vec![0, 0, 0, 255, 0, 0, 0, 255, 0], 1.0),
        (5122, true, [0i16, 0, 0, i16::MIN, 0, 0, 0, i16::MIN, 0].map(i16::to_le_bytes).concat(), 1.0),
        (5123, false, [0u16, 0, 0, 50_000, 0, 0, 0, 50_000, 0].map(u16::to_le_bytes).concat(), 50_000.0),
    ] {
        let mut file = Built::new();
        let positions = file.add(component, "VEC3", normalized, &bytes);
        file.accessors.swap(0, positions);
        let scene = file.parse("", "", r#","extensionsRequired":["KHR_mesh_quantization"]"#).unwrap();
        let (low, high) = scene.bounds();
        assert_eq!(high - low, Vec3::new(one, one, 0.0), "{component}");
    }
}

#[test]
fn light_gets_colours_exactly_and_pictures_their_mean() {
    let mut file = Built::new();
    let color = file.add(5121, "VEC4", true, &[255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255]);
    let scene = file.parse("", &format!(r#","COLOR_0":{color}"#), "").unwrap();
    assert_eq!(scene.corner_colors, [[Vec3::X, Vec3::Y, Vec3::Z]]);
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let origin = Vec3::new(0.25, 0.25, 1.0) - Vec3::from(scene.origin.map(|x| x as f32));
    let hit = surfaces.cast(&Ray { origin, direction: -Vec3::Z, max_distance: 2.0, spread: 0.0 }, 0).unwrap();
    assert!(hit.albedo.distance(Vec3::new(0.5, 0.25, 0.25)) < 1e-6, "{}", hit.albedo);
    // Pictures show the mean colour, with a message.
    let shown = scene.materials[0].base_color;
    assert!(shown.iter().take(3).all(|c| (c - 1.0 / 3.0).abs() < 1e-6), "{shown:?}");
    assert!(scene.left_out[0].contains("vertex colours of 1 triangles"), "{:?}", scene.left_out);
    // White colours are dropped, and three channels suffice.
    let white = file.add(5126, "VEC3", false, &floats(&[1.0; 9]));
    let scene = file.parse("", &format!(r#","COLOR_0":{white}"#), "").unwrap();
    assert!(scene.corner_colors.is_empty() && scene.left_out.is_empty());
    let short = file.add(5126, "VEC3", false, &floats(&[0.5; 6]));
    let error = file.parse("", &format!(r#","COLOR_0":{short}"#), "").unwrap_err().to_string();
    assert!(error.contains("the mesh") && error.contains("different lengths"), "{error}");
}

#[test]
fn what_cannot_be_used_of_a_mesh_is_counted_by_its_name() {
    // A degenerate triangle beside a proper triangle, and a NaN normal.
    let mut file = Built::new();
    let numbers = [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 2., 0., 0.];
    let positions = file.add(5126, "VEC3", false, &floats(&numbers));
    file.accessors.swap(0, positions);
    let mut normals = [0.0, 0.0, 1.0].repeat(6);
    normals[4] = f32::NAN;
    let normals = file.add(5126, "VEC3", false, &floats(&normals));
    let scene = file.parse("", &format!(r#","NORMAL":{normals}"#), "").unwrap();
    assert!(scene.normals.iter().all(|n| *n == Vec3::Z), "repaired");
    assert_eq!((scene.triangles.len(), scene.degenerate_triangles), (1, 1));
    let noted = scene.left_out.join("\n");
    for says in ["1 triangles without area, of mesh 0 (\"the mesh\"): 1", "1 normals, texture coordinates"] {
        assert!(noted.contains(says), "{says}: {noted}");
    }
    // A triangle so long that the corners of the next triangle are rounded.
    let mut file = Built::new();
    let numbers = [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 0., 1e6, 0., 0., 0., 1e6, 0.];
    let numbers = [numbers.to_vec(), [0., 0., 0., 1., 0., 0., 0., 1., 1.].repeat(3)].concat();
    let positions = file.add(5126, "VEC3", false, &floats(&numbers));
    file.accessors.swap(0, positions);
    let scene = file.parse("", "", "").unwrap();
    assert!(scene.left_out[0].contains("of mesh 0 (\"the mesh\") (1414214 units)"), "{:?}", scene.left_out);
}

#[test]
fn meshes_beyond_the_range_of_numbers_are_refused() {
    let file = Built::new();
    for (node, says) in [
        (r#","scale":[1e20,1,1]"#, "the mesh\"), primitive 0 is placed beyond the range"),
        (r#","translation":[0,-1e13,1]"#, "placed beyond the range"),
        (r#","scale":[1e-12,1e-12,1e-12]"#, "units across, beyond the range of numbers"),
    ] {
        let error = file.parse(node, "", "").unwrap_err().to_string();
        assert!(error.contains(says) && error.contains("test.gltf"), "{error}");
    }
}

#[test]
fn accessors_without_data_cannot_lie_about_their_count() {
    let mut file = Built::new();
    let count = |n: &str| format!(r#"{{"componentType":5126,"type":"VEC3","count":{n}}}"#);
    file.accessors[0] = count("100000000");
    let error = file.parse("", "", "").unwrap_err().to_string();
    assert!(error.contains("POSITION of mesh 0") && error.contains("has no data"), "{error}");
    file.accessors[0] = count("30000");
    assert!(matches!(file.parse("", "", ""), Err(SceneError::Empty { .. })), "all at one place");
}

#[test]
fn hidden_nodes_and_what_is_below_them_are_left_out() {
    let hidden = r#","extensions":{"KHR_node_visibility":{"visible":false}}"#;
    assert!(matches!(Built::new().parse(hidden, "", ""), Err(SceneError::Empty { .. })));
    assert!(Built::new().parse(&hidden.replace("false", "true"), "", "").is_ok());
}

#[test]
fn a_specular_glossiness_material_keeps_its_diffuse_colour() {
    let old = r#""extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0.2,0.4,0.6,1],
        "glossinessFactor":0.25}}"#;
    let scene = textured_with(old);
    let m = &scene.materials[0];
    assert_eq!((m.base_color, m.metallic, m.roughness), ([0.2, 0.4, 0.6, 1.0], 0.0, 0.75));
    // Metallic-roughness has priority over specular-glossiness.
    let both = format!(r#""pbrMetallicRoughness":{{"baseColorFactor":[1,0,0,1],"metallicFactor":0}},{old}"#);
    assert_eq!(textured_with(&both).materials[0].base_color, [1.0, 0.0, 0.0, 1.0]);
}

#[test]
fn places_without_end_are_refused() {
    let node = r#"{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":1}}}}"#;
    let with = |nodes: usize| {
        parse(&format!(
            r#"{{"asset":{{"version":"2.0"}},"nodes":[{}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},
            {{"componentType":5126,"count":65536,"type":"VEC3"}}],"bufferViews":[{{"buffer":0,"byteLength":36}}],
            "buffers":[{{"byteLength":36,"uri":"data:;base64,{}"}}]}}"#,
            vec![node; nodes].join(","),
            base64(&floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]))
        ))
    };
    let scene = with(2).unwrap();
    assert_eq!((scene.triangles.len(), scene.instances(), scene.triangles_placed()), (1, 1 << 17, 1 << 17));
    let error = with(65).unwrap_err().to_string();
    assert!(error.contains("too many places of meshes (4259840)"), "{error}");
}
