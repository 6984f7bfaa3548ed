//! Rigs in files, and their poses.

use crate::rules::scene;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
use rebounce_shared::octahedral::pack_rounded;
use rebounce_shared::rbn::bulk::{Copies, Instance, Vertex};
use rebounce_shared::rbn::rig::MAX_JOINTS;
use rebounce_shared::rbn::{RIG_SECTIONS, container};
use rebounce_shared::rig::pose::Pose;
use rebounce_shared::rig::skin::{put, ridden, skinned};
use rebounce_shared::rig::{
    MorphDelta, NodePose, Rig, RigAnimation, RigInterpolation, RigJoint, RigLayout, RigMesh, RigNode,
    RigPoint, RigTarget, RigTrack, RigVertex,
};
use std::f32::consts::FRAC_1_SQRT_2;

const STILL: [[f32; 3]; 4] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];

fn parts(translation: [f64; 3]) -> NodePose {
    NodePose::Parts { translation, rotation: [0.0, 0.0, 0.0, 1.0], scale: [1.0; 3] }
}

/// Two vertices of the triangle are skinned to two joints, the third one is of a morphed mesh.
fn rig() -> Rig {
    let node = |parent, rest| RigNode { parent, rest };
    let joint = |node| RigJoint { node, inverse_bind: STILL };
    let track = |target, interpolation, values: &[f32]| RigTrack {
        target,
        interpolation,
        times: vec![0.0, 2.0],
        values: values.to_vec(),
    };
    let turned = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2];
    let vertex = |vertex, x: f32, joints, weights| RigVertex {
        vertex,
        position: [x, 0.0, 0.0],
        normal: pack_rounded(Vec3::Z),
        joints,
        weights,
    };
    let layout = RigLayout {
        nodes: vec![
            node(
                None,
                NodePose::Matrix(
                    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]].map(|c| c.map(f64::from)),
                ),
            ),
            node(Some(0), parts([0.0; 3])),
            node(Some(1), parts([0.0, 1.0, 0.0])),
        ],
        meshes: vec![
            RigMesh { vertex_count: 2, node: 1, joints: vec![joint(1), joint(1)], ..RigMesh::default() },
            RigMesh {
                first_vertex: 2,
                vertex_count: 1,
                node: 2,
                weights: vec![0.0, 0.5],
                ..RigMesh::default()
            },
        ],
        animations: vec![RigAnimation {
            name: "wave".into(),
            duration: 2.0,
            tracks: vec![
                track(RigTarget::Rotation(1), RigInterpolation::Linear, &turned),
                track(RigTarget::Weights(1), RigInterpolation::Step, &[0.0, 0.0, 1.0, 2.0]),
                track(RigTarget::Translation(2), RigInterpolation::CubicSpline, &[0.0; 18]),
            ],
        }],
        bounds: [[-1.0; 3], [2.0; 3]],
    };
    Rig {
        layout,
        vertices: vec![
            vertex(0, 0.0, [0, 0], [0xffff, 0]),
            vertex(1, 1.0, [1 << 16, 0], [0x8000 << 16 | 0x7fff, 0]),
            vertex(2, 0.0, [0, 0], [0xffff, 0]),
        ],
        deltas: vec![
            MorphDelta { position: [1.0, 0.0, 0.0], ..MorphDelta::default() },
            MorphDelta { position: [0.0, 0.0, 2.0], ..MorphDelta::default() },
        ],
        points: vec![RigPoint { point: 1, corners: [0, 1, 2], barycentric: [0.25, 0.25] }],
    }
}

fn rigged() -> BakedScene {
    BakedScene { rig: rig(), ..scene() }
}

