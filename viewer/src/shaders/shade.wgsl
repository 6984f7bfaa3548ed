// Radiance of a pixel: what the surface makes of direct and bounced light, and its own light.
// Group 0; group 1 holds the lights.

// Bits of `flags`: the G-buffer holds what textures say; the picture is tone-mapped by AgX; the exposure is not
// measured.
const DETAILED = 1u;
const AGX = 2u;
const MANUAL = 4u;

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
    flags: u32,
    // Pixels of the screen across one of the picture.
    enlarge: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> shading: Shading;
@group(0) @binding(2) var albedo_texture: texture_2d<f32>;
@group(0) @binding(3) var surface_texture: texture_2d<u32>;
@group(0) @binding(4) var depth_texture: texture_depth_2d;
// Bounced irradiance by slot.
@group(0) @binding(5) var<storage, read> light: array<vec4f>;
// By material.
@group(0) @binding(6) var<storage, read> looks: array<Look>;
// The slot of every pixel that has one of its own, else 0.
@group(0) @binding(8) var<storage, read> slots: array<u32>;

// Irradiance that has bounced at least once, RGB, and its tilt.
fn bounced_irradiance(pixel: vec2u) -> mat2x3f {
    let slot = slots[pixel.y * u32(frame.width) + pixel.x];
    if slot != 0u {
        return mat2x3f(light[slot].rgb, tilt_unpack(light[slot].w));
    }
    let blocks = slots_blocks(frame);
    let low = pixel / 2u;
    let high = min((pixel + 1u) / 2u, blocks - 1u);
    let a = light[low.y * blocks.x + low.x];
    let b = light[low.y * blocks.x + high.x];
    let c = light[high.y * blocks.x + low.x];
    let d = light[high.y * blocks.x + high.x];
    var tilt = vec3f(0.0);
    if (shading.flags & DETAILED) != 0u {
        tilt = 0.25 * (tilt_unpack(a.w) + tilt_unpack(b.w) + tilt_unpack(c.w) + tilt_unpack(d.w));
    }
    return mat2x3f(0.25 * (a.rgb + b.rgb + (c.rgb + d.rgb)), tilt);
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
    let texel = textureLoad(surface_texture, pixel, 0);
    let material = looks[min(texel.y >> 16u, arrayLength(&looks) - 1u)];
    let detailed = (shading.flags & DETAILED) != 0u;
    let surface = surface_unpack(texel, material, detailed);
    var sum = vec3f(0.0);
    if shading.indirect > 0.0 {
        // All of a metal's reflectance, too, is its base colour, as in the bake.
        let bounced = bounced_irradiance(pixel);
        var turned = 1.0;
        if detailed {
            let tilt = bounced[1] - surface.normal * dot(surface.normal, bounced[1]);
            turned = clamp(dot(surface.bent, surface.normal + tilt), 0.0, STEEPEST);
        }
        sum += albedo.rgb / PI * bounced[0] * (turned * shading.indirect);
    }
    if shading.direct > 0.0 {
        let position = position_at(frame, vec2f(pixel) + 0.5, depth);
        let to_eye = normalize(frame.eye - position);
        var direct = surface.look.emission;
        for (var i = 0u; i < shading.lights; i++) {
            let at = lit(lights[i], position, surface.bent, surface.facet, 1, 0.0);
            if any(at.irradiance > vec3f(0.0)) {
                direct += at.irradiance * brdf(albedo.rgb, surface.look, surface.bent, at.to_light, to_eye);
            }
        }
        sum += shading.direct * direct;
    }
    return vec4f(sum, 1.0);
}
