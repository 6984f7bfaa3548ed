// Adds to the senders' direct irradiance what comes to them after one and more bounces: at the
// points of the coarse levels from the links for later bounces, at finer senders interpolated
// from their parents; one level a dispatch. Leaves the values zero for the transport.

@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> entries: array<u32>;
@group(0) @binding(3) var<storage, read> points: array<Point>;
@group(0) @binding(4) var<storage, read_write> values: array<f32>;
@group(0) @binding(5) var<storage, read_write> bounced: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> irradiance: array<vec4f>;

const FROM_LINKS = 0u;

@compute @workgroup_size(64)
fn lift(@builtin(global_invocation_id) id: vec3u) {
    let k = id.x + id.y * step_.threads;
    if k >= step_.count {
        return;
    }
    let i = step_.first + k;
    var sum = vec3f(0.0);
    if step_.extra == FROM_LINKS {
        sum = value_irradiance(i, unpack_normal(points[i].normal));
        for (var at = i * 9u; at < i * 9u + 9u; at++) {
            values[at] = 0.0;
        }
    } else {
        var total = 0.0;
        for (var at = offsets[i]; at < offsets[i + 1u]; at++) {
            let entry = entries[at];
            sum += bounced[entry_point(entry)].xyz * entry_weight(entry);
            total += entry_weight(entry);
        }
        if total > 0.0 {
            sum /= total;
        }
    }
    bounced[i] = vec4f(sum, 0.0);
    irradiance[i] += vec4f(sum, 0.0);
}
