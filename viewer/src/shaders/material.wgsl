// A material and its cut-outs. Group 1 holds the material of the present draw call.

const OPAQUE = 0u;
const MASK = 1u;
const BLEND = 2u;

struct Material {
    base_color: vec4f,
    alpha_mode: u32,
    cutoff: f32,
    double_sided: u32,
    index: u32,
    metallic: f32,
    roughness: f32,
    normal_scale: f32,
    // Which of the textures below there are: 1 emission, 2 metalness and roughness, 4 normals.
    details: u32,
    // 1 where any material of the scene has one of them.
    wide: u32,
    // Their coordinates from the vertex's (u, v, 1), two rows each.
    uv_from_vertex: array<vec4f, 6>,
}

@group(1) @binding(0) var<uniform> material: Material;
@group(1) @binding(1) var base_color_texture: texture_2d<f32>;
@group(1) @binding(2) var color_sampler: sampler;
@group(1) @binding(3) var alpha_sampler: sampler;
// For level 0 alone: some adapters' anisotropic filter walks over every texel that a pixel covers there.
@group(1) @binding(4) var plain_sampler: sampler;

// Thresholds at (k + 1/2) / 16 that spread evenly over every 4x4 texels (a Bayer matrix).
fn dither(texel: vec2f) -> f32 {
    let x = u32(texel.x);
    let y = u32(texel.y);
    let a = (x ^ y) & 1u;
    let b = y & 1u;
    let c = ((x ^ y) >> 1u) & 1u;
    let d = (y >> 1u) & 1u;
    return (f32(a * 8u + b * 4u + c * 2u + d) + 0.5) / 16.0;
}

// Whether the surface is there at uv: for blended materials in a share alpha of the texels, which only shadow maps draw.
fn covered(uv: vec2f, texel: vec2f) -> bool {
    if material.alpha_mode == OPAQUE {
        return true;
    }
    let alpha = material.base_color.a * textureSampleLevel(base_color_texture, alpha_sampler, uv, 0.0).a;
    if material.alpha_mode == MASK {
        return alpha >= material.cutoff;
    }
    return alpha > dither(texel);
}
