//! What animations deform.

mod file;

use super::*;
use crate::bake::{BakeSettings, Preset, bake};
use crate::io::files::Memory;
use crate::io::options::{GroupOption, LoadOptions, PoseOption};
use file::{Maker, scene, strip, triangle};
use glam::DVec3;
use rebounce_shared::rig::pose::Pose;
use rebounce_shared::rig::skin::{put, ridden, skinned};
use rebounce_shared::rig::{NodePose, Rig, RigTarget};
use serde_json::{Value, json};

fn loaded(json: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    let files = Memory::from_iter([("test.gltf", json.as_bytes().to_vec())]);
    crate::io::load_from(&files, "test.gltf".as_ref(), options)
}

/// The file with a change.
fn changed(change: impl FnOnce(&mut Value)) -> String {
    let mut json: Value = serde_json::from_str(&scene()).unwrap();
    change(&mut json);
    json.to_string()
}

fn parsed(json: &str) -> Scene {
    loaded(json, &LoadOptions::default()).unwrap()
}

/// World-space places of the vertices that deform, in a pose of the rig.
fn places(scene: &Scene, pose: &Pose) -> Vec<(u32, DVec3)> {
    let places = skinned(&scene.rig, pose);
    let world = |place: Vec3| place.as_dvec3() + DVec3::from(scene.origin);
    scene.rig.vertices.iter().zip(places).map(|(v, at)| (v.vertex, world(at.position))).collect()
}

/// Greatest distance of the rig's vertices from those of a scene.
fn distance(scene: &Scene, pose: &Pose, other: &Scene) -> f64 {
    let off = |(vertex, place): (u32, DVec3)| {
        let wanted = other.positions[vertex as usize].as_dvec3() + DVec3::from(other.origin);
        wanted.distance(place)
    };
    places(scene, pose).into_iter().map(off).fold(0.0, f64::max)
}

#[test]
fn at_rest_the_rig_is_where_the_file_has_it() {
    let scene = parsed(&scene());
    let meshes: Vec<_> =
        scene.rig.layout.meshes.iter().map(|m| (m.vertex_count, m.joints.len(), m.weights.len())).collect();
    assert_eq!(meshes, [(18, 2, 0), (3, 0, 2)]);
    assert_eq!(scene.rig.layout.meshes[1].weights, [0.25, 0.0]);
    // The world, and what the joints and the triangle hang from; neither the strip's node nor the floor.
    assert_eq!(scene.rig.layout.nodes.len(), 5);
    assert!(matches!(scene.rig.layout.nodes[0].rest, NodePose::Matrix(_)));
    assert!(distance(&scene, &Pose::rest(&scene.rig), &scene) < 1e-5);
    let normals = skinned(&scene.rig, &Pose::rest(&scene.rig));
    for (vertex, at) in scene.rig.vertices.iter().zip(&normals) {
        let wanted = scene.normals[vertex.vertex as usize];
        // Normals of flat triangles are not linear in weights.
        assert!(at.normal.distance(wanted) < 0.1, "{} for {wanted}", at.normal);
    }
    assert!(scene.notes.is_empty() && scene.left_out.is_empty(), "{:?} {:?}", scene.notes, scene.left_out);
}

#[test]
fn at_any_time_the_rig_is_where_a_pose_of_the_file_is() {
    let json = scene();
    let scene = parsed(&json);
    assert_eq!(scene.rig.layout.animations.len(), 2);
    let names: Vec<_> = scene.rig.layout.animations.iter().map(|a| (a.name.as_str(), a.duration)).collect();
    assert_eq!(names, [("walk", 2.0), ("animation 1", 2.0)]);
    for (number, animation) in scene.rig.layout.animations.iter().enumerate() {
        let mut most = 0.0f64;
        for time in [0.0, 0.2, 0.5, 0.75, 1.3, 1.999, 2.0, 9.0] {
            let pose = Some(PoseOption { animation: Some(number.to_string()), time: f64::from(time) });
            let posed = loaded(&json, &LoadOptions { pose, ..LoadOptions::default() }).unwrap();
            assert!(posed.rig.is_empty() && posed.groups.is_empty());
            let pose = Pose::of(&scene.rig, animation, time);
            let off = distance(&scene, &pose, &posed);
            // Weights of 65535ths, between joints that are two units apart.
            assert!(off < 1e-4, "animation {number} at {time}: {off}");
            most = most.max(distance(&scene, &pose, &scene));
            let [low, high] = scene.rig.layout.bounds.map(Vec3::from);
            if animation.tracks[0].times.contains(&time) {
                let inside = |at: Vec3| at.cmpge(low).all() && at.cmple(high).all();
                assert!(skinned(&scene.rig, &pose).iter().all(|vertex| inside(vertex.position)));
            }
        }
        assert!(most > 0.5, "it moves by {most}");
    }
}

