// The local pass of metals, K: radiance by bin; as shared/src/antiradiance/lobe.rs.

// By glossy patch and bin, what the sum is multiplied with.
@group(0) @binding(4) var<storage, read> gains: array<vec4f>;
@group(0) @binding(5) var<storage, read> arriving_by_bin: array<vec4f>;
// Of matt patches, then of glossy ones by bin.
@group(0) @binding(6) var<storage, read_write> radiance: array<vec4f>;

const LEAST_COSINE = 0.02;

// A way raised over the horizon.
fn raised(way: vec3f, normal: vec3f) -> vec3f {
    return normalize(way + max(LEAST_COSINE - dot(way, normal), 0.0) * normal);
}

@compute @workgroup_size(64)
fn reflect_lobes(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let cell = glossy_cell(group, thread);
    if cell.x >= pass_.count {
        return;
    }
    let first = cell.x * pass_.bins;
    let normal = elements[glossy[cell.x].element].normal;
    let alpha = glossy[cell.x].alpha;
    let to_eye = raised(ways[cell.y].xyz, normal);
    let nv = dot(to_eye, normal);
    let masked = 1.0 + smith_lambda(alpha, nv);
    var sum = vec3f(0.0);
    for (var bin = 0u; bin < pass_.bins; bin++) {
        let light = arriving_by_bin[first + bin].xyz;
        if all(light == vec3f(0.0)) {
            continue;
        }
        let to_light = raised(-ways[bin].xyz, normal);
        let nl = dot(to_light, normal);
        let nh = dot(normalize(to_eye + to_light), normal);
        let spread = nh * nh * (alpha * alpha - 1.0) + 1.0;
        let density = alpha * alpha / (3.14159265 * spread * spread);
        sum += density / ((masked + smith_lambda(alpha, nl)) * 4.0 * nv * nl) * light;
    }
    radiance[pass_.patches + first + cell.y] = vec4f(gains[first + cell.y].xyz * sum, 0.0);
}
