// Bounced light of the points of a level for display: that of the operator, and what antiradiance changes of it, with what moves where
// it is now and at rest; as shared/src/antiradiance/beside.rs. A point has the change of its patch, or what its parents have.

// Patch of each point and its departure in the topmost 8 bits, or NONE.
@group(0) @binding(1) var<storage, read> patch_of: array<u32>;
@group(0) @binding(2) var<storage, read> now: array<vec4f>;
@group(0) @binding(3) var<storage, read> at_rest: array<vec4f>;
@group(0) @binding(4) var<storage, read> push_offsets: array<u32>;
@group(0) @binding(5) var<storage, read> push_entries: array<u32>;
// The operator's light, and its tilt.
@group(0) @binding(6) var<storage, read> by_operator: array<vec4f>;
// What changes of it, and the share of it to leave out.
@group(0) @binding(7) var<storage, read_write> handed_down: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> display: array<vec4f>;

@compute @workgroup_size(64)
fn change_patches(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let k = number_of(group, thread);
    if k >= points_.count {
        return;
    }
    let i = points_.first + k;
    let entry = patch_of[i];
    var change = vec4f(0.0);
    if entry != NONE {
        let own = entry & 0xffffffu;
        let departure = f32(entry >> 24u) / 255.0;
        change = vec4f(now[own].xyz - (1.0 - departure) * at_rest[own].xyz, departure);
    } else {
        change = of_parents(i);
    }
    handed_down[i] = change;
    let light = max((1.0 - change.w) * by_operator[i].xyz + change.xyz, vec3f(0.0));
    // Where the operator's light comes from is of no use elsewhere.
    display[i] = vec4f(light, select(by_operator[i].w, EVEN, change.w > 0.5));
}
