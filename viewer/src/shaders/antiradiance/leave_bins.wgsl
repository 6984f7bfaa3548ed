// The local pass, J, and pull of a level: exitant intensity of radiance less antiradiance, by area; as
// shared/src/antiradiance/local.rs and transport.rs.

@group(0) @binding(3) var<storage, read> radiance: array<vec4f>;
@group(0) @binding(4) var<storage, read> incident: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> exitant: array<vec2u>;

@compute @workgroup_size(64)
fn leave_bins(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let k = (group.y * pass_.groups + group.x) * 64u + thread;
    let bins = (pass_.bins - pass_.slice + pass_.slices - 1u) / pass_.slices;
    if k >= pass_.count * bins {
        return;
    }
    let own = pass_.first + k / bins;
    let bin = pass_.slice + k % bins * pass_.slices;
    let cell = own * pass_.bins + bin;
    if elements[own].children > 0u {
        exitant[cell] = packed(pulled(own, bin));
        return;
    }
    let cosines = bin_cosines(dot(elements[own].normal, ways[bin].xyz));
    exitant[cell] = packed(leaving(cosines, leaves(own, bin), unpacked(incident[cell])));
}
