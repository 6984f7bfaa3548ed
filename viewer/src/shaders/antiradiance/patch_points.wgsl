// Light between the points of a file and the patches that stand for them.

struct Points {
    // First point or patch, and how many.
    first: u32,
    count: u32,
    // Workgroups of the grid in x.
    groups: u32,
    // Number of lights.
    lights: u32,
}

@group(0) @binding(0) var<uniform> points_: Points;

fn number_of(group: vec3u, thread: u32) -> u32 {
    return (group.y * points_.groups + group.x) * 64u + thread;
}
