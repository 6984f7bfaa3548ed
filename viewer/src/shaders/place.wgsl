// The place that a pixel of the G-buffer shows.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(2) var depth_texture: texture_depth_2d;
@group(0) @binding(3) var surface_texture: texture_2d<u32>;

struct Place {
    position: vec3f,
    normal: vec3f,
    present: bool,
}

fn place_at(pixel: vec2u) -> Place {
    let depth = textureLoad(depth_texture, pixel, 0);
    if depth <= 0.0 {
        return Place(vec3f(0.0), vec3f(0.0), false);
    }
    let normal = unpack_normal(textureLoad(surface_texture, pixel, 0).x);
    return Place(position_at(frame, vec2f(pixel) + 0.5, depth), normal, true);
}
