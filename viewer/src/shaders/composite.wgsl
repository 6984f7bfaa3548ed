// The tone-mapped picture, linear display values, averaged over a series of pictures by blending.

// The automatic exposure: what radiance is multiplied with.
@group(0) @binding(7) var<storage, read> key: array<f32>;

// AgX (Troy Sobotka), in the form of Benjamin Wrensch: linear display values.
fn agx(linear: vec3f) -> vec3f {
    let inset = mat3x3f(
        vec3f(0.842479062253094, 0.0423282422610123, 0.0423756549057051),
        vec3f(0.0784335999999992, 0.878468636469772, 0.0784336),
        vec3f(0.0792237451477643, 0.0791661274605434, 0.879142973793104),
    );
    let outset = mat3x3f(
        vec3f(1.19687900512017, -0.0528968517574562, -0.0529716355144438),
        vec3f(-0.0980208811401368, 1.15190312990417, -0.0980434501171241),
        vec3f(-0.0990297440797205, -0.0989611768448433, 1.15107367264116),
    );
    let stops = log2(max(inset * linear, vec3f(1e-10)));
    let x = saturate((stops + 12.47393) / (12.47393 + 4.026069));
    let x2 = x * x;
    let x4 = x2 * x2;
    let curve = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
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
