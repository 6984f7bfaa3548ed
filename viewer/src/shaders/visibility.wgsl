// Visibility of lights from the shadow maps, of those with a size through penumbra.wgsl. Group LIGHTS holds lights and shadow maps.

@group(LIGHTS) @binding(0) var<storage, read> lights: array<Light>;
@group(LIGHTS) @binding(1) var<storage, read> shadow_matrices: array<mat4x4f>;
@group(LIGHTS) @binding(2) var shadow_maps: texture_depth_2d_array;
@group(LIGHTS) @binding(3) var shadow_sampler: sampler_comparison;
@group(LIGHTS) @binding(4) var depth_sampler: sampler;
// Colour behind glass, and the depth of the nearest (tint.wgsl); one texel wide where there is none.
@group(LIGHTS) @binding(5) var tint_maps: texture_2d_array<f32>;
@group(LIGHTS) @binding(6) var tint_sampler: sampler;
// The cascades of directional lights, which follow the camera (cascades.rs).
@group(LIGHTS) @binding(7) var near_maps: texture_depth_2d_array;

// How far off a packed flat normal (gbuffer.wgsl: 8 bits an axis) may be, times the texels that the filter reaches.
const LOOSE = 0.016;
// The share of what a wall at a right angle rises by that is let be: all of it would let light creep under thin walls.
const RISE = 0.6;
// Share of a cascade that counts: what lies beyond is too near to its edge for the filter.
const CASCADE = 0.98;
// As in cascades.rs.
const CASCADES = 3u;
// Steepest surface, depth over width.
const MOST_SLOPE = 32.0;

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

// The first of `count` cascades from `first` on that shows `position`, or what follows them.
fn cascade(first: u32, count: u32, position: vec3f) -> u32 {
    for (var i = first; i < first + count; i++) {
        let clip = shadow_matrices[i] * vec4f(position, 1.0);
        if max(abs(clip.x), abs(clip.y)) < CASCADE {
            return i;
        }
    }
    return first + count;
}

// The layer of the shadow maps that shows `position`, whatever the camera sees.
fn shadow_layer(light: Light, position: vec3f) -> u32 {
    if light.layers < 2u {
        return light.layer;
    }
    if light.kind == DIRECTIONAL {
        // The detail's, and where that ends, the scene's.
        return cascade(light.layer, 1u, position);
    }
    return light.layer + cube_face(position - light.position);
}

// Width of a texel of a view on a map of this size; at distance 1 but for a directional light.
fn shadow_texel(light: Light, clip_from_local: mat4x4f, size: f32) -> f32 {
    let across = vec3f(clip_from_local[0].x, clip_from_local[1].x, clip_from_local[2].x);
    return select(light.texel, 2.0 / (size * length(across)), light.kind == DIRECTIONAL);
}

// Share of the light that reaches `position`, which lies `lift` above a surface with the unit normal `normal`: one
// bilinear tap.
fn visibility(light: Light, position: vec3f, normal: vec3f, to_light: vec3f, lift: f32) -> f32 {
    let layer = shadow_layer(light, position);
    let clip_from_local = shadow_matrices[layer];
    // A tap that reaches k texels to the side sees a tilted surface k·tan(angle) texels nearer to
    // the light; to move along the normal by k·sin(angle) texels makes up for exactly that.
    let cosine = dot(normal, to_light);
    let side = select(-1.0, 1.0, cosine >= 0.0);
    let sine = sqrt(saturate(1.0 - cosine * cosine));
    let size = f32(textureDimensions(shadow_maps).x);
    let texel = shadow_texel(light, clip_from_local, size) * (clip_from_local * vec4f(position, 1.0)).w;
    let clip = clip_from_local * vec4f(position + normal * (side * max(texel * (1.42 * sine + 0.1) - lift, 0.0)), 1.0);
    let bias = 0.5 * texel;
    var depth = clip.z / max(clip.w - bias, 1e-20);
    if light.kind == DIRECTIONAL {
        depth = clip.z + bias * light.depth_scale;
    }
    let uv = vec2f(0.5, -0.5) * clip.xy / clip.w + 0.5;
    return textureSampleCompareLevel(shadow_maps, shadow_sampler, uv, layer, depth);
}

