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
    if elements[own].children > 0u {
        exitant[cell] = packed(pulled(own, bin));
        return;
    }
    let cosines = bin_cosines(dot(elements[own].normal, ways[bin].xyz));
    exitant[cell] = packed(leaving(cosines, leaves(own, bin), unpacked(incident[cell])));
}
