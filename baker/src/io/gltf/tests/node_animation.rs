//! Keyframes of nodes that may move.

use super::*;
use crate::io::files::Memory;
use crate::io::options::LoadOptions;
use glam::{DAffine3, DQuat, DVec3};
use rebounce_shared::motion::{NodeMotion, world_motions};
use rebounce_shared::rbn::node_tracks::{NodeAnimation, NodeProperty, NodeTrack};

/// A lid on a box, both animated: two times; turns of the lid, places and turns of the box.
fn lid_and_box(channels: &str) -> Scene {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let numbers = [
        0., 2., // times
        0., 0., 0., 1., half, 0., 0., half, // the lid opens about x
        1., 0., 0., 3., 0., 4., // the box goes
        0., 0., 0., 1., 0., half, 0., half, // and turns about y
    ];
    let accessors =
        [floats(0, 2, "SCALAR"), floats(2, 2, "VEC4"), floats(10, 2, "VEC3"), floats(16, 2, "VEC4")]
            .join(",");
    let samplers = r#"{"input":2,"output":3},{"input":2,"output":4},{"input":2,"output":5}"#;
    let animation = format!(r#"{{"name":"open","channels":[{channels}],"samplers":[{samplers}]}}"#);
    let json = animated(&numbers, &accessors, &animation)
        .replacen(r#"{"mesh":0}"#, r#"{"mesh":0,"name":"lid","translation":[0,2,0.5]}"#, 1)
        .replacen(r#""nodes":[0,2]"#, r#""nodes":[3]"#, 1)
        .replacen(
            r#"{"children":[1]}"#,
            r#"{"children":[1]},{"mesh":0,"name":"box","children":[0,2],"translation":[1,0,0],"scale":[2,2,2]}"#,
            1,
        );
    let files = Memory::from_iter([("test.gltf", json.into_bytes())]);
    let options = LoadOptions { all_nodes_move: true, ..LoadOptions::default() };
    crate::io::load_from(&files, "test.gltf".as_ref(), &options).unwrap()
}

const LID: &str = r#"{"sampler":0,"target":{"node":0,"path":"rotation"}}"#;
const BOX_GOES: &str = r#"{"sampler":1,"target":{"node":3,"path":"translation"}}"#;
const BOX_TURNS: &str = r#"{"sampler":2,"target":{"node":3,"path":"rotation"}}"#;

fn value(track: &NodeTrack, k: usize) -> Vec<f64> {
    let width = track.property.width();
    track.values[k * width..(k + 1) * width].iter().map(|x| f64::from(*x)).collect()
}

/// Motions of the nodes at the last key.
fn at_the_end(scene: &Scene) -> Vec<NodeMotion> {
    let mut out = vec![NodeMotion::default(); scene.groups.nodes.len()];
    let [NodeAnimation { tracks, .. }] = scene.groups.animations.as_slice() else { panic!() };
    for track in tracks {
        let (value, node) = (value(track, track.times.len() - 1), &mut out[track.node as usize]);
        match track.property {
            NodeProperty::Translation => node.translation = value.try_into().unwrap(),
            NodeProperty::Rotation => node.rotation = value.try_into().unwrap(),
        }
    }
    out
}

#[test]
fn a_node_follows_its_keys_and_goes_along_with_the_one_above() {
    let scene = lid_and_box(&[LID, BOX_GOES, BOX_TURNS].join(","));
    let names: Vec<&str> = scene.groups.nodes.iter().map(|node| node.name.as_str()).collect();
    let [NodeAnimation { name, duration, .. }] = scene.groups.animations.as_slice() else { panic!() };
    assert_eq!((names, name.as_str(), *duration), (vec!["box", "lid"], "open", 2.0));
    assert!(scene.left_out.is_empty(), "{:?}", scene.left_out);
    let world = world_motions(&scene.groups, &at_the_end(&scene));
    let local =
        |turn: DQuat, to: [f64; 3]| DAffine3::from_scale_rotation_translation(DVec3::ONE, turn, to.into());
    let grown = DAffine3::from_scale(DVec3::splat(2.0));
    let box_then = local(DQuat::from_rotation_y(90f64.to_radians()), [3., 0., 4.]) * grown;
    let lid_then = box_then * local(DQuat::from_rotation_x(90f64.to_radians()), [0., 2., 0.5]);
    let box_first = local(DQuat::IDENTITY, [1., 0., 0.]) * grown;
    let lid_first = box_first * local(DQuat::IDENTITY, [0., 2., 0.5]);
    for (moved, [first, then]) in world.iter().zip([[box_first, box_then], [lid_first, lid_then]]) {
        for corner in [DVec3::ZERO, DVec3::X, DVec3::ONE] {
            let (is, wanted) =
                (moved.transform_point3(first.transform_point3(corner)), then.transform_point3(corner));
            assert!((is - wanted).length() < 1e-5, "{is} and {wanted}");
        }
    }
}

#[test]
fn keys_of_a_single_node_stay_as_they_are_and_what_stands_on_it_has_none() {
    let scene = lid_and_box(BOX_GOES);
    let [NodeAnimation { tracks, .. }] = scene.groups.animations.as_slice() else { panic!() };
    let [track] = tracks.as_slice() else { panic!("{tracks:?}") };
    assert_eq!(
        (track.node, track.property, track.interpolation),
        (0, NodeProperty::Translation, Interpolation::Linear)
    );
    // From where the file has it.
    assert_eq!((&track.times[..], &track.values[..]), (&[0.0, 2.0][..], &[0., 0., 0., 2., 0., 4.][..]));
    let [NodeAnimation { tracks, .. }] = &lid_and_box(LID).groups.animations[..] else { panic!() };
    assert!(tracks.iter().all(|track| track.node == 1 && track.times.len() == 2));
}