// Texels across the cascades' maps where `near`, else across those of all views.
fn map_size(near: bool) -> vec2u {
    return select(textureDimensions(shadow_maps), textureDimensions(near_maps), near);
}

// Depths of the four texels around a place of a layer.
fn map_depths(near: bool, uv: vec2f, layer: u32) -> vec4f {
    if near {
        return textureGather(near_maps, depth_sampler, uv, layer);
    }
    return textureGather(shadow_maps, depth_sampler, uv, layer);
}

// A position on a shadow map: texels, depth, distance (1 for a directional light).
fn on_map(clip_from_local: mat4x4f, size: f32, position: vec3f) -> vec4f {
    let clip = clip_from_local * vec4f(position, 1.0);
    return vec4f((vec2f(0.5, -0.5) * clip.xy / clip.w + 0.5) * size, clip.z / clip.w, clip.w);
}

// Share of the light that reaches `position` on a surface with the unit normal `normal`: the mean of 3 x 3 bilinear
// taps, as the 4 x 4 texels under them.
//
// Each texel is held against the surface's plane where that texel is, not where the position is: depth is linear over a
// map, so a surface never shadows itself, however flat the light falls, and needs no offset at which light could
// creep under what stands on it. A surface that rises from the edge of this one is before its plane, too, and stops
// nothing: a wall that stands on it at a right angle rises, per texel, by its slope and this one's; what rises from here by no more than
// most of that is let be. A texel far behind the plane looks past the surface's end, and says nothing about it: the line
// where a floor meets a wall that has no thickness stays dark though light passes just behind. Of a blended surface only a share of the
// texels hold it; it is not `solid`, and light that passes it tells as much. `taps`: those of a penumbra (penumbra.wgsl).
fn soft_visibility(light: Light, position: vec3f, normal: vec3f, to_light: vec3f, solid: bool, taps: vec2u) -> f32 {
    var layer = shadow_layer(light, position);
    var clip_from_local = shadow_matrices[layer];
    var near = false;
    if light.kind == DIRECTIONAL {
        let first = u32(light.position.x);
        let shown = cascade(first, CASCADES, position);
        near = shown < first + CASCADES;
        if near {
            layer = shown - u32(light.position.y);
            clip_from_local = shadow_matrices[shown];
        }
    }
    let size = f32(map_size(near).x);
    let place = on_map(clip_from_local, size, position);
    let texel = shadow_texel(light, clip_from_local, size);
    let width = texel * place.w;
    let aside = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(normal.x) > 0.5);
    let tangent = normalize(cross(normal, aside)) * (4.0 * width);
    let a = on_map(clip_from_local, size, position + tangent) - place;
    let b = on_map(clip_from_local, size, position + cross(normal, tangent)) - place;
    // As much depth as a texel is wide.
    let unit = texel * select(place.z, light.depth_scale, light.kind == DIRECTIONAL);
    let area = a.x * b.y - a.y * b.x;
    let tilt = vec2f(a.z * b.y - b.z * a.y, b.z * a.x - a.z * b.x) / select(area, 1e30, abs(area) < 1e-3);
    let slope = clamp(tilt, vec2f(-MOST_SLOPE * unit), vec2f(MOST_SLOPE * unit));
    let cosine = dot(normal, to_light);
    let bias = unit * (0.35 + LOOSE / max(cosine * cosine, 1e-3));
    if light.size > 0.0 {
        let rim = unit * place.w / light.size;
        let reach = size * select(REACH, AREA_REACH, is_area(light));
        let outline = light_outline(light, clip_from_local, (place.xy / size - 0.5) * vec2f(2.0, -2.0));
        var map = MapPlace(place.xyz, slope, bias, unit * LOOSE / max(cosine * cosine, 1e-3), outline, rim, reach, layer, near);
        if abs(area) < 1e-3 || any(slope != tilt) {
            // Seen edge-on, the surface has no plane on the map: what is well before it counts.
            map = MapPlace(place.xyz, vec2f(0.0), bias, 2.0 * MOST_SLOPE * unit, outline, rim, reach, layer, near);
        }
        let part = penumbra(map, taps);
        if part >= 0.0 {
            return part;
        }
    }
    let behind = select(1e30, 4.0 * bias, solid);
    let steep = length(slope) / unit;
    let rise = RISE * unit * (steep + min(1.0 / max(steep, 1e-3), 3.0));
    let at = place.xy - 0.5;
    let first = floor(at);
    let share = at - first;
    let low = vec4f(1.0 - share.x, 1.0, 1.0, share.x);
    let high = vec4f(1.0 - share.y, 1.0, 1.0, share.y);
    var known = 0.0;
    // In front of the plane, and by more than what rises from an edge.
    var before = 0.0;
    var stopped = 0.0;
    for (var y = 0; y < 2; y++) {
        for (var x = 0; x < 2; x++) {
            let corner = first + 2.0 * vec2f(f32(x), f32(y));
            // Texels in the order (0, 1), (1, 1), (1, 0), (0, 0).
            let found = map_depths(near, corner / size, layer);
            let off = corner - 0.5 - place.xy;
            let right = off.x + vec4f(0.0, 1.0, 1.0, 0.0);
            let down = off.y + vec4f(1.0, 1.0, 0.0, 0.0);
            let plane = place.z + slope.x * right + slope.y * down;
            let raised = plane + bias + rise * sqrt(right * right + down * down);
            let across = select(low.xy, low.zw, x == 1);
            let along = select(high.xy, high.zw, y == 1);
            let weight = vec4f(across.x, across.y, across.y, across.x) * along.yyxx;
            known += dot(weight, step(plane - behind, found));
            before += dot(weight, step(plane + bias, found));
            stopped += dot(weight, step(raised, found));
        }
    }
    // Where the surface ends there is no edge that others rise from, and texels that say nothing make those that stop the
    // light count more.
    let all = mix(stopped, before, saturate(0.5 * (9.0 - known)));
    return saturate(1.0 - 9.0 * all / max(known * known, 1e-6));
}

