// Halves a texture: the mean of four texels, through a bilinear sampler.

@group(0) @binding(0) var larger: texture_2d<f32>;
@group(0) @binding(1) var bilinear: sampler;

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let size = vec2f(max(textureDimensions(larger) / 2u, vec2u(1u)));
    return textureSampleLevel(larger, bilinear, position.xy / size, 0.0);
}
