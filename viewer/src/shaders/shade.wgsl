// Radiance of a pixel: albedo / pi times direct and bounced irradiance, and the surface's own light.
// Group 0; group 1 holds the lights.

const PI = 3.14159265358979;

struct Shading {
    // 1 where direct, bounced light are shown.
    direct: f32,
    indirect: f32,
    // Number of lights.
    lights: u32,
    // What the splats' sums were multiplied with.
    splat_scale: f32,
    // 2^EV.
    exposure: f32,
    // Share of this picture in the average so far.
    blend: f32,
    // Pixels across one output pixel, where the picture is made larger and averaged.
    scale: u32,
    pad: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> shading: Shading;
@group(0) @binding(2) var albedo_texture: texture_2d<f32>;
@group(0) @binding(3) var surface_texture: texture_2d<u32>;
@group(0) @binding(4) var depth_texture: texture_depth_2d;
@group(0) @binding(5) var sums: texture_2d<f32>;
// Radiance that the materials send out themselves.
@group(0) @binding(6) var<storage, read> emission: array<vec4f>;

// Irradiance that has bounced at least once.
fn bounced_irradiance(pixel: vec2u) -> vec3f {
    let sum = textureLoad(sums, pixel, 0);
    return max(sum.rgb, vec3f(0.0)) / max(sum.a * shading.splat_scale, 1e-30);
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
