// Bounced light of the points of a level for display: that of the operator, and the difference of two solutions, in which what moves
// is where it is now and at rest. A point has the difference of its patch, or what its parents have.

// Patch of each point, or NONE.
@group(0) @binding(1) var<storage, read> patch_of: array<u32>;
@group(0) @binding(2) var<storage, read> now: array<vec4f>;
@group(0) @binding(3) var<storage, read> at_rest: array<vec4f>;
@group(0) @binding(4) var<storage, read> push_offsets: array<u32>;
@group(0) @binding(5) var<storage, read> push_entries: array<u32>;
// The operator's light, and its tilt.
@group(0) @binding(6) var<storage, read> by_operator: array<vec4f>;
// What changes of it.
@group(0) @binding(7) var<storage, read_write> handed_down: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> display: array<vec4f>;

@compute @workgroup_size(64)
fn change_patches(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let k = number_of(group, thread);
    if k >= points_.count {
        return;
    }
    let i = points_.first + k;
    let own = patch_of[i];
    var change = vec3f(0.0);
    if own != NONE {
        change = now[own].xyz - at_rest[own].xyz;
    } else {
        change = of_parents(i);
    }
    handed_down[i] = vec4f(change, 0.0);
    display[i] = vec4f(max(by_operator[i].xyz + change, vec3f(0.0)), by_operator[i].w);
}
