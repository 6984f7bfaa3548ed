// Radiance of a pixel: albedo / pi times direct and bounced irradiance, and the surface's own light.
// Group 0; group 1 holds the lights.

const PI = 3.14159265358979;

struct Shading {
    // 1 where direct, bounced light are shown.
    direct: f32,
    indirect: f32,
    // Number of lights.
    lights: u32,
    // 2^EV.
    exposure: f32,
    // Share of this picture in the average so far.
    blend: f32,
    // Pixels across one output pixel, where the picture is made larger and averaged.
    scale: u32,
    pad: vec2u,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> shading: Shading;
@group(0) @binding(2) var albedo_texture: texture_2d<f32>;
@group(0) @binding(3) var surface_texture: texture_2d<u32>;
@group(0) @binding(4) var depth_texture: texture_depth_2d;
// Bounced irradiance by slot.
@group(0) @binding(5) var<storage, read> light: array<vec4f>;
// Radiance that the materials send out themselves.
@group(0) @binding(6) var<storage, read> emission: array<vec4f>;
// The slot of every pixel that has one of its own, else 0.
@group(0) @binding(8) var<storage, read> slots: array<u32>;

// Irradiance that has bounced at least once.
fn bounced_irradiance(pixel: vec2u) -> vec3f {
    let slot = slots[pixel.y * u32(frame.width) + pixel.x];
    if slot != 0u {
        return light[slot].rgb;
    }
    let blocks = slots_blocks(frame);
    let low = pixel / 2u;
    let high = min((pixel + 1u) / 2u, blocks - 1u);
    let above = light[low.y * blocks.x + low.x].rgb + light[low.y * blocks.x + high.x].rgb;
    let below = light[high.y * blocks.x + low.x].rgb + light[high.y * blocks.x + high.x].rgb;
    return 0.25 * (above + below);
}

// rgb: radiance; alpha: 1 where there is a surface.
fn radiance(pixel: vec2u) -> vec4f {
    let depth = textureLoad(depth_texture, pixel, 0);
    if depth <= 0.0 {
        return vec4f(0.0);
    }
    let albedo = textureLoad(albedo_texture, pixel, 0);
    if albedo.a < 0.5 {
        return vec4f(0.0, 0.0, 0.0, 1.0);
    }
    let surface = textureLoad(surface_texture, pixel, 0).xy;
    var irradiance = vec3f(0.0);
    if shading.indirect > 0.0 {
        irradiance += shading.indirect * bounced_irradiance(pixel);
    }
    var own = vec3f(0.0);
    if shading.direct > 0.0 {
        let position = position_at(frame, vec2f(pixel) + 0.5, depth);
        let flat_normal = octahedral_decode(unpack4x8snorm(surface.y & 0xffffu).xy);
        irradiance += shading.direct
            * direct_irradiance(position, unpack_normal(surface.x), flat_normal, shading.lights, 1, 0.0);
        own = shading.direct * emission[min(surface.y >> 16u, arrayLength(&emission) - 1u)].rgb;
    }
    return vec4f(albedo.rgb / PI * irradiance + own, 1.0);
}
