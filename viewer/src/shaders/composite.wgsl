// The tone-mapped picture, linear display values, averaged over a series of pictures by blending; curves as in
// shared/src/tone.rs.

// The automatic exposure: what radiance is multiplied with.
@group(0) @binding(7) var<storage, read> key: array<f32>;

// AgX (Troy Sobotka), in the form of Benjamin Wrensch: linear display values.
fn agx(linear: vec3f) -> vec3f {
    let inset = mat3x3f(
        vec3f(0.84247906, 0.042328242, 0.042375655),
        vec3f(0.0784336, 0.87846864, 0.0784336),
        vec3f(0.079223745, 0.07916613, 0.87914297),
    );
    let outset = mat3x3f(
        vec3f(1.196879, -0.052896852, -0.052971635),
        vec3f(-0.09802088, 1.1519031, -0.09804345),
        vec3f(-0.09902974, -0.09896118, 1.1510737),
    );
    let stops = log2(max(inset * linear, vec3f(1e-10)));
    let x = saturate((stops + 12.47393) / 16.5);
    let curve = (((((15.5 * x - 40.14) * x + 31.96) * x - 6.868) * x + 0.4298) * x + 0.1191) * x - 0.00232;
    return pow(saturate(outset * curve), vec3f(2.2));
}

// Khronos PBR Neutral.
fn neutral(linear: vec3f) -> vec3f {
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
    let automatic = select(key[0], 1.0, (shading.flags & MANUAL) != 0u);
    let light = radiance(vec2u(position.xy)).rgb * (automatic * shading.exposure);
    var shown = neutral(light);
    if (shading.flags & AGX) != 0u {
        shown = agx(light);
    }
    if (shading.flags & (UNLIT | BACKDROP)) != 0u {
        shown += besides(vec2u(position.xy));
    }
    return vec4f(shown, shading.blend);
}
