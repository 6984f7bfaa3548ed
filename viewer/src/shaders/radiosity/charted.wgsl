// Bounced light where a file may have a lightmap: lightmap.wgsl has drawn it.

// The file has a lightmap: a bit of `flags`.
const CHARTED = 256u;

// RGB irradiance; alpha: 1 where the surface has a chart. Any texture where there is no lightmap.
@group(0) @binding(15) var lightmap_picture: texture_2d<f32>;

// Irradiance that has bounced at least once, RGB, and its tilt: a lightmap has none.
fn shown_bounced(pixel: vec2u, tilts: bool) -> mat2x3f {
    if (shading.flags & CHARTED) != 0u {
        let charted = textureLoad(lightmap_picture, pixel, 0);
        if charted.a > 0.0 {
            return mat2x3f(charted.rgb, vec3f(0.0));
        }
    }
    return bounced_irradiance(pixel, tilts);
}
