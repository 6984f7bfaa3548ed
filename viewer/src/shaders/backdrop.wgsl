// What a picture shows besides radiance: unlit surfaces, and where there is no surface the backdrop of an object, as
// rebounce_shared::backdrop has it.

struct Ground {
    // Least and greatest x and z of the shadow.
    low: vec2f,
    high: vec2f,
    height: f32,
    // Four squares in 32 bits.
    shade: array<vec4u, 64>,
}

@group(0) @binding(12) var<uniform> ground: Ground;

const BELOW = 0.42;
const ABOVE = 0.16;
const TURN = vec2f(-0.5, 0.5);
const DARK = 0.75;
// Squares of the shadow along each side.
const SIDE = 32;

fn shade_of(square: vec2i) -> f32 {
    if any(square < vec2i(0)) || any(square >= vec2i(SIDE)) {
        return 0.0;
    }
    let i = square.y * SIDE + square.x;
    return unpack4x8unorm(ground.shade[i / 16][i / 4 % 4])[i % 4];
}

fn backdrop(pixel: vec2u) -> vec3f {
    let at = (vec2f(pixel) + 0.5) / vec2f(frame.width, frame.height) * 2.0 - 1.0;
    let way = frame.forward + at.x * frame.right - at.y * frame.up;
    var grey = mix(BELOW, ABOVE, smoothstep(TURN.x, TURN.y, normalize(way).y));
    let away = (ground.height - frame.eye.y) / way.y;
    if way.y < 0.0 && away > 0.0 {
        let place = ((frame.eye + away * way).xz - ground.low) / (ground.high - ground.low) * f32(SIDE) - 0.5;
        let square = vec2i(clamp(floor(place), vec2f(-9.0), vec2f(99.0)));
        let share = place - floor(place);
        let near = mix(shade_of(square), shade_of(square + vec2i(1, 0)), share.x);
        let far = mix(shade_of(square + vec2i(0, 1)), shade_of(square + vec2i(1, 1)), share.x);
        grey *= 1.0 - DARK * mix(near, far, share.y);
    }
    return vec3f(grey);
}

// Linear display values, whatever the light and the exposure.
fn besides(place: vec2u) -> vec3f {
    let pixel = mended(place);
    var sum = vec3f(0.0);
    let texel = textureLoad(surface_texture, pixel, 0);
    let albedo = textureLoad(albedo_texture, pixel, 0);
    if textureLoad(depth_texture, pixel, 0) <= 0.0 {
        if (shading.flags & BACKDROP) != 0u {
            sum = backdrop(pixel);
        }
    } else {
        sum = albedo.rgb * looks[min(texel.y >> 16u, arrayLength(&looks) - 1u)].unlit;
    }
    if (shading.flags & TINTED) != 0u {
        return sum * textureLoad(through_texture, pixel, 0).rgb + textureLoad(shine_texture, pixel, 0).rgb;
    }
    if (shading.flags & VEILED) != 0u {
        sum *= 1.0 - textureLoad(veil_texture, pixel, 0).a;
    }
    return sum;
}
