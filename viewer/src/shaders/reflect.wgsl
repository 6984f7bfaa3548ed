// What a surface sends to the eye: what it makes of direct and bounced light, and its own light.
// Group 0; group LIGHTS holds the lights.

// Bits of `flags`: textures say more than colours; the picture is tone-mapped by AgX; the exposure is not measured;
// there are blended surfaces; some of them let light through in a colour; some surfaces are unlit; what is behind all of them
// is a backdrop.
const DETAILED = 1u;
const AGX = 2u;
const MANUAL = 4u;
const VEILED = 8u;
const TINTED = 16u;
const UNLIT = 32u;
const BACKDROP = 64u;

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
    // What the radiance of blended surfaces is multiplied with to fit 16-bit floats.
    unit: f32,
    // Skies behind the scene; mip level of their texture.
    skies: u32,
    sky_level: f32,
    // By sky: factor of the texture, RGB, and rotation in radians.
    sky: array<vec4f, 4>,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> shading: Shading;
// RGB radiance. `bounced`: irradiance that has bounced at least once, RGB, and its tilt (tilt.wgsl). `solid`: it is not
// blended.
fn reflected(surface: Surface, albedo: vec3f, position: vec3f, bounced: mat2x3f, solid: bool) -> vec3f {
    var sum = vec3f(0.0);
    if shading.indirect > 0.0 {
        // All of a metal's reflectance, too, is its base colour, as in the bake.
        var turned = 1.0;
        if (shading.flags & DETAILED) != 0u {
            let tilt = bounced[1] - surface.normal * dot(surface.normal, bounced[1]);
            turned = clamp(dot(surface.bent, surface.normal + tilt), 0.0, STEEPEST);
        }
        sum += albedo / PI * bounced[0] * (turned * shading.indirect);
    }
    if shading.direct > 0.0 {
        let to_eye = normalize(frame.eye - position);
        var direct = surface.look.emission;
        for (var i = 0u; i < shading.lights; i++) {
            let at = lit_softly(lights[i], position, surface.bent, surface.facet, solid);
            if any(at.irradiance > vec3f(0.0)) {
                var to_light = at.to_light;
                if at.solid > 0.0 {
                    to_light = area_highlight(lights[i], position, reflect(-to_eye, surface.bent));
                }
                direct += at.irradiance * brdf(albedo, surface.look, surface.bent, to_light, to_eye, at.solid);
            }
        }
        sum += shading.direct * direct;
    }
    return sum;
}
