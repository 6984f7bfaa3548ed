// Glossy patches; as shared/src/antiradiance/lobe.rs.

struct Glossy {
    // Its element.
    element: u32,
    // Of its lobe, as wide as a bin at least.
    alpha: f32,
}

@group(0) @binding(3) var<storage, read> glossy: array<Glossy>;

// The cell of a thread: glossy patch and bin.
fn glossy_cell(group: vec3u, thread: u32) -> vec2u {
    let k = (group.y * pass_.groups + group.x) * 64u + thread;
    return vec2u(k / pass_.bins, k % pass_.bins);
}
