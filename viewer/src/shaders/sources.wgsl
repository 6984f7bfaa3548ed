// Irradiance at the points straight from the sources of a file, the sky and emissive surfaces: links times strengths, and
// what the point's parents say; as `from_sources` of shared/src/relight.rs. One level a dispatch, coarse to fine. LANES
// threads share a row.

// As `SourceLink` of shared/src/link.rs: the source, 13 bits, and a signed number of steps.
@group(0) @binding(2) var<storage, read> links: array<u32>;
// By source: irradiance of a step, RGB, and the direction that light of the sky comes from, packed as a tilt; else 0.
@group(0) @binding(3) var<storage, read> strengths: array<vec4f>;

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
    push_row(k, thread, sum, flow);
}
