// Visibility of lights from the shadow maps. Group 1 holds lights and shadow maps.

@group(1) @binding(0) var<storage, read> lights: array<Light>;
@group(1) @binding(1) var<storage, read> shadow_matrices: array<mat4x4f>;
@group(1) @binding(2) var shadow_maps: texture_depth_2d_array;
@group(1) @binding(3) var shadow_sampler: sampler_comparison;

// The cube's face towards v: +x -x +y -y +z -z.
fn cube_face(v: vec3f) -> u32 {
    let a = abs(v);
    if a.x >= a.y && a.x >= a.z {
        return select(1u, 0u, v.x > 0.0);
    }
    if a.y >= a.z {
        return select(3u, 2u, v.y > 0.0);
    }
    return select(5u, 4u, v.z > 0.0);
}

// Share of the light that reaches `position` on a surface with the unit normal `normal`, over a
// square of (2 radius + 1) taps; each tap is bilinear. `lift`: how far above the surface the position
// lies already.
fn visibility(light: Light, position: vec3f, normal: vec3f, to_light: vec3f, radius: i32, lift: f32) -> f32 {
    var layer = light.layer;
    if light.layers > 1u {
        layer += cube_face(position - light.position);
    }
    let clip_from_local = shadow_matrices[layer];
    // A filter that reaches k texels to the side sees a tilted surface k·tan(angle) texels nearer to
    // the light; to move along the normal by k·sin(angle) texels makes up for exactly that.
    let cosine = dot(normal, to_light);
    let side = select(-1.0, 1.0, cosine >= 0.0);
    let sine = sqrt(saturate(1.0 - cosine * cosine));
    let w = (clip_from_local * vec4f(position, 1.0)).w;
    let texel = light.texel * w;
    let reach = 1.42 * (f32(radius) + 1.0);
    let moved = position + normal * (side * max(texel * (reach * sine + 0.1) - lift, 0.0));
    let clip = clip_from_local * vec4f(moved, 1.0);
    let bias = 0.5 * texel;
    var depth = clip.z / max(clip.w - bias, 1e-20);
    if light.kind == DIRECTIONAL {
        depth = clip.z + bias * light.depth_scale;
    }
    let uv = vec2f(0.5, -0.5) * clip.xy / clip.w + 0.5;
    let step = 1.0 / f32(textureDimensions(shadow_maps).x);
    var sum = 0.0;
    for (var y = -radius; y <= radius; y++) {
        for (var x = -radius; x <= radius; x++) {
            sum += textureSampleCompareLevel(
                shadow_maps, shadow_sampler, uv + vec2f(f32(x), f32(y)) * step, layer, depth);
        }
    }
    let side_taps = f32(2 * radius + 1);
    return sum / (side_taps * side_taps);
}

// Direct irradiance at a point of a surface. `normal` is the shading normal, `flat_normal` that of
// the triangle; radius and lift as above.
fn direct_irradiance(position: vec3f, normal: vec3f, flat_normal: vec3f, count: u32, radius: i32, lift: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < count; i++) {
        let light = lights[i];
        let at = incident(light, position);
        let cosine = dot(normal, at.to_light);
        if cosine > 0.0 && any(at.irradiance > vec3f(0.0)) {
            sum += at.irradiance * (cosine * visibility(light, position, flat_normal, at.to_light, radius, lift));
        }
    }
    return sum;
}
