// The bounced light alone, linear, averaged over `scale` x `scale` pixels and with the pictures before, for
// comparison with the CPU.

@group(2) @binding(0) var before: texture_2d<f32>;

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let first = pixel * shading.scale;
    var sum = vec4f(0.0);
    for (var y = 0u; y < shading.scale; y++) {
        for (var x = 0u; x < shading.scale; x++) {
            sum += radiance(first + vec2u(x, y));
        }
    }
    return mix(textureLoad(before, pixel, 0), sum / f32(shading.scale * shading.scale), shading.blend);
}