#[test]
fn a_rig_survives_the_file_and_needs_all_of_its_sections() {
    let scene = rigged();
    let bytes = scene.to_bytes().unwrap();
    let back = BakedScene::from_bytes(&bytes).unwrap();
    assert!(back == scene && back.to_bytes().unwrap() == bytes);
    let version = container::version(&bytes).unwrap();
    assert_eq!(version, container::VERSION);
    let sections = container::read(&bytes).unwrap();
    let parts: Vec<_> = sections.iter().map(|s| (s.name, &bytes[s.offset..s.offset + s.len])).collect();
    // An older reader would show it still.
    let error = BakedScene::from_bytes(&container::write(version - 1, &parts)).unwrap_err();
    assert!(error.to_string().contains("RIGL"), "{error}");
    for missing in RIG_SECTIONS {
        let rest: Vec<_> = parts.iter().filter(|part| part.0 != missing).copied().collect();
        let error = BakedScene::from_bytes(&container::write(version, &rest)).unwrap_err();
        assert!(error.to_string().contains(&String::from_utf8_lossy(&missing)[..]), "{error}");
    }
    let without = crate::rules::scene().to_bytes().unwrap();
    let sections = container::read(&without).unwrap();
    assert!(sections.iter().all(|section| !RIG_SECTIONS.contains(&section.name)));
    assert_eq!(container::version(&without), Some(container::PUNCTUAL_LIGHTS));
}

#[test]
fn every_broken_rule_of_a_rig_is_refused_by_its_section() {
    fn tracks(scene: &mut BakedScene) -> &mut [RigTrack] {
        &mut scene.rig.layout.animations[0].tracks
    }
    type Break = fn(&mut BakedScene);
    let breaks: [(&str, Break); 45] = [
        ("RIGL", |s| s.rig.layout.nodes[1].parent = Some(1)),
        ("RIGL", |s| s.rig.layout.nodes[0].parent = Some(2)),
        ("RIGL", |s| s.rig.layout.nodes[2].rest = parts([f64::NAN, 0.0, 0.0])),
        ("RIGL", |s| s.rig.layout.nodes[2].rest = parts([1e16, 0.0, 0.0])),
        ("RIGL", |s| s.rig.layout.nodes[0].rest = NodePose::Matrix([[f64::INFINITY; 3]; 4])),
        ("RIGL", |s| {
            s.rig.layout.nodes[1].rest =
                NodePose::Parts { translation: [0.0; 3], rotation: [0.0, 0.0, 0.5, 0.5], scale: [1.0; 3] };
        }),
        ("RIGL", |s| s.rig.layout.bounds[1][2] = f32::NAN),
        ("RIGL", |s| s.rig.layout.meshes[1].node = 3),
        ("RIGL", |s| s.rig.layout.meshes[0].joints[1].node = 3),
        ("RIGL", |s| s.rig.layout.meshes[0].joints[1].inverse_bind[3][0] = 1e16),
        ("RIGL", |s| {
            let joint = s.rig.layout.meshes[0].joints[0].clone();
            s.rig.layout.meshes[0].joints = vec![joint; MAX_JOINTS + 1];
        }),
        ("RIGL", |s| s.rig.layout.meshes[1].weights[0] = f32::NAN),
        ("RIGL", |s| s.rig.layout.meshes[0].vertex_count = 0),
        ("RIGL", |s| s.rig.layout.meshes[1].first_vertex = 1),
        ("RIGL", |s| s.rig.layout.meshes[1].first_delta = 1),
        ("RIGL", |s| s.rig.layout.meshes[0].vertex_count = 1),
        ("RIGL", |s| s.rig.layout.animations[0].duration = f32::NAN),
        ("RIGL", |s| s.rig.layout.animations[0].duration = 1.0),
        ("RIGL", |s| tracks(s)[0].target = RigTarget::Rotation(3)),
        ("RIGL", |s| tracks(s)[0].target = RigTarget::Rotation(0)),
        ("RIGL", |s| tracks(s)[0].target = RigTarget::Scale(1)),
        ("RIGL", |s| tracks(s)[1].target = RigTarget::Weights(0)),
        ("RIGL", |s| tracks(s)[1].target = RigTarget::Weights(2)),
        ("RIGL", |s| tracks(s)[1].values.truncate(3)),
        ("RIGL", |s| tracks(s)[2].interpolation = RigInterpolation::Linear),
        ("RIGL", |s| tracks(s)[0].times = vec![1.0, 1.0]),
        ("RIGL", |s| tracks(s)[0].times = vec![-1.0, 1.0]),
        ("RIGL", |s| tracks(s)[0].times[1] = f32::NAN),
        ("RIGL", |s| (tracks(s)[0].times, tracks(s)[0].values) = Default::default()),
        ("RIGL", |s| tracks(s)[0].values[2] = f32::INFINITY),
        ("RIGV", |s| s.rig.vertices.push(RigVertex::default())),
        ("RIGV", |s| s.rig.vertices[2].vertex = 3),
        ("RIGV", |s| s.rig.vertices[2].vertex = 1),
        ("RIGV", |s| s.rig.vertices[0].position[1] = f32::NAN),
        ("RIGV", |s| s.rig.vertices[0].joints[1] = 2 << 16),
        ("RIGV", |s| s.rig.vertices[2].joints[0] = 1),
        ("RIGV", |s| s.rig.vertices[0].weights[0] = 0xfffe),
        ("RIGV", |s| s.rig.vertices[2].weights = [0, 0xffff]),
        ("RIGM", |s| s.rig.deltas.truncate(1)),
        ("RIGM", |s| s.rig.deltas[1].normal[0] = f32::NAN),
        ("RIGP", |s| s.rig.points[0].point = 2),
        ("RIGP", |s| s.rig.points[0].corners[2] = 3),
        ("RIGP", |s| s.rig.points[0].barycentric = [0.75, 0.5]),
        ("RIGP", |s| s.rig.points[0].barycentric[0] = f32::NAN),
        ("RIGP", |s| s.rig.points.push(s.rig.points[0])),
    ];
    for (i, (section, damage)) in breaks.into_iter().enumerate() {
        let mut scene = rigged();
        damage(&mut scene);
        let error = scene.to_bytes().expect_err(&format!("{i}")).to_string();
        assert!(error.contains(section), "{i}: {error}");
    }
    // What deforms is drawn once.
    let mut scene = rigged();
    (scene.instances, scene.copies) = (vec![Instance::IDENTITY], vec![Copies { first: 0, count: 1 }]);
    let error = scene.to_bytes().unwrap_err().to_string();
    assert!(error.contains("RIGV"), "{error}");
}

