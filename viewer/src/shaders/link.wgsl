// The packed transport link and the packed interpolation entry; as shared/src/link.rs and
// shared/src/interpolation.rs.

const PAGE_MARK = 0xf8000000u;

fn link_column(link: vec2u) -> u32 {
    return link.y & 0xffffu;
}

fn link_direction(link: vec2u) -> vec3f {
    return octahedral_decode(unpack4x8snorm(link.y >> 16u).xy);
}

fn link_magnitude(link: vec2u) -> vec3f {
    // 2^(E - 38), by its bits.
    let step = bitcast<f32>(((link.x >> 27u) + 89u) << 23u);
    let c = bitcast<i32>(link.x);
    return vec3f(vec3i(extractBits(c, 0u, 9u), extractBits(c, 9u, 9u), extractBits(c, 18u, 9u))) * step;
}

fn entry_point(entry: u32) -> u32 {
    return entry & 0x3fffffu;
}

fn entry_weight(entry: u32) -> f32 {
    return f32(entry >> 22u);
}
