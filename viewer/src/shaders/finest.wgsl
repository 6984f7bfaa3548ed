// The finest level: irradiance along a point's normal from its links, and what its parents say there. (To turn a
// parent's vectors with its normal keeps the irradiance along it.) Rows are short: one thread each.

@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> links: array<u32>;
@group(0) @binding(3) var<storage, read> sent: array<vec4f>;
@group(0) @binding(4) var<storage, read> push_offsets: array<u32>;
@group(0) @binding(5) var<storage, read> push_entries: array<u32>;
@group(0) @binding(6) var<storage, read_write> display: array<vec4f>;

@compute @workgroup_size(64)
fn finest(@builtin(global_invocation_id) id: vec3u) {
    let k = id.x + id.y * step_.threads;
    if k >= step_.count {
        return;
    }
    let row = step_.first + k;
    let i = row + step_.shift;
    var sum = vec3f(0.0);
    var total = 0.0;
    var tilt = vec4f(0.0);
    for (var at = push_offsets[i]; at < push_offsets[i + 1u]; at++) {
        let entry = push_entries[at];
        let parent = display[entry_point(entry)];
        sum += parent.xyz * entry_weight(entry);
        total += entry_weight(entry);
        if step_.tilts != 0u {
            tilt += vec4f(tilt_unpack(parent.w), 1.0) * (entry_weight(entry) * tilt_weight(parent.xyz));
        }
    }
    if total > 0.0 {
        sum /= total;
    }
    let end = offsets[row + 1u] - step_.extra;
    for (var at = offsets[row] - step_.extra; at < end; at++) {
        sum += link_amount(links[at]) * sent[link_sender(links[at])].xyz;
    }
    display[i] = vec4f(sum, select(0.0, tilt_mean(tilt), step_.tilts != 0u));
}