#[test]
fn what_deforms_is_a_group_of_its_own_and_what_stands_has_no_rig() {
    let scene = parsed(&scene());
    let groups: Vec<_> = scene.groups.groups.iter().map(|group| (group.name.as_str(), group.node)).collect();
    assert_eq!(groups, [("strip", None), ("triangle", None)]);
    assert!(scene.models.is_empty() && scene.groups.nodes.is_empty());
    let of_triangle = |i: usize| scene.groups.of_material(scene.triangle_material[i]);
    let found: Vec<u32> = (0..scene.triangles.len()).map(of_triangle).collect();
    assert_eq!(found, [vec![1; 16], vec![2], vec![0; 2]].concat());
    // Without the rig everything is one surface again.
    for still in [
        loaded(&file::scene(), &LoadOptions { is_still: true, ..LoadOptions::default() }).unwrap(),
        parsed(&changed(|json| json["animations"] = json!([]))),
    ] {
        assert!(still.rig == Rig::default() && still.groups.is_empty());
        assert_eq!(still.positions, scene.positions);
    }
    // Neither is a mesh that its node carries about.
    let carried = parsed(&changed(|json| {
        json["animations"][0]["channels"] =
            json!([{ "sampler": 2, "target": { "node": 5, "path": "translation" } }]);
        json["animations"][1]["channels"] = json!([]);
    }));
    assert!(carried.rig.is_empty());
}

#[test]
fn a_group_that_is_named_has_its_density_and_what_deforms_does_not_move_by_hand() {
    let groups = vec![GroupOption { name: "triangle".into(), density: 4.0 }];
    let scene = loaded(&scene(), &LoadOptions { groups, ..LoadOptions::default() }).unwrap();
    assert_eq!((scene.groups.groups[1].density, scene.groups.groups[1].node), (4.0, None));
    let [note] = &scene.notes[..] else { panic!("{:?}", scene.notes) };
    assert!(note.contains("\"triangle\"") && note.contains("does not move by hand"), "{note}");
    let scene =
        loaded(&file::scene(), &LoadOptions { all_nodes_move: true, ..LoadOptions::default() }).unwrap();
    let moves: Vec<_> =
        scene.groups.groups.iter().map(|group| (group.name.as_str(), group.node.is_some())).collect();
    assert_eq!(moves.iter().filter(|(_, moves)| *moves).count(), 1, "{moves:?}");
    assert!(distance(&scene, &Pose::rest(&scene.rig), &scene) < 1e-5);
}

