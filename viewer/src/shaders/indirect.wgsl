// The bounced light alone, linear, averaged over `scale` x `scale` pixels, for comparison with the CPU.

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let first = vec2u(position.xy) * shading.scale;
    var sum = vec4f(0.0);
    for (var y = 0u; y < shading.scale; y++) {
        for (var x = 0u; x < shading.scale; x++) {
            sum += radiance(first + vec2u(x, y));
        }
    }
    return sum / f32(shading.scale * shading.scale);
}
