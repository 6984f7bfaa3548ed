//! Morph targets and skins.

use super::*;
use crate::io::files::Memory;
use crate::io::options::{LoadOptions, PoseOption};
use glam::DVec3;
use std::fmt::Write;

/// A file of a mesh with one triangle at `corners`, with added members of primitive, mesh and root, and added accessors
/// from index 1 on: (component type, type, count, bytes).
fn triangle(
    corners: [[f32; 3]; 3],
    [primitive, mesh, root]: [&str; 3],
    accessors: &[(u32, &str, usize, Vec<u8>)],
) -> String {
    let mut bytes = floats(&corners.concat());
    let mut listed = r#"{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}"#.to_owned();
    let mut views = r#"{"buffer":0,"byteLength":36}"#.to_owned();
    for (i, (component, kind, count, more)) in accessors.iter().enumerate() {
        let view = i + 1;
        write!(
            listed,
            r#",{{"bufferView":{view},"componentType":{component},"count":{count},"type":"{kind}"}}"#
        )
        .unwrap();
        write!(views, r#",{{"buffer":0,"byteOffset":{},"byteLength":{}}}"#, bytes.len(), more.len()).unwrap();
        bytes.extend(more);
    }
    format!(
        r#"{{"asset":{{"version":"2.0"}},"accessors":[{listed}],"bufferViews":[{views}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0{primitive}}}]{mesh}}}],
        "buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}}],{root}}}"#,
        bytes.len(),
        base64(&bytes)
    )
}

fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// World-space corners of the scene's triangles.
fn corners(scene: &Scene) -> Vec<[DVec3; 3]> {
    let world = |i: u32| scene.positions[i as usize].as_dvec3() + DVec3::from(scene.origin);
    scene.triangles.iter().map(|t| t.map(world)).collect()
}

fn assert_near(found: &[[DVec3; 3]], wanted: &[[DVec3; 3]]) {
    assert_eq!(found.len(), wanted.len());
    for (found, wanted) in found.iter().flatten().zip(wanted.iter().flatten()) {
        assert!(found.distance(*wanted) < 1e-5, "{found} for {wanted}");
    }
}

const FLAT: [[f32; 3]; 3] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];

