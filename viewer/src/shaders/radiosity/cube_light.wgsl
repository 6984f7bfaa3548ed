// Light of the texels of cube maps: radiance of the surfaces that they see, and coverage; as cube_maps/lit.rs of the baker. A
// thread a texel.

struct CubeLight {
    // By sky: factor of the texture, RGB, and rotation in radians.
    sky: array<vec4f, 4>,
    skies: u32,
    // Texels along an edge, and of all maps.
    side: u32,
    count: u32,
    // Workgroups of the grid in x.
    groups: u32,
    // Factor of radiance in the texture.
    unit: f32,
}

// Words of a texel: reflectance and roughness, groups, and the row of its functions.
const TEXEL_WORDS = 10u;
const TEXEL_FUNCTIONS = 8u;
const NOWHERE = 0xffffffffu;
const PI = 3.14159265;
// Most of what the texture holds.
const MOST = 65000.0;

@group(0) @binding(0) var<uniform> reflecting: CubeLight;
// The texels as points: radius 0 where nothing is seen.
@group(0) @binding(1) var<storage, read> points: array<Point>;
@group(0) @binding(2) var<storage, read> texels: array<u32>;
// Irradiance of the file's points, and of the texels from lamps.
@group(0) @binding(3) var<storage, read> display: array<vec4f>;
@group(0) @binding(4) var<storage, read> direct: array<vec4f>;
// Radiance of the groups of emissive surfaces.
@group(0) @binding(5) var<storage, read> emission: array<vec4f>;
// Glossy transfer, as in reflections.wgsl.
@group(0) @binding(6) var<storage, read> places: array<u32>;
@group(0) @binding(7) var<storage, read> arriving: array<vec4f>;
@group(0) @binding(8) var sky_texture: texture_2d<f32>;
@group(0) @binding(9) var sky_sampler: sampler;
@group(0) @binding(10) var radiance: texture_storage_2d_array<rgba16float, write>;

// What a white metal reflects that is seen along `way`, as `metal_in_map` of shared/src/cube_map/mod.rs; w is 0 where the
// transfer does not reach.
fn metal_reflected(row: u32, way: vec3f, normal: vec3f, roughness: f32) -> vec4f {
    let mirrored = reflect(way, normal);
    let alpha = max(roughness * roughness, LEAST_ALPHA);
    let sharpness = 0.5 / (alpha * alpha);
    let twice = exp(-2.0 * sharpness);
    var bands = harmonics_lobe(saturate((1.0 + twice) / (1.0 - twice) - 1.0 / sharpness));
    let y = harmonics(mirrored);
    var sum = vec4f(0.0);
    var total = 0.0;
    for (var k = 0u; k < TEXEL_FUNCTIONS; k++) {
        let entry = texels[row + 2u + k];
        if entry == 0u {
            break;
        }
        let place = places[entry & POINT_MASK];
        if place == NOWHERE {
            continue;
        }
        let weight = slots_weight(entry);
        total += weight;
        var i = 0u;
        for (var band = 0u; band < 5u; band++) {
            for (var order = 0u; order < 2u * band + 1u; order++) {
                sum += (weight * y[i] * bands[band]) * arriving[place * HARMONICS + i];
                i++;
            }
        }
    }
    if total <= 0.0 {
        return vec4f(0.0);
    }
    sum /= total;
    let sky = reflected_sky(mirrored, TAU * (1.0 - twice) / sharpness);
    return vec4f(max(sum.rgb + saturate(sum.w) * sky, vec3f(0.0)), 1.0);
}

@compute @workgroup_size(64)
fn cube_light(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let i = (group.y * reflecting.groups + group.x) * 64u + thread;
    if i >= reflecting.count {
        return;
    }
    let of_face = reflecting.side * reflecting.side;
    let layer = i / of_face;
    let texel = vec2u(i % reflecting.side, i % of_face / reflecting.side);
    if points[i].radius <= 0.0 {
        textureStore(radiance, texel, layer, vec4f(0.0));
        return;
    }
    let row = i * TEXEL_WORDS;
    var light = vec3f(0.0);
    var total = 0.0;
    for (var k = 0u; k < TEXEL_FUNCTIONS; k++) {
        let entry = texels[row + 2u + k];
        if entry == 0u {
            break;
        }
        let weight = slots_weight(entry);
        total += weight;
        light += weight * display[entry & POINT_MASK].rgb;
    }
    var around = max(light / max(total, 1e-20), vec3f(0.0)) / PI;
    let packed = texels[row];
    if packed >> 24u > 0u {
        let way = normalize(cube_toward(layer % 6u, cube_place(texel, reflecting.side)));
        let roughness = f32((packed >> 24u) - 1u) / 254.0;
        let reflected = metal_reflected(row, way, unpack_normal(points[i].normal), roughness);
        around = select(around, reflected.rgb, reflected.w > 0.0);
    }
    let root = unpack4x8unorm(packed).rgb;
    var out = root * root * (around + direct[i].rgb / PI);
    let shining = texels[row + 1u] & 0xffffu;
    if shining > 0u {
        out += emission[min(shining, arrayLength(&emission)) - 1u].rgb;
    }
    textureStore(radiance, texel, layer, vec4f(min(reflecting.unit * out, vec3f(MOST)), 1.0));
}
