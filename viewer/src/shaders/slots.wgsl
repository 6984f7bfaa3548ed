// Where the bounced light of a pixel comes from. Every pixel with even coordinates has a row of functions
// and weights, in slot y / 2 · blocks + x / 2. Other pixels are interpolated from their neighbours among
// these, or have a row of their own where the neighbours lie on another surface or too far apart.

// An entry of a pixel's row: bits 0 to 21 the function, 22 to 31 the root of its weight, so that small weights
// keep digits too. 0 ends a row. Entry k of a row lies at k · capacity + slot.
const POINT_MASK = 0x3fffffu;

struct Slots {
    // Rows that fit, and the entries of each.
    capacity: u32,
    row_length: u32,
    // Pixels further apart than this are not interpolated, scene units: a share of the finest supports.
    reach: f32,
    // 1 where the scene has normal maps.
    tilts: u32,
}

fn slots_blocks(frame: Frame) -> vec2u {
    return (vec2u(u32(frame.width), u32(frame.height)) + 1u) / 2u;
}

fn slots_entry(point: u32, weight: f32) -> u32 {
    return point | (clamp(u32(sqrt(weight) * 1023.0 + 0.5), 1u, 1023u) << 22u);
}

fn slots_weight(entry: u32) -> f32 {
    let root = f32(entry >> 22u);
    return root * root;
}