#[test]
fn morph_targets_count_by_the_nodes_weights_or_else_the_meshs() {
    let up = (5126, "VEC3", 3, floats(&[0., 0., 1., 0., 0., 2., 0., 0., 3.]));
    let along = (5126, "VEC3", 3, floats(&[4., 0., 0., 4., 0., 0., 4., 0., 0.]));
    let targets = r#"},"targets":[{"POSITION":1},{"POSITION":2}]"#;
    let nodes = r#""scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0},{"mesh":0,"weights":[0,1]}]"#;
    let json = triangle(FLAT, [targets, r#","weights":[0.5,0]"#, nodes], &[up, along]);
    let found = corners(&parse(&json).unwrap());
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let by_mesh = [at(0., 0., 0.5), at(1., 0., 1.), at(0., 1., 1.5)];
    let by_node = [at(4., 0., 0.), at(5., 0., 0.), at(4., 1., 0.)];
    assert_near(&found, &[by_mesh, by_node]);
}

#[test]
fn a_skin_blends_its_joints_and_forgets_its_node() {
    // Joint 0 stays, joint 1 is lifted by 2 under a node that doubles sizes; the bind matrix subtracts 1 again.
    let joints = (5121, "VEC4", 3, vec![0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0]);
    let weights = (5126, "VEC4", 3, floats(&[1., 0., 0., 0., 1., 0., 0., 0., 0.25, 0.75, 0., 0.]));
    let mut binds = DMat4::IDENTITY.to_cols_array().map(|x| x as f32).to_vec();
    binds.extend(DMat4::from_translation(DVec3::new(0., 0., -1.)).to_cols_array().map(|x| x as f32));
    let binds = (5126, "MAT4", 2, floats(&binds));
    let attributes = r#","JOINTS_0":1,"WEIGHTS_0":2}"#;
    let nodes = r#""scenes":[{"nodes":[0,1,2]}],"skins":[{"joints":[1,3],"inverseBindMatrices":3}],
        "nodes":[{"mesh":0,"skin":0,"translation":[9,9,9]},{},{"scale":[2,2,2],"children":[3]},{"translation":[0,0,2]}]"#;
    let json = triangle(FLAT, [attributes, "", nodes], &[joints, weights, binds]);
    let found = corners(&parse(&json).unwrap());
    // Joint 1: p -> 2 (p - z) + 4 z = 2 p + 2 z.
    let wanted = [DVec3::ZERO, DVec3::new(2., 0., 2.), DVec3::new(0., 0.25 + 0.75 * 2., 0.75 * 2.)];
    assert_near(&found, &[wanted]);
}

#[test]
fn a_mirrored_skin_keeps_its_front_and_joints_that_are_not_there_are_named() {
    let joints = (5121, "VEC4", 3, vec![0; 12]);
    let weights = (5126, "VEC4", 3, floats(&[1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0.]));
    let normals = (5126, "VEC3", 3, floats(&[0., 0., 1., 0., 0., 1., 0., 0., 1.]));
    let attributes = r#","JOINTS_0":1,"WEIGHTS_0":2,"NORMAL":3}"#;
    let nodes = |joint: u32| {
        format!(
            r#""scenes":[{{"nodes":[0,1]}}],"skins":[{{"joints":[{joint}]}}],"nodes":[{{"mesh":0,"skin":0}},{{"scale":[-1,1,1]}}]"#
        )
    };
    let file = |nodes: &str, first: u8| {
        let mut joints = joints.clone();
        joints.3[0] = first;
        triangle(FLAT, [attributes, "", nodes], &[joints, weights.clone(), normals.clone()])
    };
    let scene = parse(&file(&nodes(1), 0)).unwrap();
    let [a, b, c] = corners(&scene)[0];
    assert!((b - a).cross(c - a).z > 0.0 && a.x + b.x + c.x < 0.0);
    assert!(scene.normals.iter().all(|n| n.distance(Vec3::Z) < 1e-6), "{:?}", scene.normals);
    let missing = parse(&file(&nodes(1), 7)).unwrap_err().to_string();
    assert!(missing.contains("joint 7") && missing.contains("its skin 1"), "{missing}");
    let missing = parse(&file(&nodes(5), 0)).unwrap_err().to_string();
    assert!(missing.contains("no node 5"), "{missing}");
    let circle = r#""scenes":[{"nodes":[0]}],"skins":[{"joints":[1]}],
        "nodes":[{"mesh":0,"skin":0},{"children":[2]},{"children":[1]}]"#;
    let circle = parse(&file(circle, 0)).unwrap_err().to_string();
    assert!(circle.contains("joint node 1 is its own ancestor"), "{circle}");
}

/// The triangle as an animation has it.
fn posed(json: &str, animation: Option<&str>, time: f64) -> Result<Scene, SceneError> {
    let files = Memory::from_iter([("test.gltf", json.as_bytes().to_vec())]);
    let pose = Some(PoseOption { animation: animation.map(str::to_owned), time });
    let options = LoadOptions { pose, ..LoadOptions::default() };
    crate::io::load_from(&files, "test.gltf".as_ref(), &options)
}

#[test]
fn a_pose_moves_joints_and_morph_targets_to_the_moment() {
    let joints = (5121, "VEC4", 3, vec![0; 12]);
    let weights = (5126, "VEC4", 3, floats(&[1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0.]));
    let up = (5126, "VEC3", 3, floats(&[0., 0., 1., 0., 0., 1., 0., 0., 1.]));
    let along = (5126, "VEC3", 3, floats(&[1., 0., 0., 1., 0., 0., 1., 0., 0.]));
    let times = (5126, "SCALAR", 2, floats(&[0., 2.]));
    let places = (5126, "VEC3", 2, floats(&[0., 0., 0., 0., 8., 0.]));
    // Two targets a key.
    let shares = (5126, "SCALAR", 4, floats(&[0., 0., 1., 4.]));
    let primitive = r#","JOINTS_0":1,"WEIGHTS_0":2},"targets":[{"POSITION":3},{"POSITION":4}]"#;
    let root = r#""scenes":[{"nodes":[0,1]}],"skins":[{"joints":[1]}],"nodes":[{"mesh":0,"skin":0},{}],
        "animations":[{"name":"still","channels":[],"samplers":[]},{"name":"walk",
        "samplers":[{"input":5,"output":6},{"input":5,"output":7}],
        "channels":[{"sampler":0,"target":{"node":1,"path":"translation"}},
                    {"sampler":1,"target":{"node":0,"path":"weights"}}]}]"#;
    let json = triangle(FLAT, [primitive, "", root], &[joints, weights, up, along, times, places, shares]);
    let rest = [0, 1, 2].map(|i| Vec3::from(FLAT[i]).as_dvec3());
    for (time, share) in [(0.0, 0.0), (0.5, 0.25), (2.0, 1.0), (9.0, 1.0)] {
        let moved = share * DVec3::new(4., 8., 1.);
        assert_near(&corners(&posed(&json, Some("walk"), time).unwrap()), &[rest.map(|at| at + moved)]);
        assert_near(&corners(&posed(&json, Some("1"), time).unwrap()), &[rest.map(|at| at + moved)]);
        assert_near(&corners(&posed(&json, None, time).unwrap()), &[rest]);
    }
    let unknown = posed(&json, Some("run"), 0.0).unwrap_err().to_string();
    assert!(unknown.contains("`run`") && unknown.contains("still, walk"), "{unknown}");
    let short = json.replace(r#""count":4,"type":"SCALAR""#, r#""count":3,"type":"SCALAR""#);
    let short = posed(&short, Some("walk"), 0.0).unwrap_err().to_string();
    assert!(short.contains("channel 1 of \"walk\""), "{short}");
}

/// Exported files, if present: a deformed file and an applied file are equal scenes.
#[test]
fn exported_skins_and_morphs_are_what_applying_them_makes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/cases");
    for (name, applied) in
        [("skin/skin.glb", "skin/skin_applied.glb"), ("morph/morph.glb", "morph/morph_applied.glb")]
    {
        if !folder.join(name).exists() {
            continue;
        }
        let [deformed, applied] = [name, applied]
            .map(|file| load(&crate::io::files::Disk, &folder.join(file), &LoadOptions::default()).unwrap());
        assert_near(&corners(&deformed), &corners(&applied));
        let alike = deformed.normals.iter().zip(&applied.normals).all(|(a, b)| a.distance(*b) < 1e-4);
        assert!(alike && deformed.normals.len() == applied.normals.len(), "{name}");
    }
}
