// Bounced light of a solution for display, without tilts: where it comes from is not known.

@group(0) @binding(1) var<storage, read> values: array<vec4f>;
@group(0) @binding(2) var<storage, read> sum: array<vec4f>;
@group(0) @binding(3) var<storage, read> direct: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> display: array<vec4f>;

// As a zero vector is packed by tilt.wgsl.
const DARK = 8421504.0;

// `none` 1: the bounces so far; 0: the values of the last pass, all light.
@compute @workgroup_size(64)
fn show_light(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let i = (group.y * pass_.groups + group.x) * 64u + thread;
    if i >= pass_.count {
        return;
    }
    display[i] = vec4f(select(values[i].xyz, max(sum[i].xyz - direct[i].xyz, vec3f(0.0)), pass_.none != 0u), DARK);
}
