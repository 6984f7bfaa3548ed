//! Reconstruction groups by node: `extras.rebounce.group` makes a node one, or the command does by the node's name; for
//! radiosity every node with a mesh is one, as it may move.
//!
//! `extras.rebounce.group` is a density, functions for an area relative to other surfaces, or `true` for 1.

use super::node::{self, PlacedNode};
use super::notes::Told;
use super::source::Source;
use crate::io::options::{GroupOption, LoadOptions};
use crate::scene::groups::{MaterialGroup, NodeGroups};
use glam::DVec3;
use rebounce_shared::rbn::groups::{Group, MAX_DENSITY, MAX_GROUPS, Node};

/// Returns the groups of nodes: of those that are one, and of each node whose mesh animations deform (`deforms`), which does not
/// move by hand. Also the group of each node in the order of `nodes`, and its place among those that may move.
pub(super) fn of_nodes(
    source: &Source,
    nodes: &[PlacedNode],
    deforms: &[bool],
    options: &LoadOptions,
    told: &mut Told,
) -> (NodeGroups, Vec<u32>, Vec<Option<u32>>) {
    let densities: Vec<Option<f32>> =
        nodes.iter().map(|node| density(source, node, &options.groups, told)).collect();
    let is_group = |i: usize| options.all_nodes_move || densities[i].is_some();
    let (holders, is_full) = holders(source, nodes, deforms, is_group);
    if is_full {
        let problem = format!("there can be {MAX_GROUPS} groups; name those that should with --group");
        told.notes.push(format!("some nodes cannot move: {problem}"));
    }
    // Whether a node has a group, and whether it or one below it has.
    let (mut moves, mut is_listed) = (vec![false; nodes.len()], vec![false; nodes.len()]);
    for holder in holders.iter().flatten() {
        moves[*holder] = true;
        is_listed[*holder] = true;
        if options.all_nodes_move {
            way(nodes, *holder).for_each(|above| is_listed[above] = true);
        }
    }
    let mut out = NodeGroups::default();
    // Place of each node among those that may move, and the group of what it holds.
    let mut places: Vec<Option<u32>> = vec![None; nodes.len()];
    let mut groups = vec![0u32; nodes.len()];
    let mut inherited = vec![1.0; nodes.len()];
    for (i, placed) in nodes.iter().enumerate() {
        inherited[i] = densities[i].unwrap_or_else(|| placed.parent.map_or(1.0, |parent| inherited[parent]));
        if !is_listed[i] {
            continue;
        }
        let parent = way(nodes, i).find_map(|above| places[above]);
        let name = source.root.nodes[placed.index].name.clone().unwrap_or_default();
        let origin = placed.world.w_axis.truncate();
        places[i] = Some(out.nodes.len() as u32);
        if moves[i] {
            out.groups.push(Group { name: name.clone(), density: inherited[i], node: places[i] });
            out.pivots.push(if origin.is_finite() { origin } else { DVec3::ZERO });
            groups[i] = out.groups.len() as u32;
        }
        out.nodes.push(Node { name, parent, origin: origin.to_array() });
    }
    let mut of_node: Vec<u32> =
        holders.iter().map(|holder| holder.map_or(0, |holder| groups[holder])).collect();
    for (i, placed) in nodes.iter().enumerate().filter(|(i, _)| deforms[*i]) {
        if way(nodes, i).any(is_group) {
            let problem = "an animation deforms it, so that it does not move by hand";
            told.notes.push(format!("{}: {problem}", node::name(source, placed.index)));
        }
        if out.groups.len() == MAX_GROUPS {
            let problem = format!("there can be {MAX_GROUPS} groups, so that it has none of its own");
            told.notes.push(format!("{}: {problem}", node::name(source, placed.index)));
            continue;
        }
        let name = source.root.nodes[placed.index].name.clone().unwrap_or_default();
        out.groups.push(Group { name, density: inherited[i], node: None });
        out.pivots.push(DVec3::ZERO);
        of_node[i] = out.groups.len() as u32;
    }
    (out, of_node, places)
}

