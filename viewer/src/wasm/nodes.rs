//! Nodes of the class [`Viewer`] that may move.

use super::page::{animation, track, tracks};
use super::viewer::Viewer;
use crate::error::ViewerError;
use crate::passes::settings::SolverChoice;
use rebounce_shared::motion::NodeMotion;
use rebounce_shared::rbn::meta::{Animation, Interpolation};
use rebounce_shared::rbn::node_tracks::{NodeAnimation, NodeTrack};
use rebounce_shared::rig::RigAnimation;
use wasm_bindgen::prelude::*;

/// Numbers of a node: its translation, and its rotation as a quaternion x, y, z, w.
const NUMBERS: usize = 7;

/// An animation for the page: name, duration, tracks.
type Listed = (String, f32, js_sys::Array);

/// Animations of lights, each with the tracks of nodes and of the rig of the same name, and those of nodes and of the rig alone. Of
/// several of one name the first ones belong together.
pub(super) fn with_nodes(
    of_lights: &[Animation],
    (names, of_nodes): (Vec<String>, Vec<NodeAnimation>),
    of_rig: &[RigAnimation],
) -> js_sys::Array {
    let mut listed: Vec<Listed> =
        of_lights.iter().map(|own| (own.name.clone(), own.duration, tracks(own))).collect();
    let first = listed.len();
    add(
        &mut listed,
        first,
        of_nodes.iter().map(|own| {
            let of_node = |t: &NodeTrack| {
                let node = ("node", names[t.node as usize].as_str().into());
                track(node, t.property.name(), t.interpolation, [&t.times, &t.values])
            };
            (own.name.clone(), own.duration, own.tracks.iter().map(of_node).collect())
        }),
    );
    let first = listed.len();
    add(
        &mut listed,
        first,
        of_rig.iter().map(|own| {
            // The pose is that of the rig's animation at the time which is the track's value.
            let keys: &[f32] = if own.duration > 0.0 { &[0.0, own.duration] } else { &[0.0] };
            let node = ("node", own.name.as_str().into());
            let of_rig = track(node, "pose", Interpolation::Linear, [keys, keys]);
            (own.name.clone(), own.duration, js_sys::Array::of1(&of_rig))
        }),
    );
    listed.iter().map(|(name, duration, tracks)| animation(name, *duration, tracks.clone())).collect()
}

/// Adds animations to those of the same name among the first ones, each to another; others at the end.
fn add(listed: &mut Vec<Listed>, first: usize, more: impl Iterator<Item = Listed>) {
    let mut taken = vec![false; first];
    for (name, duration, tracks) in more {
        let same = (0..first).find(|&i| !taken[i] && listed[i].0 == name);
        let Some(same) = same else {
            listed.push((name, duration, tracks));
            continue;
        };
        taken[same] = true;
        listed[same].1 = listed[same].1.max(duration);
        listed[same].2 = listed[same].2.concat(&tracks);
    }
}

#[wasm_bindgen]
impl Viewer {
    /// Names of the nodes that may move, zero-terminated.
    #[wasm_bindgen(js_name = nodeNames)]
    pub fn node_names(&self) -> String {
        self.state.borrow().renderer.node_names().iter().map(|name| format!("{name}\0")).collect()
    }

    /// Motions of the nodes, seven numbers each.
    #[wasm_bindgen(js_name = nodeMotions)]
    pub fn node_motions(&self) -> Vec<f64> {
        let motions = self.state.borrow().renderer.node_motions();
        motions.iter().flat_map(|motion| motion.translation.into_iter().chain(motion.rotation)).collect()
    }

    /// Moves the nodes.
    #[wasm_bindgen(js_name = setNodeMotions)]
    pub fn set_node_motions(&self, numbers: &[f64]) -> Result<(), JsValue> {
        let motion = |n: &[f64]| NodeMotion {
            translation: [n[0], n[1], n[2]],
            rotation: [n[3], n[4], n[5], n[6]],
            ..NodeMotion::default()
        };
        self.change(|state| {
            let motions: Vec<NodeMotion> = numbers.chunks_exact(NUMBERS).map(motion).collect();
            if motions.len() != state.renderer.node_names().len() {
                return Err(ViewerError::BadArgument("motions of all nodes are needed".into()));
            }
            state.renderer.move_nodes(&motions)
        })
    }

    /// Names of the file's animations of what deforms, zero-terminated.
    #[wasm_bindgen(js_name = poseNames)]
    pub fn pose_names(&self) -> String {
        self.state.borrow().renderer.rig_animations().iter().map(|own| format!("{}\0", own.name)).collect()
    }

    /// The animation whose pose it has, by its place in the list of names, and the time in seconds; nothing at rest.
    pub fn pose(&self) -> Vec<f64> {
        let posed = self.state.borrow().renderer.posed();
        posed.map_or(Vec::new(), |(animation, time)| vec![animation as f64, time])
    }

    /// Poses what deforms as an animation of the list has it at a time, seconds; at rest where there is none of this place.
    #[wasm_bindgen(js_name = setPose)]
    pub fn set_pose(&self, animation: i32, time: f64) -> Result<(), JsValue> {
        self.change(|state| {
            let count = state.renderer.rig_animations().len();
            let animation = usize::try_from(animation).ok().filter(|number| *number < count);
            state.renderer.pose(animation, time)
        })
    }

    /// What computes bounced light: `"operator"` or `"radiosity"`.
    #[wasm_bindgen(getter)]
    pub fn solver(&self) -> String {
        self.state.borrow().renderer.solver_in_use().into()
    }

    /// Chooses it: `"auto"`, `"operator"` or `"radiosity"`.
    #[wasm_bindgen(setter)]
    pub fn set_solver(&self, solver: &str) -> Result<(), JsValue> {
        self.change(|state| {
            state.renderer.set_solver(SolverChoice::parse(solver)?);
            Ok(())
        })
    }

    /// Whether bounced light is on its way to what lights and nodes are now.
    #[wasm_bindgen(getter)]
    pub fn solving(&self) -> bool {
        self.state.borrow().renderer.is_solving()
    }
}
