// The packed transport links and the packed interpolation entry; as shared/src/link.rs and
// shared/src/interpolation.rs.

fn link_sender(link: u32) -> u32 {
    return link & 0xfffffu;
}

fn link_amount(link: u32) -> f32 {
    // (1 + m / 8) · 2^(e - 30), by its bits; exponent and mantissa of zero are zero.
    let code = (link >> 20u) & 0xffu;
    let size = bitcast<f32>((code << 20u) + (97u << 23u));
    return select(select(size, -size, (link >> 31u) != 0u), 0.0, code == 0u);
}

fn entry_point(entry: u32) -> u32 {
    return entry & 0x3fffffu;
}

fn entry_weight(entry: u32) -> f32 {
    return f32(entry >> 22u);
}
