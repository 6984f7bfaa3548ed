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
    // Which of the textures below there are: 1 emission, 2 metalness and roughness, 4 normals, 8 transmission.
    details: u32,
    // 1 where any material of the scene has one of the first three.
    wide: u32,
    // 1 where light goes through besides what alpha says.
    glass: u32,
    transmission: f32,
    scattered: f32,
    // Their coordinates from the vertex's (u, v, 1), two rows each.
    uv_from_vertex: array<vec4f, 8>,
    // Colours of what goes through: passage.wgsl.
    transmission_tint: vec3f,
    scattered_color: vec3f,
}

@group(1) @binding(0) var<uniform> material: Material;
@group(1) @binding(1) var base_color_texture: texture_2d<f32>;
@group(1) @binding(2) var color_sampler: sampler;
@group(1) @binding(3) var alpha_sampler: sampler;
// For level 0 alone: some adapters' anisotropic filter walks over every texel that a pixel covers there.
@group(1) @binding(4) var plain_sampler: sampler;

// Thresholds at (k + 1/2) / 9 in every 3x3 texels of a shadow map: the mean of 3 x 3 taps (visibility.wgsl) is the same
// wherever they lie, so that shadows show no pattern. There are two arrangements. Texels that surfaces of both leave free
// are as many as the product of their shares says, to the nearest ninth.
fn dither(texel: vec2f, arrangement: u32) -> f32 {
    var order = array<vec2f, 9>(
        vec2f(0.0, 8.0), vec2f(7.0, 1.0), vec2f(3.0),
        vec2f(6.0), vec2f(5.0), vec2f(2.0),
        vec2f(4.0), vec2f(1.0, 7.0), vec2f(8.0, 0.0),
    );
    let at = vec2u(texel) % 3u;
    return (order[3u * at.y + at.x][arrangement & 1u] + 0.5) / 9.0;
}

// Whether the surface is there at uv. Only shadow maps draw blended ones, in a share alpha of the texels; both faces of
// a glass take light away, each by its own arrangement.
fn covered(uv: vec2f, texel: vec2f, front: bool) -> bool {
    if material.alpha_mode == OPAQUE {
        return true;
    }
    let alpha = material.base_color.a * textureSampleLevel(base_color_texture, alpha_sampler, uv, 0.0).a;
    if material.alpha_mode == MASK {
        return alpha >= material.cutoff;
    }
    return alpha > dither(texel, material.index + u32(front));
}
