//! Build of a BVH8 over boxes, by obvhs' PLOC builder (Meister and Bittner 2018, *Parallel Locally-Ordered Clustering*).

use super::{Bvh8, reinsertion};
use glam::{Vec3, Vec3A};
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::ploc::PlocBuilder;
use obvhs::ploc::morton::morton_encode_u64_unorm;
use obvhs::{Boundable, BvhBuildParams, aabb::Aabb};
use rayon::prelude::*;

/// PaddedBox box, the input of a BVH build.
#[derive(Clone, Copy)]
pub(in crate::geometry) struct PaddedBox(pub Aabb);

impl PaddedBox {
    pub fn new((low, high): (Vec3, Vec3), padding: f32) -> Self {
        let padding = Vec3A::splat(padding);
        Self(Aabb::new(Vec3A::from(low) - padding, Vec3A::from(high) + padding))
    }
}

impl Boundable for PaddedBox {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

/// Builds a BVH8 over boxes, with at most `leaf` boxes per leaf; also returns the leaf order.
pub(in crate::geometry) fn build(boxes: &[PaddedBox], leaf: u32) -> (Bvh8, Vec<u32>) {
    if boxes.is_empty() {
        return Default::default();
    }
    let preset = BvhBuildParams::medium_build();
    let order = morton_order(boxes);
    let sorted: Vec<PaddedBox> = order.iter().map(|number| boxes[*number as usize]).collect();
    // The steps of obvhs' `build_bvh2`, which reads a clock that wasm32 lacks.
    let mut binary = PlocBuilder::with_capacity(boxes.len()).build(
        preset.ploc_search_distance,
        &sorted,
        (0..boxes.len() as u32).collect(),
        preset.sort_precision,
        preset.search_depth_threshold,
    );
    reinsertion::optimize(&mut binary, preset.reinsertion_batch_ratio);
    collapse(&mut binary, leaf, preset.collapse_traversal_cost);
    let again = preset.reinsertion_batch_ratio * preset.post_collapse_reinsertion_batch_ratio_multiplier;
    reinsertion::optimize(&mut binary, again);
    let (bvh, leaves) = Bvh8::new(&binary);
    (bvh, leaves.into_iter().map(|place| order[place as usize]).collect())
}

/// Numbers of boxes in ascending order of the Morton codes of their centres, equal ones by number. obvhs sorts by the
/// same codes with an unstable sort that depends on the processor's word; what is sorted it leaves as it is.
fn morton_order(boxes: &[PaddedBox]) -> Vec<u32> {
    let mut all = Aabb::empty();
    boxes.iter().for_each(|of| {
        all.extend(of.0.min);
        all.extend(of.0.max);
    });
    let scale = 1.0 / all.diagonal().as_dvec3();
    let offset = -all.min.as_dvec3() * scale;
    let code = |of: &PaddedBox| morton_encode_u64_unorm(of.0.center().as_dvec3() * scale + offset);
    let mut codes: Vec<(u64, u32)> = boxes.iter().map(code).zip(0..).collect();
    codes.par_sort_unstable();
    codes.into_iter().map(|(_, number)| number).collect()
}
