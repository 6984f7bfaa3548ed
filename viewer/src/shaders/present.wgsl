// Encodes sRGB and dithers to 8 bits. A picture that is not yet averaged may have its edges smoothed; a sketch is enlarged.

struct Shading {
    lights: vec4f,
    // Share of the picture in the average so far.
    blend: f32,
    scale: u32,
    flags: u32,
    // Pixels of the screen across one of the picture.
    enlarge: u32,
}

// In shade.wgsl are the other flags.
const SMOOTH = 128u;

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var bilinear: sampler;
@group(0) @binding(2) var<uniform> shading: Shading;

fn encode(c: vec3f) -> vec3f {
    return select(1.055 * pow(c, vec3f(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3f(0.0031308));
}

// Evenly spread noise in [0, 1) (Jimenez, interleaved gradient noise).
fn noise(pixel: vec2f) -> f32 {
    return fract(52.9829189 * fract(dot(pixel, vec2f(0.06711056, 0.00583715))));
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let place = position.xy / f32(shading.enlarge);
    var color = bilinear_at(place);
    if (shading.flags & SMOOTH) != 0u {
        color = smoothed(place);
    }
    return vec4f(encode(saturate(color)) + (noise(position.xy) - 0.5) / 255.0, 1.0);
}
