// Irradiance at the points straight from the sources of a file, the sky and emissive surfaces: links times strengths, and
// what the point's parents say; as `from_sources` of shared/src/relight.rs. One level a dispatch, coarse to fine. LANES
// threads share a row.

@group(0) @binding(1) var<storage, read> offsets: array<u32>;
// As `SourceLink` of shared/src/link.rs: the source, 13 bits, and a signed number of steps.
@group(0) @binding(2) var<storage, read> links: array<u32>;
// By source: irradiance of a step, RGB, and the direction that light of the sky comes from, packed as a tilt; else 0.
@group(0) @binding(3) var<storage, read> strengths: array<vec4f>;
@group(0) @binding(4) var<storage, read> push_offsets: array<u32>;
@group(0) @binding(5) var<storage, read> push_entries: array<u32>;
@group(0) @binding(6) var<storage, read> points: array<Point>;
// RGB, and its tilt.
@group(0) @binding(7) var<storage, read_write> from_sources: array<vec4f>;

var<workgroup> sums: array<array<vec3f, 2>, 64>;

@compute @workgroup_size(64)
fn sources(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let lane = thread % LANES;
    let k = lanes_row(group, thread);
    let i = step_.first + k;
    var sum = vec3f(0.0);
    // Irradiance across the normal, all channels together.
    var flow = vec3f(0.0);
    if k < step_.count {
        let normal = unpack_normal(points[i].normal);
        let end = offsets[i + 1u] - step_.extra;
        for (var at = offsets[i] - step_.extra + lane; at < end; at += LANES) {
            let strength = strengths[links[at] & 0x1fffu];
            let light = f32(bitcast<i32>(links[at]) >> 13u) * strength.xyz;
            sum += light;
            if step_.tilts != 0u && strength.w > 0.0 {
                flow += dot(light, vec3f(1.0)) * tilt_across(normalize(tilt_unpack(strength.w)), normal);
            }
        }
    }
    if LANES > 1u {
        sums[thread] = array<vec3f, 2>(sum, flow);
        for (var reach = LANES / 2u; reach > 0u; reach /= 2u) {
            workgroupBarrier();
            if lane < reach {
                sum += sums[thread + reach][0];
                flow += sums[thread + reach][1];
                sums[thread] = array<vec3f, 2>(sum, flow);
            }
        }
    }
    if k >= step_.count || lane != 0u {
        return;
    }
    var parents = vec3f(0.0);
    var parents_flow = vec3f(0.0);
    var total = 0.0;
    for (var at = push_offsets[i]; at < push_offsets[i + 1u]; at++) {
        let entry = push_entries[at];
        let parent = from_sources[entry_point(entry)];
        parents += parent.xyz * entry_weight(entry);
        total += entry_weight(entry);
        if step_.tilts != 0u {
            parents_flow += tilt_unpack(parent.w) * (tilt_weight(parent.xyz) * entry_weight(entry));
        }
    }
    if total > 0.0 {
        sum += parents / total;
        flow += parents_flow / total;
    }
    var tilt = 0.0;
    if step_.tilts != 0u {
        tilt = tilt_mean(vec4f(flow, tilt_weight(sum)));
    }
    from_sources[i] = vec4f(sum, tilt);
}
