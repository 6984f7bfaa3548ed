// LANES threads share a row, 64 / LANES rows a workgroup: neighbouring links are read together.

override LANES: u32 = 8u;

// The row of a thread, counted from the dispatch's first.
fn lanes_row(group: vec3u, thread: u32) -> u32 {
    return (group.x + group.y * step_.threads) * (64u / LANES) + thread / LANES;
}
