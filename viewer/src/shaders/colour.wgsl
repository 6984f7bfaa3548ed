// Colours in four bytes; as shared/src/colour.rs.

fn unpack_rgb9e5(bits: u32) -> vec3f {
    let step = bitcast<f32>(((bits >> 27u) + 103u) << 23u);
    return vec3f(vec3u(bits & 511u, (bits >> 9u) & 511u, (bits >> 18u) & 511u)) * step;
}
