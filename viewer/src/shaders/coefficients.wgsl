// The senders' coefficients: value minus what the parents' values interpolate to (paper, Eq. 7).

struct Step {
    first: u32,
    count: u32,
    extra: u32,
    threads: u32,
}

@group(0) @binding(0) var<uniform> step_: Step;
@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> entries: array<u32>;
@group(0) @binding(3) var<storage, read> irradiance: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> coefficients: array<vec4f>;

@compute @workgroup_size(64)
fn differences(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x + id.y * step_.threads;
    if i >= step_.count {
        return;
    }
    var sum = vec3f(0.0);
    var total = 0.0;
    for (var at = offsets[i]; at < offsets[i + 1u]; at++) {
        let entry = entries[at];
        sum += irradiance[entry_point(entry)].xyz * entry_weight(entry);
        total += entry_weight(entry);
    }
    if total > 0.0 {
        sum /= total;
    }
    coefficients[i] = vec4f(irradiance[i].xyz - sum, 0.0);
}
