// The place that a pixel of another renderer's picture shows; in place of place.wgsl.

@group(0) @binding(0) var<uniform> frame: Frame;
// Position, local space; and the normal, 1 + x + 4096 y, its octahedral map in 12 bits each: 0 without a surface.
@group(0) @binding(2) var positions: texture_2d<f32>;

struct Place {
    position: vec3f,
    normal: vec3f,
    present: bool,
}

// Where a pixel's surface is; w is 0 without one.
fn seen(pixel: vec2u) -> vec4f {
    return textureLoad(positions, pixel, 0);
}

fn place_at(pixel: vec2u) -> Place {
    let at = seen(pixel);
    if at.w <= 0.0 {
        return Place(vec3f(0.0), vec3f(0.0), false);
    }
    let code = u32(at.w) - 1u;
    let square = vec2f(vec2u(code & 4095u, code >> 12u)) * (2.0 / 4095.0) - 1.0;
    return Place(at.xyz, octahedral_decode(square), true);
}
