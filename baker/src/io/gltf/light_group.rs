//! Groups of shining surfaces by node: `extras.rebounce.light` names one, or the command does by the node's name.
//!
//! A name counts for the node and all nodes below it, as far as these have none of their own. Surfaces of other nodes are
//! grouped by material ([`crate::scene::emissive_groups`]).

use super::node::{self, PlacedNode};
use super::notes::Told;
use super::source::Source;
use std::rc::Rc;

/// Name of the group of each node, in the order of `nodes`; `None` for groups by material. `wanted` are names of nodes
/// that are groups each.
pub(super) fn names(
    source: &Source,
    nodes: &[PlacedNode],
    wanted: &[String],
    told: &mut Told,
) -> Vec<Option<Rc<str>>> {
    let mut out: Vec<Option<Rc<str>>> = Vec::with_capacity(nodes.len());
    let mut is_found = vec![false; wanted.len()];
    for node in nodes {
        let own = source.root.nodes[node.index].name.as_deref().unwrap_or_default();
        let by_name = wanted.iter().position(|name| name == own);
        let extras = source.exact.nodes.get(node.index).map(|node| &node.extras["rebounce"]["light"]);
        let by_extras = match extras {
            None | Some(serde_json::Value::Null) => None,
            Some(serde_json::Value::String(name)) if !name.is_empty() => Some(name.as_str()),
            Some(_) => {
                let node = node::name(source, node.index);
                told.notes.push(format!("{node}: extras.rebounce.light is no name; it is passed over"));
                None
            }
        };
        if let Some(place) = by_name {
            is_found[place] = true;
        }
        let inherited = node.parent.and_then(|parent| out[parent].clone());
        out.push(by_name.map(|_| own).or(by_extras).map(Rc::from).or(inherited));
    }
    let lost = wanted.iter().zip(is_found).filter(|(_, is_found)| !is_found);
    told.notes
        .extend(lost.map(|(name, _)| format!("--light-group {name:?}: no node of the scene has this name")));
    out
}
