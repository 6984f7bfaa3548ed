// What one dispatch of the relighting works on.
struct Step {
    // First point, or row of links.
    first: u32,
    count: u32,
    // Number of lights; index of the chunk's first link.
    extra: u32,
    // Threads of the grid in x; where threads share rows, workgroups.
    threads: u32,
    // 1 where the scene has normal maps.
    tilts: u32,
}

@group(0) @binding(0) var<uniform> step_: Step;
