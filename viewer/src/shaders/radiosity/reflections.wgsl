// What glossy surfaces reflect of the light that arrives at their points, and of the environment where it is seen; as
// `GlossyField::reflected` of shared/src/gloss.rs.

// Bits of `flags`: the G-buffer holds what textures say; metals reflect their base colour at every angle, and nothing else
// shines; matrices hold light that did not bounce.
const DETAILED = 1u;
const CONDUCTORS = 2u;
const HAS_DIRECT = 4u;

struct Reflecting {
    // By sky: factor of the texture, RGB, and rotation in radians.
    sky: array<vec4f, 4>,
    // Coefficients of the sky's radiance, RGB.
    smooth_sky: array<vec4f, HARMONICS>,
    skies: u32,
    flags: u32,
    // Roughness from which metals, and what is not metal, reflect nothing.
    metals: f32,
    others: f32,
    // Cube maps, which metals reflect; texels along an edge, and factor of radiance in them.
    maps: u32,
    map_side: f32,
    map_unit: f32,
    // Roughness under which metals reflect by the transfer.
    map_roughness: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> slot_layout: Slots;
@group(0) @binding(2) var albedo_texture: texture_2d<f32>;
@group(0) @binding(3) var surface_texture: texture_2d<u32>;
@group(0) @binding(4) var depth_texture: texture_depth_2d;
@group(0) @binding(5) var<storage, read> rows: array<u32>;
@group(0) @binding(6) var<storage, read> slots: array<u32>;
@group(0) @binding(7) var<storage, read> places: array<u32>;
@group(0) @binding(8) var<storage, read> arriving: array<vec4f>;
@group(0) @binding(9) var<storage, read> looks: array<MaterialRecord>;
@group(0) @binding(10) var<uniform> reflecting: Reflecting;
// The environments without their suns, with levels that are blurred (shared/src/environment/mips.rs).
@group(0) @binding(11) var sky_texture: texture_2d<f32>;
@group(0) @binding(12) var sky_sampler: sampler;

const NOWHERE = 0xffffffffu;
const PI = 3.14159265;

// A unit tangent (Duff et al. 2017).
fn tangent(normal: vec3f) -> vec3f {
    let sign = select(-1.0, 1.0, normal.z >= 0.0);
    let a = -1.0 / (sign + normal.z);
    return vec3f(1.0 + sign * normal.x * normal.x * a, sign * normal.x * normal.y * a, -sign * normal.x);
}

// What arrives at a pixel by the transfer: coefficients, and the sum of the weights.
struct Arrives {
    sums: array<vec4f, HARMONICS>,
    total: f32,
}

fn arrives_at(pixel: vec2u) -> Arrives {
    // The row of the pixel, or of one beside it.
    var slot = slots[pixel.y * u32(frame.width) + pixel.x];
    if slot == 0u {
        let blocks = slots_blocks(frame);
        slot = (pixel.y / 2u) * blocks.x + pixel.x / 2u;
    }
    var out: Arrives;
    for (var k = 0u; k < slot_layout.row_length; k++) {
        let entry = rows[k * slot_layout.capacity + slot];
        if entry == 0u {
            break;
        }
        let place = places[entry & POINT_MASK];
        if place != NOWHERE {
            let weight = slots_weight(entry);
            out.total += weight;
            for (var i = 0u; i < HARMONICS; i++) {
                out.sums[i] += weight * arriving[place * HARMONICS + i];
            }
        }
    }
    return out;
}

// Radiance from a direction by the transfer; `sky` is that of the environment.
fn arriving_light(arrives: ptr<function, Arrives>, way: vec3f, sky: vec3f) -> vec3f {
    let y = harmonics(way);
    var low = vec4f(0.0);
    var smooth_sky = vec3f(0.0);
    for (var j = 0u; j < HARMONICS; j++) {
        low += y[j] * (*arrives).sums[j];
        smooth_sky += y[j] * reflecting.smooth_sky[j].rgb;
    }
    low /= (*arrives).total;
    let detail = sky - select(vec3f(0.0), smooth_sky, (reflecting.flags & HAS_DIRECT) != 0u);
    return max(low.rgb + saturate(low.w) * detail, vec3f(0.0));
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let pixel = vec2u(position.xy);
    let depth = textureLoad(depth_texture, pixel, 0);
    if depth <= 0.0 {
        return vec4f(0.0);
    }
    let texel = textureLoad(surface_texture, pixel, 0);
    let material = looks[min(texel.y >> 16u, arrayLength(&looks) - 1u)];
    let surface = surface_unpack(texel, material, (reflecting.flags & DETAILED) != 0u);
    let is_metal = surface.look.metallic > 0.5;
    let conductors = (reflecting.flags & CONDUCTORS) != 0u;
    let limit = select(reflecting.others, reflecting.metals, is_metal);
    let shines = is_metal || (surface.look.specular > 0.0 && !conductors);
    if material.unlit > 0.0 || !shines || surface.look.roughness >= limit {
        return vec4f(0.0);
    }
    let by_maps = is_metal && reflecting.maps > 0u && surface.look.roughness >= reflecting.map_roughness;
    var arrives: Arrives;
    if !by_maps {
        arrives = arrives_at(pixel);
        if arrives.total <= 0.0 {
            return vec4f(0.0);
        }
    }
    let position_seen = position_at(frame, vec2f(pixel) + 0.5, depth);
    let to_eye = normalize(frame.eye - position_seen);
    var lobe_map: MapLobe;
    if by_maps {
        lobe_map = map_lobe(position_seen, surface.facet, reflect(-to_eye, surface.bent));
    }
    // A frame that the eye lies in: samples turn evenly over a round surface, without a seam.
    let upright = dot(to_eye, surface.bent);
    let across = to_eye - upright * surface.bent;
    let wide = length(across);
    let first = select(tangent(surface.bent), across / max(wide, 1e-20), wide > 1e-6);
    let world_from_surface = mat3x3f(first, cross(surface.bent, first), surface.bent);
    let in_frame = normalize(vec3f(wide, 0.0, max(upright, 1e-3)));
    let alpha = max(surface.look.roughness * surface.look.roughness, LEAST_ALPHA);
    // Radiance, the same by Schlick's (1 - v·h)^5, and the shares of an even light.
    var radiance = vec3f(0.0);
    var grazing = vec3f(0.0);
    var shares = vec2f(0.0);
    for (var i = 0u; i < LOBE_SAMPLES; i++) {
        let sample = lobe_sample(alpha, in_frame, i);
        if sample.weight <= 0.0 {
            continue;
        }
        let way = world_from_surface * sample.to_light;
        let solid_angle = 1.0 / (f32(LOBE_SAMPLES) * sample.density);
        let sky = reflected_sky(way, solid_angle);
        var light = vec3f(0.0);
        if by_maps {
            // As path tracers have it: nothing arrives from within.
            light = select(map_light(lobe_map, way, solid_angle, sky), vec3f(0.0), dot(surface.facet, way) <= 0.0);
        } else {
            light = arriving_light(&arrives, way, sky);
        }
        let glancing = pow(max(1.0 - sample.cosine, 0.0), 5.0);
        radiance += sample.weight * light;
        grazing += sample.weight * glancing * light;
        shares += sample.weight * vec2f(1.0, glancing);
    }
    let share = 1.0 / f32(LOBE_SAMPLES);
    let albedo = textureLoad(albedo_texture, pixel, 0).rgb;
    var head_on = mix(surface.look.head_on, albedo, surface.look.metallic);
    var edge = vec3f(mix(surface.look.specular, 1.0, surface.look.metallic));
    var below = 1.0 - surface.look.metallic;
    if conductors {
        head_on = albedo;
        edge = albedo;
        below = 0.0;
    }
    let again = 1.0 + head_on * (1.0 / max(share * shares.x, 1e-3) - 1.0);
    let taken = again * share * (head_on * (shares.x - shares.y) + edge * shares.y);
    let left = below * saturate(1.0 - max(taken.r, max(taken.g, taken.b)));
    return vec4f(again * share * (head_on * (radiance - grazing) + edge * grazing), 1.0 + left);
}
