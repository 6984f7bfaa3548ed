// What a dispatch of an antiradiance step works on; as shared/src/antiradiance.
struct Pass {
    // First element, patch or item, and how many.
    first: u32,
    count: u32,
    // Workgroups of the grid in x.
    groups: u32,
    // Bins of directions.
    bins: u32,
    // Sine of the half angle of a bin, and its solid angle.
    sine: f32,
    solid_angle: f32,
    // Number of patches.
    patches: u32,
    // First offset of the links of what moves, which come after those of what stands; 0 where all is one.
    moving: u32,
    // Every `slices`th bin counts, from bin `slice` on.
    slice: u32,
    slices: u32,
}

struct Element {
    position: vec3f,
    radius: f32,
    normal: vec3f,
    area: f32,
    parent: u32,
    // First child of a cluster; of a patch, its index.
    first: u32,
    children: u32,
    // Number among the glossy patches, or NONE.
    glossy: u32,
}

const NONE = 0xffffffffu;

@group(0) @binding(0) var<uniform> pass_: Pass;
@group(0) @binding(1) var<storage, read> elements: array<Element>;
// Directions of the middles of the bins.
@group(0) @binding(2) var<storage, read> ways: array<vec4f>;

// A cell of the tables: three half floats.
fn packed(light: vec3f) -> vec2u {
    return vec2u(pack2x16float(light.xy), pack2x16float(vec2f(light.z, 0.0)));
}

fn unpacked(cell: vec2u) -> vec3f {
    return vec3f(unpack2x16float(cell.x), unpack2x16float(cell.y).x);
}

// Means of cosines over a bin; as shared/src/antiradiance/cosines.rs.
struct BinCosines {
    front: f32,
    back: f32,
    share: f32,
}

fn bin_cosines(cosine: f32) -> BinCosines {
    let slope = pass_.sine * sqrt(max(1.0 - cosine * cosine, 0.0));
    if abs(cosine) >= slope {
        return BinCosines(max(cosine, 0.0), max(-cosine, 0.0), select(0.0, 1.0, cosine < 0.0));
    }
    let at = cosine / slope;
    let round = sqrt(max(1.0 - at * at, 0.0));
    let before = 0.5 + (at * round + asin(at)) / 3.14159265;
    let front = max(cosine * before + slope * (2.0 / 3.0) / 3.14159265 * round * round * round, 0.0);
    return BinCosines(front, max(front - cosine, 0.0), 1.0 - before);
}

fn arriving(cosines: BinCosines) -> f32 {
    return select(0.0, cosines.back / cosines.share, cosines.share > 0.0);
}

// Exitant intensity of a patch by area; w of its radiance is the normalisation of its cosines. As
// shared/src/antiradiance/local.rs.
fn leaving(cosines: BinCosines, radiance: vec4f, incident: vec3f) -> vec3f {
    return radiance.w * (cosines.front * radiance.xyz - arriving(cosines) * incident);
}
