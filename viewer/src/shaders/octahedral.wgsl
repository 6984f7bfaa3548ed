// Unit vectors packed by the octahedral map; as shared/src/octahedral.rs.

fn sign_not_zero(v: vec2f) -> vec2f {
    return select(vec2f(-1.0), vec2f(1.0), v >= vec2f(0.0));
}

fn octahedral_decode(p: vec2f) -> vec3f {
    let z = 1.0 - abs(p.x) - abs(p.y);
    let fold = max(-z, 0.0);
    return normalize(vec3f(p - fold * sign_not_zero(p), z));
}

fn octahedral_encode(v: vec3f) -> vec2f {
    let p = v.xy / (abs(v.x) + abs(v.y) + abs(v.z));
    return select(p, (1.0 - abs(p.yx)) * sign_not_zero(p), v.z < 0.0);
}

fn unpack_normal(bits: u32) -> vec3f {
    return octahedral_decode(unpack2x16snorm(bits));
}

fn pack_normal(v: vec3f) -> u32 {
    return pack2x16snorm(octahedral_encode(v));
}