#[test]
fn the_poses_of_a_rig_turn_its_joints_and_morph_its_targets() {
    let rig = rig();
    let place = |animation: &RigAnimation, time: f32| -> Vec<Vec3> {
        skinned(&rig, &Pose::of(&rig, animation, time)).iter().map(|vertex| vertex.position).collect()
    };
    let near = |found: &[Vec3], wanted: [Vec3; 3]| {
        let off = found.iter().zip(wanted).map(|(a, b)| a.distance(b)).fold(0.0f32, f32::max);
        assert!(off < 1e-5, "{found:?}");
    };
    near(&place(&RigAnimation::default(), 0.0), [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, 1.0)]);
    let wave = &rig.layout.animations[0];
    let diagonal = Vec3::new(FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0);
    // The spline brings the second mesh to its parent; its weights hold until the second key.
    near(&place(wave, 1.0), [Vec3::ZERO, diagonal, Vec3::ZERO]);
    near(&place(wave, 5.0), [Vec3::ZERO, Vec3::Y, Vec3::new(0.0, 1.0, 4.0)]);
}

#[test]
fn keys_without_a_direction_are_no_turn() {
    let mut rig = rig();
    rig.layout.animations[0].tracks[0].values = vec![0.0; 8];
    let pose = Pose::of(&rig, &rig.layout.animations[0], 1.0);
    let found = skinned(&rig, &pose);
    assert!(found[1].position.distance(Vec3::X) < 1e-6, "{found:?}");
}

#[test]
fn points_ride_on_the_side_that_their_corners_go_around() {
    let rig = rig();
    let mut vertices = vec![Vertex::default(); 3];
    let mut at = skinned(&rig, &Pose::rest(&rig));
    (at[2].position, at[1].position, at[0].position) = (Vec3::Y, Vec3::X, Vec3::ZERO);
    at.iter_mut().for_each(|vertex| vertex.normal = Vec3::new(0.6, 0.0, 0.8));
    let front = ridden(&rig.points[0], &at);
    assert!(front.position.distance(Vec3::new(0.25, 0.25, 0.0)) < 1e-6);
    let [v, w] = rig.points[0].barycentric;
    let back = ridden(&RigPoint { corners: [0, 2, 1], barycentric: [w, v], ..rig.points[0] }, &at);
    assert!(back.position.distance(front.position) < 1e-6 && back.normal.distance(-front.normal) < 1e-6);
    assert!(front.normal.z > 0.0);
    put(&rig, &at, &mut vertices);
    assert_eq!(vertices[1].position, [1.0, 0.0, 0.0]);
}
