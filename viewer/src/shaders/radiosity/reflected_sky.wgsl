// Environments as surfaces reflect them; `reflecting` says how they stand.

const TAU = 6.28318530717959;
// Pixels that the blur of a level spreads over.
const PIXELS = 8.0;

// Radiance of the skies from a direction, over about this solid angle.
fn reflected_sky(way: vec3f, solid_angle: f32) -> vec3f {
    let wide = TAU / f32(textureDimensions(sky_texture).x);
    let level = 0.5 * log2(solid_angle / (PIXELS * wide * wide));
    var sum = vec3f(0.0);
    for (var k = 0u; k < reflecting.skies; k++) {
        let one = reflecting.sky[k];
        let x = cos(one.w) * way.x - sin(one.w) * way.z;
        let z = sin(one.w) * way.x + cos(one.w) * way.z;
        let azimuth = atan2(z, select(x, 1e-20, x == 0.0));
        let at = vec2f(azimuth / TAU + 0.5, 2.0 / TAU * atan2(length(way.xz), way.y));
        sum += one.rgb * textureSampleLevel(sky_texture, sky_sampler, at, level).rgb;
    }
    return sum;
}