/// The groups by material that are wanted: names that no group of nodes has, nor a node at or above what `deforms`.
pub(super) fn of_materials(
    source: &Source,
    nodes: &[PlacedNode],
    deforms: &[bool],
    groups: &NodeGroups,
    options: &LoadOptions,
) -> Vec<MaterialGroup> {
    let name = |i: usize| source.root.nodes[nodes[i].index].name.as_deref().unwrap_or_default();
    let is_above = |own: &str| {
        let mut deforming = (0..nodes.len()).filter(|i| deforms[*i]);
        deforming.any(|i| way(nodes, i).any(|above| name(above) == own))
    };
    let is_node = |option: &&GroupOption| {
        groups.nodes.iter().any(|node| node.name == option.name) || is_above(&option.name)
    };
    let group = |option: &GroupOption| MaterialGroup { name: option.name.clone(), density: option.density };
    options.groups.iter().filter(|option| !is_node(option)).map(group).collect()
}

/// A node and those above it.
fn way(nodes: &[PlacedNode], i: usize) -> impl Iterator<Item = usize> + '_ {
    std::iter::successors(Some(i), |at| nodes[*at].parent)
}

/// Density that a node is given; `None` for a node that is no group by itself.
fn density(source: &Source, node: &PlacedNode, wanted: &[GroupOption], told: &mut Told) -> Option<f32> {
    let own = source.root.nodes[node.index].name.as_deref().unwrap_or_default();
    if let Some(option) = wanted.iter().find(|option| option.name == own) {
        return Some(option.density);
    }
    let extras = source.exact.nodes.get(node.index).map(|node| &node.extras["rebounce"]["group"])?;
    let density = match extras {
        serde_json::Value::Null | serde_json::Value::Bool(false) => return None,
        serde_json::Value::Bool(true) => Some(1.0),
        value => {
            value.as_f64().filter(|x| (1.0 / f64::from(MAX_DENSITY)..=f64::from(MAX_DENSITY)).contains(x))
        }
    };
    if density.is_none() {
        let node = node::name(source, node.index);
        told.notes.push(format!("{node}: extras.rebounce.group is no density; it is passed over"));
    }
    density.map(|density| density as f32)
}

/// The node whose group the mesh of each node belongs to; `None` for those of group 0, and for what `deforms`. Where there are more nodes with
/// meshes than groups, the nodes above take in those below, the deepest ones first. Also returns whether there are still more.
fn holders(
    source: &Source,
    nodes: &[PlacedNode],
    deforms: &[bool],
    is_group: impl Fn(usize) -> bool,
) -> (Vec<Option<usize>>, bool) {
    let has_mesh = |i: usize| source.root.nodes[nodes[i].index].mesh.is_some() && !deforms[i];
    let depth = |i: usize| way(nodes, i).count();
    let nearest = |i: usize| way(nodes, i).find(|at| is_group(*at));
    let mut holders: Vec<Option<usize>> =
        (0..nodes.len()).map(|i| if has_mesh(i) { nearest(i) } else { None }).collect();
    let mut most = holders.iter().flatten().map(|holder| depth(*holder)).max().unwrap_or(0);
    loop {
        let mut number = vec![0usize; nodes.len()];
        holders.iter().flatten().for_each(|holder| number[*holder] = 1);
        let mut count = 0;
        for number in &mut number {
            count += *number;
            *number = count;
        }
        if count <= MAX_GROUPS {
            return (holders, false);
        }
        if most <= 1 {
            let some =
                holders.into_iter().map(|holder| holder.filter(|holder| number[*holder] <= MAX_GROUPS));
            return (some.collect(), true);
        }
        most -= 1;
        for holder in holders.iter_mut().flatten().filter(|holder| depth(**holder) > most) {
            *holder = nodes[*holder].parent.and_then(nearest).unwrap_or(*holder);
        }
    }
}
