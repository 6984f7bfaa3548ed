//! Reinsertion optimization of a binary BVH (Meister and Bittner, *Parallel Reinsertion for Bounding Volume Hierarchy
//! Optimization*, Eurographics 2018), with obvhs' search and insertion.
//!
//! `obvhs::bvh2::reinsertion::ReinsertionOptimizer` sorts with unstable sorts whose order of equal keys depends on the
//! processor's word. Here equal keys keep the order of the nodes, so that a scene has one BVH on every machine.

use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::{Reinsertion, find_reinsertion, reinsert_node};
use rayon::prelude::*;

/// Passes, each over a share of the nodes: 1, 1/3, 1/5 and so on of the batch.
const PASSES: usize = 16;

/// Moves nodes to where the sum of areas is less. `batch` is the share of the nodes that the first pass looks at.
pub(super) fn optimize(bvh: &mut Bvh2, batch: f32) {
    if bvh.nodes.first().is_none_or(|root| root.is_leaf()) {
        return;
    }
    bvh.init_parents_if_uninit();
    bvh.children_are_ordered_after_parents = false;
    let mut touched = vec![false; bvh.nodes.len()];
    for pass in 0..PASSES {
        let share = batch / (2 * pass + 1) as f32;
        let count = ((bvh.nodes.len() as f32 * share) as usize).max(1).min(bvh.nodes.len() - 1);
        let candidates = candidates(bvh, count);
        let mut found: Vec<Reinsertion> =
            candidates.par_iter().map(|node| find_reinsertion(bvh, *node as usize)).collect();
        found.retain(|reinsertion| reinsertion.area_diff > 0.0);
        found.sort_by(|a, b| b.area_diff.total_cmp(&a.area_diff));
        touched.fill(false);
        for Reinsertion { from, to, .. } in found {
            let (from, to) = (from as usize, to as usize);
            let conflicts = [
                to,
                from,
                Bvh2Node::get_sibling_id(from),
                bvh.parents[to] as usize,
                bvh.parents[from] as usize,
            ];
            if !conflicts.iter().any(|node| touched[*node]) {
                conflicts.iter().for_each(|node| touched[*node] = true);
                reinsert_node(bvh, from, to);
            }
        }
    }
}

/// The `count` largest of the first nodes.
fn candidates(bvh: &Bvh2, count: usize) -> Vec<u32> {
    let first = bvh.nodes.iter().enumerate().take(2 * (count + 1)).skip(1);
    let mut candidates: Vec<(f32, u32)> =
        first.map(|(node, of)| (of.aabb().half_area(), node as u32)).collect();
    candidates.sort_by(|a, b| b.0.total_cmp(&a.0));
    candidates.truncate(count);
    candidates.into_iter().map(|(_, node)| node).collect()
}
