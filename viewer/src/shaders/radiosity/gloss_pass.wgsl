// What a dispatch of glossy transfer works on.
struct GlossPass {
    // First of the transfer's points, and how many.
    first: u32,
    count: u32,
    // Workgroups of the grid in x.
    groups: u32,
    // Matrices of a point: 1 or 3, or 0 where there is visibility alone.
    channels: u32,
    components: u32,
    // Vectors of all clusters.
    vectors: u32,
    // Points of the file: senders beyond are groups of emissive surfaces.
    points: u32,
}

@group(0) @binding(0) var<uniform> pass_: GlossPass;

// A signed byte of packed ones.
fn signed_byte(word: u32, i: u32) -> f32 {
    return f32(extractBits(bitcast<i32>(word), 8u * (i & 3u), 8u));
}
