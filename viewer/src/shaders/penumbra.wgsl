// Penumbrae of lights with a size: percentage-closer soft shadows (Fernando 2005). What hides a light is looked for around
// a place of its map; how far away it is says how wide the penumbra is.

// Texels that are looked at for what hides a light, and for how much of it that does: at pixels and at points.
const MANY = vec2u(32u, 40u);
const FEW = vec2u(8u, 12u);
// Farthest of them from the place, as a share of the map's width; of area lights, which are larger.
const REACH = 0.0625;
const AREA_REACH = 0.25;
// Narrower penumbrae are no wider than the filter of a point's shadow.
const NARROW = 1.5;

// A place of a shadow map, and the surface there.
struct MapPlace {
    // Texels, depth.
    at: vec3f,
    // Change of the surface's depth, per texel.
    slope: vec2f,
    // What is nearer to the light than the surface by less is the surface.
    bias: f32,
    // How far off the surface may be, per texel.
    loose: f32,
    // The light's outline as seen from the place, for places of the unit disc.
    outline: mat2x2f,
    // Change of depth per texel along the rim of the cone from the place to the light.
    rim: f32,
    // Texels from the place to the farthest tap.
    reach: f32,
    layer: u32,
    // Whether the map is that of a cascade.
    near: bool,
}

// The outline of a light on a map, for places of the unit disc: a flat light is seen at an angle, and what is beside it hides
// nothing of it. `at`: clip space.
fn light_outline(light: Light, clip_from_local: mat4x4f, at: vec2f) -> mat2x2f {
    if !is_area(light) || light.kind == SPHERE {
        return mat2x2f(1.0, 0.0, 0.0, 1.0);
    }
    let rows = transpose(clip_from_local);
    let side = light.extent / sqrt(light.extent.x * light.extent.y);
    let right = side.x * cross(light.up, light.direction);
    let up = side.y * light.up;
    let x = rows[0].xyz - at.x * rows[3].xyz;
    let y = at.y * rows[3].xyz - rows[1].xyz;
    return mat2x2f(dot(x, right), dot(y, right), dot(x, up), dot(y, up)) * (1.0 / length(rows[0].xyz));
}

// The i-th of `count` places on a spiral over the unit disc; `power` 0.5 fills it evenly.
fn on_disc(i: u32, count: u32, power: f32) -> vec2f {
    let angle = 2.39996323 * f32(i);
    return pow((f32(i) + 0.5) / f32(count), power) * vec2f(cos(angle), sin(angle));
}

// The least depth, beside the place, of what is in front of the surface under all of the four texels that a tap reads.
fn in_front(map: MapPlace, off: vec2f) -> f32 {
    let surface = dot(map.slope, off) + dot(abs(map.slope), vec2f(1.0));
    return map.at.z + surface + map.bias + map.loose * (1.0 + length(off));
}

// The cosine of a light's middle above a surface, or for a light that the surface's horizon cuts, what the part above it
// gives.
fn above_horizon(light: Light, position: vec3f, cosine: f32) -> f32 {
    var sine = light.size;
    if light.kind != DIRECTIONAL {
        sine = min(sine / length(light.position - position), 1.0);
    }
    if abs(cosine) < sine {
        return (cosine + sine) * (cosine + sine) / (4.0 * sine);
    }
    return max(cosine, 0.0);
}

// 1 on the map, 0 beside it, where nothing is known.
fn on_map_share(uv: vec2f) -> f32 {
    return select(0.0, 1.0, all(uv == saturate(uv)));
}

// Share of a light with a size that is seen from a place; -1 where its shadows are as sharp as a point's.
fn penumbra(map: MapPlace, taps: vec2u) -> f32 {
    let size = vec2f(map_size(map.near));
    // The harmonic mean of the widths that each would make: what is near the surface hides most of the light, however much
    // of the map what is far away fills.
    var sum = vec2f(0.0);
    for (var i = 0u; i < taps.x; i++) {
        // More of them near the place, or narrow penumbrae were not found.
        let on_light = on_disc(i, taps.x, 1.5) * map.reach;
        let off = map.outline * on_light;
        let uv = (map.at.xy + off) / size;
        let found = map_depths(map.near, uv, map.layer);
        // In front, and within the cone to the light.
        let least = max(in_front(map, off), map.at.z + map.rim * length(on_light));
        let hiding = step(vec4f(least), found) * on_map_share(uv);
        let narrow = map.rim / max(found - map.at.z, vec4f(1e-12));
        sum += vec2f(dot(hiding, vec4f(1.0)), dot(hiding, narrow));
    }
    if sum.x < 0.5 {
        return -1.0;
    }
    let wide = min(sum.x / sum.y, map.reach);
    if wide < NARROW {
        return -1.0;
    }
    var seen = vec2f(0.0);
    for (var i = 0u; i < taps.y; i++) {
        let off = map.outline * on_disc(i, taps.y, 0.5) * wide;
        let uv = (map.at.xy + off) / size;
        var share = 0.0;
        if map.near {
            share = textureSampleCompareLevel(near_maps, shadow_sampler, uv, map.layer, in_front(map, off));
        } else {
            share = textureSampleCompareLevel(shadow_maps, shadow_sampler, uv, map.layer, in_front(map, off));
        }
        seen += vec2f(share, 1.0) * on_map_share(uv);
    }
    return seen.x / max(seen.y, 1.0);
}
