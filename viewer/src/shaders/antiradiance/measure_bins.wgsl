// The shading integral of the patches: irradiance from the incident radiance of all bins; as
// shared/src/antiradiance/local.rs.

@group(0) @binding(3) var<storage, read> incident: array<vec2u>;
@group(0) @binding(4) var<storage, read> radiance: array<vec4f>;
// Bounced irradiance.
@group(0) @binding(5) var<storage, read_write> irradiance: array<vec4f>;

@compute @workgroup_size(64)
fn measure_bins(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let k = (group.y * pass_.groups + group.x) * 64u + thread;
    if k >= pass_.count {
        return;
    }
    let own = pass_.first + k;
    if elements[own].children > 0u {
        return;
    }
    let patch_ = elements[own].first;
    var sum = vec3f(0.0);
    for (var bin = 0u; bin < pass_.bins; bin++) {
        let cosine = dot(elements[own].normal, ways[bin].xyz);
        if cosine < pass_.sine {
            sum += arriving(bin_cosines(cosine)) * unpacked(incident[own * pass_.bins + bin]);
        }
    }
    irradiance[patch_] = vec4f(radiance[patch_].w * pass_.solid_angle * sum, 0.0);
}
