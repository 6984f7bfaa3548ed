// What bounces again at finer senders is interpolated from their parents, and added to their direct light; one
// level a dispatch.

@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> entries: array<u32>;
@group(0) @binding(3) var<storage, read_write> bounced: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> irradiance: array<vec4f>;

@compute @workgroup_size(64)
fn lift(@builtin(global_invocation_id) id: vec3u) {
    let k = id.x + id.y * step_.threads;
    if k >= step_.count {
        return;
    }
    let i = step_.first + k;
    var sum = vec3f(0.0);
    var total = 0.0;
    for (var at = offsets[i]; at < offsets[i + 1u]; at++) {
        let entry = entries[at];
        sum += bounced[entry_point(entry)].xyz * entry_weight(entry);
        total += entry_weight(entry);
    }
    if total > 0.0 {
        sum /= total;
    }
    bounced[i] = vec4f(sum, 0.0);
    irradiance[i] += vec4f(sum, 0.0);
}
