// What a dispatch of a solution works on.
struct Pass {
    // First receiver, and how many.
    first: u32,
    count: u32,
    // Workgroups of the grid in x.
    groups: u32,
    sender_level: u32,
    levels: u32,
    rays: u32,
    // Number of the pass: directions differ.
    number: u32,
    // 1 where the basis is evaluated at hits.
    exact: u32,
    // First node of the BVH over the models.
    top: u32,
    // Support radius of the finest level.
    finest_radius: f32,
    epsilon: f32,
    significance: f32,
    // 1 where all points of the level are gathered for; where none is.
    whole: u32,
    none: u32,
    // Factor of values added to a sum; number of the bounce.
    factor: f32,
    bounce: u32,
}

@group(0) @binding(0) var<uniform> pass_: Pass;

// States of a point in w of its value: it is gathered for and has no parents; its children are gathered for; a positive
// number is the least irradiance by which differences from the parents are judged, and 0 ends it.
const ORPHAN = -1.0;
const REFINED = 1e30;