// Share of the light, RGB, that glass in front of `position` lets through.
fn tinted(light: Light, position: vec3f) -> vec3f {
    if textureDimensions(tint_maps).x < 2u {
        return vec3f(1.0);
    }
    let layer = shadow_layer(light, position);
    let clip = shadow_matrices[layer] * vec4f(position, 1.0);
    let tint = textureSampleLevel(tint_maps, tint_sampler, vec2f(0.5, -0.5) * clip.xy / clip.w + 0.5, layer, 0.0);
    // 16-bit floats round by a 2000th: what is nearer to the glass is not behind it.
    let depth = clip.z / clip.w;
    return select(vec3f(1.0), tint.rgb, tint.a > depth + 0.0015 * select(depth, 1.0, light.kind == DIRECTIONAL));
}

// The light of an area light that arrives at a point of a surface, were nothing in between.
fn area_light(light: Light, position: vec3f, normal: vec3f) -> Incident {
    let solid = projected_solid_angle(light, position, normal);
    return Incident(normalize(light.position - position), light.intensity * solid, solid);
}

// The light of an area light that arrives at a place.
fn lit_by_area(light: Light, position: vec3f, normal: vec3f) -> vec3f {
    let at = area_light(light, position, normal);
    if all(at.irradiance <= vec3f(0.0)) {
        return vec3f(0.0);
    }
    let seen = soft_visibility(light, position, normal, at.to_light, true, FEW);
    return at.irradiance * seen * tinted(light, position);
}

// The light of one without a surface that arrives at a place which lies `lift` above a surface.
fn lit(light: Light, position: vec3f, normal: vec3f, lift: f32) -> vec3f {
    let at = incident(light, position);
    let irradiance = at.irradiance * max(dot(normal, at.to_light), 0.0);
    if all(irradiance <= vec3f(0.0)) {
        return vec3f(0.0);
    }
    return irradiance * visibility(light, position, normal, at.to_light, lift) * tinted(light, position);
}

// The light that arrives at a surface in a picture, with soft edges, of a light with its size; `flat_normal` is the
// normal of the triangle.
fn lit_softly(light: Light, position: vec3f, normal: vec3f, flat_normal: vec3f, solid: bool) -> Incident {
    var at: Incident;
    if is_area(light) {
        at = area_light(light, position, normal);
    } else {
        at = incident(light, position);
        at.irradiance *= above_horizon(light, position, dot(normal, at.to_light));
    }
    if any(at.irradiance > vec3f(0.0)) {
        at.irradiance *= soft_visibility(light, position, flat_normal, at.to_light, solid, MANY) * tinted(light, position);
    }
    return at;
}
