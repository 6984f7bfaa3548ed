// A level of the basis, as splatting (splat.wgsl) draws it.

struct Level {
    // Its points.
    first: u32,
    count: u32,
    // 0 for the coarsest.
    index: u32,
    // 1 for the finest, which is drawn first, and wherever there is a surface.
    finest: u32,
    // 1 where the scene has normal maps.
    tilts: u32,
}

@group(0) @binding(1) var<uniform> level: Level;
