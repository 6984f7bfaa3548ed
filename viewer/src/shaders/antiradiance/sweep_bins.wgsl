// A wave of a sweep; as shared/src/antiradiance/sweep.rs, in the order of waves.rs.

// Cells, and with the topmost bit clusters whose children have left their light.
@group(0) @binding(5) var<storage, read> items: array<u32>;
@group(0) @binding(6) var<storage, read> radiance: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> incident: array<vec2u>;
@group(0) @binding(8) var<storage, read_write> exitant: array<vec2u>;

@compute @workgroup_size(64)
fn sweep_bins(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let k = (group.y * pass_.groups + group.x) * 64u + thread;
    if k >= pass_.count {
        return;
    }
    let item = items[pass_.first + k];
    let cell = item & 0x7fffffffu;
    let own = cell / pass_.bins;
    let bin = cell % pass_.bins;
    if item != cell {
        exitant[cell] = packed(pulled(own, bin));
        return;
    }
    var light = gathered(cell);
    let cosines = bin_cosines(dot(elements[own].normal, ways[bin].xyz));
    let is_patch = elements[own].children == 0u;
    if elements[own].parent != NONE {
        light += select(1.0, cosines.share, is_patch) * unpacked(incident[elements[own].parent * pass_.bins + bin]);
    }
    incident[cell] = packed(light);
    if is_patch {
        exitant[cell] = packed(leaving(cosines, leaves(own, bin), light));
    }
}
