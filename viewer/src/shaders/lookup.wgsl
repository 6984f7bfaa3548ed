// Which functions may cover a place; made by lookup.rs.

@group(0) @binding(6) var<storage, read> lookup: array<u32>;

const LEVEL_WORDS = 3u;

fn cell_hash(cell: vec3i, group: u32) -> u32 {
    let c = vec3u(cell);
    let h = (c.x * 0x8da6b343u) ^ (c.y * 0xd8163841u) ^ (c.z * 0xcb1ab31fu) ^ (group * 0x85ebca6bu);
    return ((h ^ (h >> 15u)) * 0x9e3779b9u) >> 3u;
}

// Begin and end of the list, in `lookup`, of the functions of a level that may cover this place of a group.
fn bucket(level: u32, position: vec3f, group: u32) -> vec2u {
    let head = 1u + LEVEL_WORDS * level;
    let cell = vec3i(floor(position * bitcast<f32>(lookup[head])));
    let at = lookup[head + 1u] + (cell_hash(cell, group) & lookup[head + 2u]);
    return vec2u(lookup[at], lookup[at + 1u]);
}
