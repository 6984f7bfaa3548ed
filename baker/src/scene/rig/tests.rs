use super::*;
use rebounce_shared::rig::{MorphDelta, RigNode, RigPoint, RigTrack};

/// Meshes of three and of two vertices, each with a morph target; an animation moves the second's weight.
fn rig() -> Rig {
    let mesh = |first_vertex, vertex_count, first_delta| RigMesh {
        first_vertex,
        vertex_count,
        first_delta,
        weights: vec![0.5],
        ..RigMesh::default()
    };
    let track = |mesh| RigTrack {
        target: RigTarget::Weights(mesh),
        interpolation: Default::default(),
        times: vec![0.0, 1.0],
        values: vec![0.0, 2.0],
    };
    let delta = |x: f32| MorphDelta { position: [0.0, 0.0, x], normal: [0.0; 3] };
    let vertex = |vertex: u32| RigVertex {
        vertex,
        position: [vertex as f32, 0.0, 0.0],
        weights: [65_535, 0],
        ..RigVertex::default()
    };
    let animation =
        |name: &str, mesh| RigAnimation { name: name.into(), duration: 1.0, tracks: vec![track(mesh)] };
    Rig {
        layout: RigLayout {
            nodes: vec![RigNode { parent: None, rest: world(DVec3::ZERO) }],
            meshes: vec![mesh(0, 3, 0), mesh(3, 2, 3)],
            animations: vec![animation("first", 0), animation("second", 1)],
            bounds: [[0.0; 3]; 2],
        },
        vertices: [4, 5, 6, 1, 2].map(vertex).to_vec(),
        deltas: [4.0, 5.0, 6.0, 1.0, 2.0].map(delta).to_vec(),
        points: vec![RigPoint { point: 3, corners: [3, 4, 4], barycentric: [0.5, 0.0] }],
    }
}

#[test]
fn vertices_take_their_targets_along_and_meshes_without_vertices_go() {
    // The first mesh goes; vertex 2 becomes 9 and 7, vertex 1 becomes 8.
    let mut found = rig();
    renumber(&mut found, |vertex| match vertex {
        1 => vec![8],
        2 => vec![9, 7],
        _ => Vec::new(),
    });
    assert_eq!(found.vertices.iter().map(|v| v.vertex).collect::<Vec<_>>(), [7, 8, 9]);
    assert_eq!(found.vertices.iter().map(|v| v.position[0]).collect::<Vec<_>>(), [2.0, 1.0, 2.0]);
    assert_eq!(found.deltas.iter().map(|delta| delta.position[2]).collect::<Vec<_>>(), [2.0, 1.0, 2.0]);
    let [mesh] = &found.layout.meshes[..] else { panic!() };
    assert_eq!((mesh.first_vertex, mesh.vertex_count, mesh.first_delta), (0, 3, 0));
    let [animation] = &found.layout.animations[..] else { panic!() };
    assert_eq!((animation.name.as_str(), animation.tracks[0].target), ("second", RigTarget::Weights(0)));
    assert_eq!(found.points[0].corners, [1, 0, 0]);
    renumber(&mut found, |_| None);
    assert_eq!(found, Rig::default());
}

#[test]
fn bounds_hold_all_poses_and_a_rig_beyond_the_range_of_numbers_is_none() {
    assert_eq!(bounds(&rig()), [[1.0, 0.0, 0.0], [6.0, 0.0, 12.0]]);
    let rig = || Rig { points: Vec::new(), ..rig() };
    let places = [UNUSED, 0, 1, UNUSED, 2, 3, UNUSED];
    let found = placed(rig(), &places, 4, DVec3::X).unwrap();
    assert_eq!(found.vertices.iter().map(|v| v.vertex).collect::<Vec<_>>(), [2, 3, 0, 1]);
    assert_eq!(found.layout.bounds, [[0.0, 0.0, 0.0], [4.0, 0.0, 10.0]]);
    let mut far = rig();
    far.layout.animations[0].tracks[0].values[1] = 1e15;
    assert_eq!(placed(far, &places, 4, DVec3::X), None);
}

#[test]
fn the_rig_of_another_scene_is_put_beside() {
    let mut both = rig();
    both.layout.bounds = bounds(&both);
    let mut other = both.clone();
    other.points.clear();
    add(&mut both, other.clone(), DVec3::Y, 10);
    assert_eq!(
        both.vertices.iter().map(|v| v.vertex).collect::<Vec<_>>(),
        [4, 5, 6, 1, 2, 14, 15, 16, 11, 12]
    );
    assert_eq!(both.layout.bounds, [[1.0, 0.0, 0.0], [6.0, 1.0, 12.0]]);
    assert!(check(&both, [20, 4]).is_ok());
    let (all, own) = (skinned(&both, &Pose::rest(&both)), skinned(&other, &Pose::rest(&other)));
    assert!(all[5..].iter().zip(&own).all(|(a, b)| a.position == b.position + Vec3::Y));
    let last = both.layout.animations[3].tracks[0].target;
    assert_eq!(last, RigTarget::Weights(3));
    let mut alone = Rig::default();
    add(&mut alone, other.clone(), DVec3::ZERO, 0);
    assert_eq!(alone, other);
}
