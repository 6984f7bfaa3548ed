// Radiance of a pixel: of the surface in the G-buffer, and of the blended ones in front of it.

@group(0) @binding(2) var albedo_texture: texture_2d<f32>;
@group(0) @binding(3) var surface_texture: texture_2d<u32>;
@group(0) @binding(4) var depth_texture: texture_depth_2d;
// Bounced irradiance by slot.
@group(0) @binding(5) var<storage, read> light: array<vec4f>;
// By material.
@group(0) @binding(6) var<storage, read> looks: array<MaterialRecord>;
// The slot of every pixel that has one of its own, else 0.
@group(0) @binding(8) var<storage, read> slots: array<u32>;
// What blended surfaces send, times `shading.unit`, and the share that they cover; any texture where there are none.
@group(0) @binding(9) var veil_texture: texture_2d<f32>;
// Where these have colours, the share of light that goes through them, and what they show whatever the light.
@group(0) @binding(10) var through_texture: texture_2d<f32>;
@group(0) @binding(11) var shine_texture: texture_2d<f32>;

// Radiance of the nearest area light in front of a place at this depth, black from behind; alpha: 1 where there is one.
fn area_in_front(pixel: vec2u, depth: f32) -> vec4f {
    let way = position_at(frame, vec2f(pixel) + 0.5, frame.near) - frame.eye;
    let ray = normalize(way);
    var nearest = select(1e30, frame.near / depth * length(way), depth > 0.0);
    var seen = vec4f(0.0);
    for (var i = 0u; i < shading.lights; i++) {
        if !is_area(lights[i]) {
            continue;
        }
        let distance = area_distance(lights[i], frame.eye, ray);
        // One that lies on a surface is before it.
        if distance > 0.0 && distance < nearest * 1.0001 {
            let is_front = lights[i].kind == SPHERE || dot(ray, lights[i].direction) < 0.0;
            nearest = distance;
            seen = vec4f(lights[i].intensity * select(0.0, shading.direct, is_front), 1.0);
        }
    }
    return seen;
}

// rgb: radiance; alpha: 1 where there is a surface or a sky. Without surfaces that are blended.
fn opaque_radiance(pixel: vec2u) -> vec4f {
    let depth = textureLoad(depth_texture, pixel, 0);
    let light_in_front = area_in_front(pixel, depth);
    if light_in_front.a > 0.0 {
        return light_in_front;
    }
    if depth <= 0.0 {
        return sky(pixel);
    }
    let albedo = textureLoad(albedo_texture, pixel, 0);
    let texel = textureLoad(surface_texture, pixel, 0);
    let material = looks[min(texel.y >> 16u, arrayLength(&looks) - 1u)];
    if material.unlit > 0.0 {
        return vec4f(0.0);
    }
    let surface = surface_unpack(texel, material, (shading.flags & DETAILED) != 0u);
    var bounced = mat2x3f();
    if shading.indirect > 0.0 {
        bounced = shown_bounced(pixel, (shading.flags & DETAILED) != 0u);
    }
    let position = position_at(frame, vec2f(pixel) + 0.5, depth);
    return vec4f(shaded(surface, albedo.rgb, position, bounced, pixel), 1.0);
}

fn depth_at(pixel: vec2i, x: i32, y: i32) -> f32 {
    let last = vec2i(textureDimensions(depth_texture)) - 1;
    return textureLoad(depth_texture, clamp(pixel + vec2i(x, y), vec2i(0), last), 0);
}

fn normal_at(pixel: vec2i) -> vec3f {
    return unpack_normal(textureLoad(surface_texture, max(pixel, vec2i(0)), 0).x);
}

// The pixel, or the one left of it where it lies in a crack: where triangles meet at a T-junction, the rasterizer may
// leave single pixels open. Reversed depth is linear over a plane in the picture; a pixel behind the plane of its
// four neighbours, or of a face that meets the plane there, is in a crack.
fn mended(pixel: vec2u) -> vec2u {
    let at = vec2i(pixel);
    let across = depth_at(at, -1, 0) + depth_at(at, 1, 0);
    let along = depth_at(at, 0, -1) + depth_at(at, 0, 1);
    if abs(across - along) >= 1e-4 * across {
        return pixel;
    }
    let left = normal_at(at - vec2i(1, 0));
    let other = dot(left, normal_at(at)) < 0.9 && dot(left, normal_at(at + vec2i(1, 0))) > 0.98;
    return pixel - vec2u(select(0u, 1u, other || depth_at(at, 0, 0) < 0.4995 * across), 0u);
}

// rgb: radiance; alpha: the share that surfaces and a sky cover.
fn radiance(place: vec2u) -> vec4f {
    let pixel = mended(place);
    let behind = opaque_radiance(pixel);
    if (shading.flags & VEILED) == 0u {
        return behind;
    }
    let veil = textureLoad(veil_texture, pixel, 0);
    var out = behind * (1.0 - veil.a) + vec4f(veil.rgb / shading.unit, veil.a);
    if (shading.flags & TINTED) != 0u {
        out = vec4f(behind.rgb * textureLoad(through_texture, pixel, 0).rgb + veil.rgb / shading.unit, out.a);
    }
    return out;
}
