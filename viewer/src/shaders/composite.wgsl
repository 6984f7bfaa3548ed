// The tone-mapped picture, linear display values, averaged over a series of pictures by blending.

// The automatic exposure: what radiance is multiplied with.
@group(0) @binding(7) var<storage, read> key: array<f32>;

// Khronos PBR Neutral.
fn tone_map(linear: vec3f) -> vec3f {
    let start = 0.8 - 0.04;
    let desaturation = 0.15;
    let x = min(linear.r, min(linear.g, linear.b));
    let offset = select(0.04, x - 6.25 * x * x, x < 0.08);
    let color = linear - offset;
    let peak = max(color.r, max(color.g, color.b));
    if peak < start {
        return color;
    }
    let d = 1.0 - start;
    let new_peak = 1.0 - d * d / (peak + d - start);
    let g = 1.0 - 1.0 / (desaturation * (peak - new_peak) + 1.0);
    return mix(color * (new_peak / peak), vec3f(new_peak), g);
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let light = radiance(vec2u(position.xy));
    return vec4f(tone_map(light.rgb * (key[0] * shading.exposure)), shading.blend);
}
