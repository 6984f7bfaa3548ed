// Light of a level's points as their parents have it, and which of them are gathered for (Schäfer et al. 2011, 5); as
// shared/src/radiosity/levels.rs.

@group(0) @binding(1) var<storage, read> push_offsets: array<u32>;
@group(0) @binding(2) var<storage, read> push_entries: array<u32>;
// Mean irradiance of the coarsest level, bounce by bounce.
@group(0) @binding(3) var<storage, read> means: array<f32>;
@group(0) @binding(4) var<storage, read_write> values: array<vec4f>;

const DIM = 0.25;

@compute @workgroup_size(64)
fn pull_down(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let k = (group.y * pass_.groups + group.x) * 64u + thread;
    if k >= pass_.count {
        return;
    }
    let i = pass_.first + k;
    var sum = vec3f(0.0);
    var total = 0.0;
    var refined = pass_.whole != 0u;
    for (var at = push_offsets[i]; at < push_offsets[i + 1u]; at++) {
        let entry = push_entries[at];
        let parent = values[entry_point(entry)];
        sum += parent.xyz * entry_weight(entry);
        total += entry_weight(entry);
        refined = refined || parent.w == REFINED;
    }
    var state = select(0.0, max(DIM * means[pass_.bounce], 1e-30), refined);
    if total > 0.0 {
        sum /= total;
    } else {
        state = ORPHAN;
    }
    values[i] = vec4f(sum, select(state, 0.0, pass_.none != 0u));
}
