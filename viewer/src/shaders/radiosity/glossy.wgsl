// Opaque surfaces where a file may have glossy transfer: reflections.wgsl has drawn what they reflect.

// The file has glossy transfer, and all light is shown: a bit of `flags`.
const GLOSSY = 512u;

// RGB radiance; alpha: 0 where nothing is reflected, else 1 plus the share of light that is left for what is below. Any
// texture where there are no reflections.
@group(0) @binding(16) var reflection_picture: texture_2d<f32>;

fn shaded(surface: Surface, albedo: vec3f, position: vec3f, bounced: mat2x3f, pixel: vec2u) -> vec3f {
    if (shading.flags & GLOSSY) == 0u {
        return reflected(surface, albedo, position, bounced, true);
    }
    let mirror = textureLoad(reflection_picture, pixel, 0);
    let left = select(1.0, mirror.a - 1.0, mirror.a > 0.0);
    return mirror.rgb + reflected(surface, albedo, position, mat2x3f(left * bounced[0], bounced[1]), true);
}
