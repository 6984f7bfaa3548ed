// Bounced light of the points of a level for display: that of their patch, or what their parents have.

// Patch of each point, or NONE.
@group(0) @binding(1) var<storage, read> patch_of: array<u32>;
@group(0) @binding(2) var<storage, read> bounced: array<vec4f>;
@group(0) @binding(3) var<storage, read> push_offsets: array<u32>;
@group(0) @binding(4) var<storage, read> push_entries: array<u32>;
// What is displayed.
@group(0) @binding(5) var<storage, read_write> handed_down: array<vec4f>;

@compute @workgroup_size(64)
fn show_patches(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let k = number_of(group, thread);
    if k >= points_.count {
        return;
    }
    let i = points_.first + k;
    let own = patch_of[i];
    if own != NONE {
        handed_down[i] = vec4f(max(bounced[own].xyz, vec3f(0.0)), EVEN);
        return;
    }
    handed_down[i] = vec4f(of_parents(i).xyz, EVEN);
}
