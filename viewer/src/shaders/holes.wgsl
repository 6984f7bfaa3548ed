// Depth of the pixels that no function has covered yet; all others block the next coarser level.

override LEAST_WEIGHT: f32 = 1e-4;

@group(0) @binding(0) var sums: texture_2d<f32>;
@group(0) @binding(1) var depth_texture: texture_depth_2d;

@vertex
fn vertex(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    return vec4f(f32(corner & 1u) * 4.0 - 1.0, f32(corner >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @builtin(frag_depth) f32 {
    let pixel = vec2u(position.xy);
    let depth = textureLoad(depth_texture, pixel, 0);
    return select(depth, 1.0, depth <= 0.0 || textureLoad(sums, pixel, 0).w > LEAST_WEIGHT);
}
