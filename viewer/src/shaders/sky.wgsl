// The sky behind a scene: equirectangular radiance by world direction, as shared/src/environment/picture.rs and
// `Lighting::behind` of shared/src/lighting.rs.

@group(0) @binding(13) var sky_texture: texture_2d<f32>;
@group(0) @binding(14) var sky_sampler: sampler;

const TAU = 6.28318530717959;

// rgb: radiance; alpha: 1 where there is a sky.
fn sky(pixel: vec2u) -> vec4f {
    let at = (vec2f(pixel) + 0.5) / vec2f(frame.width, frame.height) * 2.0 - 1.0;
    let way = frame.forward + at.x * frame.right - at.y * frame.up;
    // Texels of the first level across a pixel.
    let wide = f32(textureDimensions(sky_texture).x) / TAU * 2.0 * length(frame.right) / frame.width;
    let level = max(shading.sky_level, select(log2(wide), 0.0, frame.unfiltered != 0u));
    var sum = vec3f(0.0);
    for (var k = 0u; k < shading.skies; k++) {
        let one = shading.sky[k];
        let cosine = cos(one.w);
        let sine = sin(one.w);
        let x = cosine * way.x - sine * way.z;
        let z = sine * way.x + cosine * way.z;
        // At the pole any azimuth will do.
        let azimuth = atan2(z, select(x, 1e-20, x == 0.0));
        let place = vec2f(azimuth / TAU + 0.5, 2.0 / TAU * atan2(length(way.xz), way.y));
        sum += one.rgb * textureSampleLevel(sky_texture, sky_sampler, place, level).rgb;
    }
    return vec4f(sum, select(0.0, 1.0, shading.skies > 0u));
}