#[test]
fn a_skin_that_moves_alone_applies_morph_targets_at_rest() {
    let mut maker = Maker::default();
    let (mut strip, binds) = strip(&mut maker);
    let count = 18;
    let target = maker.floats("VEC3", &[0.0, 0.0, 0.5].repeat(count));
    strip["primitives"][0]["targets"] = json!([{ "POSITION": target }]);
    strip["weights"] = json!([0.5]);
    let times = maker.floats("SCALAR", &[1.0]);
    let places = maker.floats("VEC3", &[3.0, 0.0, 0.0]);
    let json = maker.finish(json!({
        "nodes": [{ "mesh": 0, "skin": 0 }, { "children": [2] }, { "translation": [0.0, 1.0, 0.0] }],
        "skins": [{ "joints": [1, 2], "inverseBindMatrices": binds }],
        "meshes": [strip], "materials": [{}],
        "animations": [{ "samplers": [{ "input": times, "output": places }],
                         "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }] }],
    }));
    let scene = parsed(&json);
    assert!(scene.rig.deltas.is_empty() && scene.rig.layout.meshes[0].weights.is_empty());
    assert!(distance(&scene, &Pose::rest(&scene.rig), &scene) < 1e-5);
    let pose = Pose::of(&scene.rig, &scene.rig.layout.animations[0], 0.0);
    let all = places_of(&scene, &pose);
    assert!(all.iter().all(|at| (at.x - 3.0).abs() < 0.3 && (at.z - 0.25).abs() < 1e-5), "{all:?}");
}

fn places_of(scene: &Scene, pose: &Pose) -> Vec<DVec3> {
    places(scene, pose).into_iter().map(|(_, at)| at).collect()
}

#[test]
fn what_a_rig_cannot_hold_is_said() {
    // Six joints at a vertex.
    let mut maker = Maker::default();
    let (mut mesh, _) = strip(&mut maker);
    let joints = maker.joints(&[[0, 1, 2, 3]; 18]);
    let more = maker.joints(&[[4, 5, 0, 0]; 18]);
    let weights = maker.floats("VEC4", &[0.1, 0.2, 0.3, 0.1].repeat(18));
    let rest = maker.floats("VEC4", &[0.2, 0.1, 0.0, 0.0].repeat(18));
    let attributes = &mut mesh["primitives"][0]["attributes"];
    (attributes["JOINTS_0"], attributes["WEIGHTS_0"]) = (joints.into(), weights.into());
    (attributes["JOINTS_1"], attributes["WEIGHTS_1"]) = (more.into(), rest.into());
    let times = maker.floats("SCALAR", &[0.0]);
    let places = maker.floats("VEC3", &[0.0, 0.0, 0.0]);
    let animations = json!([{ "samplers": [{ "input": times, "output": places }],
        "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }] }]);
    let root = |joints: Vec<usize>, matrix: bool| {
        let mut nodes = vec![json!({ "mesh": 0, "skin": 0 })];
        nodes.extend((1..7).map(|_| json!({})));
        if matrix {
            nodes[1] = json!({ "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] });
        }
        json!({ "nodes": nodes, "skins": [{ "joints": joints }], "meshes": [mesh], "materials": [{}],
                "animations": animations })
    };
    let (all, many) = ((1..7).collect::<Vec<_>>(), vec![1; 65_536]);
    let [crowded, many, matrix] = {
        let roots = [root(all.clone(), false), root(many, false), root(all, true)];
        roots.map(|root| maker.clone().finish(root))
    };
    let scene = parsed(&crowded);
    let said = scene.notes.join("; ");
    assert!(
        said.contains("18 vertices of mesh 0 (\"strip\")") && said.contains("four of greatest weight"),
        "{said}"
    );
    assert_eq!(scene.rig.vertices[0].joints, [2 | 1 << 16, 4]);
    let refused = loaded(&many, &LoadOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("joints of a skin") && refused.contains("65535"), "{refused}");
    let said = parsed(&matrix).notes.join("; ");
    assert!(said.contains("node 1") && said.contains("matrix"), "{said}");
    // Instances of a mesh with morph targets.
    let mut maker = Maker::default();
    let mesh = triangle(&mut maker);
    let places = maker.floats("VEC3", &[0.0, 0.0, 0.0, 3.0, 0.0, 0.0]);
    let times = maker.floats("SCALAR", &[0.0]);
    let shares = maker.floats("SCALAR", &[1.0, 1.0]);
    let json = maker.finish(json!({
        "nodes": [{ "mesh": 0, "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": places } } } }],
        "meshes": [mesh], "materials": [{}], "extensionsUsed": ["EXT_mesh_gpu_instancing"],
        "animations": [{ "samplers": [{ "input": times, "output": shares }],
                         "channels": [{ "sampler": 0, "target": { "node": 0, "path": "weights" } }] }],
    }));
    let scene = parsed(&json);
    assert!(
        scene.rig.is_empty() && scene.notes.join("; ").contains("its instances stand still"),
        "{:?}",
        scene.notes
    );
}

#[test]
fn scenes_put_together_keep_their_rigs_and_other_triangles_have_none() {
    let mut both = parsed(&scene());
    let at = DVec3::new(2.0, 0.0, 1.0);
    both.add(parsed(&scene()), at).unwrap();
    let count = both.rig.vertices.len() / 2;
    let walk = both.rig.layout.animations[2].clone();
    assert_eq!(walk.name, "walk");
    // The second one walks where the first one would, farther on.
    let (first, second) = (&both.rig.layout.animations[0], &walk);
    let first = places_of(&both, &Pose::of(&both.rig, first, 0.7));
    let second = places_of(&both, &Pose::of(&both.rig, second, 0.7));
    for (a, b) in first[..count].iter().zip(&second[count..]) {
        assert!((*a + at).distance(*b) < 1e-5);
    }
    assert!(distance(&both, &Pose::rest(&both.rig), &both) < 1e-5);
    assert_eq!(both.groups.groups.len(), 4);
    let other = both.with_triangles(crate::scene::TriangleMesh::default());
    assert!(other.rig.is_empty() && other.notes.join("; ").contains("stands still"));
}

/// A fast bake.
fn baked(scene: &Scene) -> rebounce_shared::baked::BakedScene {
    let mut settings = BakeSettings::new(Preset::Draft);
    (settings.place.levels, settings.place.functions) = (3, 200);
    settings.operator.rays = vec![64];
    settings.operator.later_levels = 1;
    settings.gloss = None;
    bake(scene, &settings.normalised(), &()).unwrap().0
}

#[test]
fn a_baked_rig_is_at_rest_where_the_file_draws_it_and_points_ride_on_it() {
    let scene = parsed(&scene());
    let file = baked(&scene);
    let rig = &file.rig;
    assert_eq!(rig.vertices.len(), 21);
    let rest = skinned(rig, &Pose::rest(rig));
    // Steps of 2^-19 of the scene, and weights of 65535ths.
    let mut drawn = file.vertices.clone();
    put(rig, &rest, &mut drawn);
    for (a, b) in drawn.iter().zip(&file.vertices) {
        assert!(Vec3::from(a.position).distance(b.position.into()) < 1e-4);
    }
    assert_eq!(file.version(), rebounce_shared::rbn::container::VERSION);
    let back = rebounce_shared::baked::BakedScene::from_bytes(&file.to_bytes().unwrap()).unwrap();
    assert!(back.rig == *rig);
    // All points of the groups ride, and none of the floor does.
    let riding: Vec<usize> = rig.points.iter().map(|point| point.point as usize).collect();
    let grouped: Vec<usize> = (0..file.points.len()).filter(|i| file.group_of(*i) > 0).collect();
    assert!(riding == grouped && !grouped.is_empty() && grouped.len() < file.points.len());
    let mut backs = 0;
    for own in &rig.points {
        let point = &file.points[own.point as usize];
        let found = ridden(own, &rest);
        assert!(found.position.distance(point.position()) < 1e-3 * point.radius, "{found:?} {point:?}");
        assert!(found.normal.dot(point.normal()) > 0.9, "{found:?} {}", point.normal());
        let first = rig.layout.meshes.iter().position(|mesh| {
            (mesh.first_vertex..mesh.first_vertex + mesh.vertex_count).contains(&own.corners[0])
        });
        assert_eq!(first.map(|mesh| mesh as u32 + 1), Some(file.group_of(own.point as usize)));
        let [a, b, c] =
            own.corners.map(|corner| file.vertices[rig.vertices[corner as usize].vertex as usize].position);
        let drawn =
            file.indices.as_chunks::<3>().0.iter().map(|t| t.map(|i| file.vertices[i as usize].position));
        let is_turned = |t: &[[f32; 3]; 3]| [[a, c, b], [c, b, a], [b, a, c]].contains(t);
        backs += usize::from(drawn.clone().any(|t| is_turned(&t)));
    }
    assert!(backs > 0, "a sheet with two sides has points on both");
}

#[test]
fn the_tracks_of_the_file_are_kept() {
    let scene = parsed(&scene());
    let layout = &scene.rig.layout;
    let tracks = |i: usize| &layout.animations[i].tracks;
    assert!(tracks(0).iter().chain(tracks(1)).all(|track| track.times == [0.0, 0.5, 2.0]));
    assert!(tracks(0).iter().any(|track| matches!(track.target, RigTarget::Weights(1))));
    assert_eq!(tracks(1)[2].values.len(), 18);
}
