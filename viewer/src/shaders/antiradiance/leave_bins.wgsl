// The local pass, J, and pull of a level: exitant intensity of radiance less antiradiance, by area; as
// shared/src/antiradiance/local.rs and transport.rs.

@group(0) @binding(3) var<storage, read> radiance: array<vec4f>;
@group(0) @binding(4) var<storage, read> incident: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> exitant: array<vec2u>;

@compute @workgroup_size(64)
fn leave_bins(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let k = (group.y * pass_.groups + group.x) * 64u + thread;
    if k >= pass_.count * pass_.bins {
        return;
    }
    let cell = pass_.first * pass_.bins + k;
    let own = cell / pass_.bins;
    let bin = cell % pass_.bins;
    let first = elements[own].first;
    var light = vec3f(0.0);
    if elements[own].children == 0u {
        let cosines = bin_cosines(dot(elements[own].normal, ways[bin].xyz));
        light = leaving(cosines, radiance[first], unpacked(incident[cell]));
    } else {
        for (var child = first; child < first + elements[own].children; child++) {
            light += elements[child].area * unpacked(exitant[child * pass_.bins + bin]);
        }
        light /= max(elements[own].area, 1e-30);
    }
    exitant[cell] = packed(light);
}
