//! Nodes of the class [`Viewer`] that may move.

use super::page::{animation, track, tracks};
use super::viewer::Viewer;
use crate::error::ViewerError;
use crate::passes::settings::SolverChoice;
use rebounce_shared::motion::NodeMotion;
use rebounce_shared::rbn::meta::Animation;
use rebounce_shared::rbn::node_tracks::NodeAnimation;
use wasm_bindgen::prelude::*;

/// Numbers of a node: its translation, and its rotation as a quaternion x, y, z, w.
const NUMBERS: usize = 7;

/// Animations of lights, each with the tracks of nodes of the same name, and those of nodes alone. Of several of one name the
/// first ones belong together.
pub(super) fn with_nodes(
    of_lights: &[Animation],
    (names, of_nodes): (Vec<String>, Vec<NodeAnimation>),
) -> js_sys::Array {
    let mut of_nodes: Vec<Option<NodeAnimation>> = of_nodes.into_iter().map(Some).collect();
    let push = |tracks: &js_sys::Array, own: &NodeAnimation| {
        for t in &own.tracks {
            let node = ("node", names[t.node as usize].as_str().into());
            tracks.push(&track(node, t.property.name(), t.interpolation, [&t.times, &t.values]));
        }
    };
    let out = js_sys::Array::new();
    for own in of_lights {
        let (tracks, mut duration) = (tracks(own), own.duration);
        let is_same =
            |other: &&mut Option<NodeAnimation>| other.as_ref().is_some_and(|other| other.name == own.name);
        if let Some(nodes) = of_nodes.iter_mut().find(is_same).and_then(Option::take) {
            push(&tracks, &nodes);
            duration = duration.max(nodes.duration);
        }
        out.push(&animation(&own.name, duration, tracks));
    }
    for own in of_nodes.into_iter().flatten() {
        let tracks = js_sys::Array::new();
        push(&tracks, &own);
        out.push(&animation(&own.name, own.duration, tracks));
    }
    out
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
