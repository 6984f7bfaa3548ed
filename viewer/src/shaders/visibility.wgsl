// Visibility of lights from the shadow maps. Group LIGHTS holds lights and shadow maps.

@group(LIGHTS) @binding(0) var<storage, read> lights: array<Light>;
@group(LIGHTS) @binding(1) var<storage, read> shadow_matrices: array<mat4x4f>;
@group(LIGHTS) @binding(2) var shadow_maps: texture_depth_2d_array;
@group(LIGHTS) @binding(3) var shadow_sampler: sampler_comparison;

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

// Share of the light that reaches `position` on a surface with the unit normal `normal`: one bilinear tap
// (radius 0) or 3 x 3 of them (radius 1). `lift`: how far above the surface the position
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
    if radius == 0 {
        return textureSampleCompareLevel(shadow_maps, shadow_sampler, uv, layer, depth);
    }
    // The mean of 3 x 3 bilinear taps, as the 4 x 4 texels under them: four gathers.
    let size = f32(textureDimensions(shadow_maps).x);
    let at = uv * size - 0.5;
    let first = floor(at);
    let share = at - first;
    let low = vec4f(1.0 - share.x, 1.0, 1.0, share.x);
    let high = vec4f(1.0 - share.y, 1.0, 1.0, share.y);
    let step = 1.0 / size;
    var sum = 0.0;
    for (var y = 0; y < 2; y++) {
        for (var x = 0; x < 2; x++) {
            let corner = (first + 2.0 * vec2f(f32(x), f32(y))) * step;
            // Texels in the order (0, 1), (1, 1), (1, 0), (0, 0).
            let lit = textureGatherCompare(shadow_maps, shadow_sampler, corner, layer, depth);
            let across = select(low.xy, low.zw, x == 1);
            let along = select(high.xy, high.zw, y == 1);
            sum += dot(lit, vec4f(across.x, across.y, across.y, across.x) * along.yyxx);
        }
    }
    return sum / 9.0;
}

// The light that arrives at a point of a surface: its direction, and the irradiance along the normal. `normal` is the
// shading normal, `flat_normal` that of the triangle; radius and lift as above.
fn lit(light: Light, position: vec3f, normal: vec3f, flat_normal: vec3f, radius: i32, lift: f32) -> Incident {
    let at = incident(light, position);
    let cosine = dot(normal, at.to_light);
    if cosine <= 0.0 || all(at.irradiance <= vec3f(0.0)) {
        return Incident(at.to_light, vec3f(0.0));
    }
    let share = cosine * visibility(light, position, flat_normal, at.to_light, radius, lift);
    return Incident(at.to_light, at.irradiance * share);
}
