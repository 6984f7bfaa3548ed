// The place that a pixel of the G-buffer shows.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var depth_texture: texture_depth_2d;
@group(0) @binding(3) var surface_texture: texture_2d<u32>;

struct Place {
    position: vec3f,
    normal: vec3f,
    present: bool,
}

// Where a pixel's surface is; w is 0 without one.
fn seen(pixel: vec2u) -> vec4f {
    let depth = textureLoad(depth_texture, pixel, 0);
    return vec4f(position_at(frame, vec2f(pixel) + 0.5, depth), depth);
}

fn place_at(pixel: vec2u) -> Place {
    let at = seen(pixel);
    if at.w <= 0.0 {
        return Place(vec3f(0.0), vec3f(0.0), false);
    }
    return Place(at.xyz, unpack_normal(textureLoad(surface_texture, pixel, 0).x), true);
}
