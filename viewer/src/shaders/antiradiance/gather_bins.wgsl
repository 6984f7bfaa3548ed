// Global pass and push of a level: light over links, and the light of the cluster above; as
// shared/src/antiradiance/transport.rs, links by cell.

// Exitant intensity by area.
@group(0) @binding(5) var<storage, read> exitant: array<vec2u>;
@group(0) @binding(6) var<storage, read_write> incident: array<vec2u>;

@compute @workgroup_size(64)
fn gather_bins(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let k = (group.y * pass_.groups + group.x) * 64u + thread;
    if k >= pass_.count * pass_.bins {
        return;
    }
    let cell = pass_.first * pass_.bins + k;
    let own = cell / pass_.bins;
    let bin = cell % pass_.bins;
    var light = gathered(cell);
    if elements[own].parent != NONE {
        let above = unpacked(incident[elements[own].parent * pass_.bins + bin]);
        if elements[own].children > 0u {
            light += above;
        } else {
            light += bin_cosines(dot(elements[own].normal, ways[bin].xyz)).share * above;
        }
    }
    incident[cell] = packed(light);
}
