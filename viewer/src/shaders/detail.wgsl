// The textures of a material that only pictures need. Called for all pixels alike: derivatives are taken.

const EMISSION = 0u;
const METALLIC_ROUGHNESS = 1u;
const NORMALS = 2u;

@group(1) @binding(5) var emission_texture: texture_2d<f32>;
@group(1) @binding(6) var emission_sampler: sampler;
@group(1) @binding(7) var metallic_roughness_texture: texture_2d<f32>;
@group(1) @binding(8) var metallic_roughness_sampler: sampler;
@group(1) @binding(9) var normal_texture: texture_2d<f32>;
@group(1) @binding(10) var normal_sampler: sampler;

struct Detail {
    // Share of the material's emission, RGB.
    emission: vec3f,
    metallic: f32,
    roughness: f32,
    // Unit normal.
    normal: vec3f,
}

fn detail_has(map: u32) -> bool {
    return ((material.details >> map) & 1u) != 0u;
}

fn detail_uv(map: u32, uv: vec2f) -> vec2f {
    let at = vec3f(uv, 1.0);
    return vec2f(dot(material.uv_from_vertex[2u * map].xyz, at), dot(material.uv_from_vertex[2u * map + 1u].xyz, at));
}

// Tangent space from the change of place and texture coordinates over the pixel (Schueler, Normal Mapping
// without Precomputed Tangents); `normal` is the shading normal on the side of the eye.
fn detail_normal(normal: vec3f, place: vec3f, uv: vec2f) -> vec3f {
    let texel = textureSample(normal_texture, normal_sampler, uv).xyz * 2.0 - 1.0;
    let across = dpdx(place);
    let down = dpdy(place);
    let uv_across = dpdx(uv);
    let uv_down = dpdy(uv);
    let a = cross(down, normal);
    let b = cross(normal, across);
    let side = select(-1.0, 1.0, dot(across, a) >= 0.0);
    let tangent = (a * uv_across.x + b * uv_down.x) * side;
    let bitangent = (a * uv_across.y + b * uv_down.y) * side;
    let longest = max(dot(tangent, tangent), dot(bitangent, bitangent));
    if longest <= 0.0 {
        return normal;
    }
    // glTF's green points up in the picture, against v.
    let bend = vec2f(texel.x, -texel.y) * (material.normal_scale * inverseSqrt(longest));
    let bent = tangent * bend.x + bitangent * bend.y + normal * max(texel.z, 1e-3);
    return normalize(bent);
}

fn detail(normal: vec3f, place: vec3f, uv: vec2f) -> Detail {
    var out = Detail(vec3f(1.0), material.metallic, material.roughness, normal);
    if detail_has(EMISSION) {
        out.emission = textureSample(emission_texture, emission_sampler, detail_uv(EMISSION, uv)).rgb;
    }
    if detail_has(METALLIC_ROUGHNESS) {
        let at = detail_uv(METALLIC_ROUGHNESS, uv);
        let texel = textureSample(metallic_roughness_texture, metallic_roughness_sampler, at);
        out.roughness *= texel.g;
        out.metallic *= texel.b;
    }
    if detail_has(NORMALS) {
        out.normal = detail_normal(normal, place, detail_uv(NORMALS, uv));
    }
    return out;
}

// Normal; metalness, roughness (8 bits each) and the root of the emission's share (5, 6, 5 bits).
fn detail_pack(d: Detail) -> vec2u {
    let shine = vec2u(round(saturate(vec2f(d.metallic, d.roughness)) * 255.0));
    let glow = vec3u(round(sqrt(saturate(d.emission)) * vec3f(31.0, 63.0, 31.0)));
    let look = shine.x | (shine.y << 8u) | (glow.x << 16u) | (glow.y << 21u) | (glow.z << 27u);
    return vec2u(pack_normal(d.normal), look);
}
