// Radiance at probes, nine coefficients of spherical harmonics each: rows of coefficients times the light of senders. A
// thread sums one coefficient of one probe. As `apply` of probes/rows.rs.

struct Entry {
    // The sending point; with the highest bit, the source.
    sender: u32,
    coefficients: array<f32, 9>,
}

const SOURCE = 0x80000000u;
const COUNT = 9u;

@group(0) @binding(0) var<storage, read> offsets: array<u32>;
@group(0) @binding(1) var<storage, read> entries: array<Entry>;
@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> irradiance: array<vec4f>;
// By source, RGB.
@group(0) @binding(4) var<storage, read> strengths: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> radiance: array<vec4f>;

@compute @workgroup_size(64)
fn probes(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let at = id.x + id.y * groups.x * 64u;
    let probe = at / COUNT;
    if probe + 1u >= arrayLength(&offsets) {
        return;
    }
    var sum = vec3f(0.0);
    for (var k = offsets[probe]; k < offsets[probe + 1u]; k++) {
        let sender = entries[k].sender;
        var light = vec3f(0.0);
        if sender >= SOURCE {
            light = strengths[sender & ~SOURCE].xyz;
        } else {
            light = unpack_rgb9e5(points[sender].tint) * irradiance[sender].xyz;
        }
        sum += light * entries[k].coefficients[at % COUNT];
    }
    radiance[at] = vec4f(sum, 0.0);
}
