// Light that senders send to points of glossy surfaces, in place of what the parents say; as `SenderLight` of
// shared/src/gloss.rs, links as in shared/src/rbn/gloss_links.rs. A thread a point.

// By point of the transfer: its number in the file, and its cluster.
@group(0) @binding(1) var<storage, read> members: array<vec2u>;
@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> offsets: array<u32>;
@group(0) @binding(4) var<storage, read> links: array<vec2u>;
// Light of the senders, RGB; radiance of the groups of emissive surfaces, whose numbers follow those of the points.
@group(0) @binding(5) var<storage, read> sent: array<vec4f>;
@group(0) @binding(6) var<storage, read> emission: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> arriving: array<vec4f>;

@compute @workgroup_size(64)
fn gloss_links(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let k = (group.y * pass_.groups + group.x) * 64u + thread;
    let place = pass_.first + k;
    if k >= pass_.count || place + 1u >= arrayLength(&offsets) {
        return;
    }
    let end = offsets[place + 1u];
    if offsets[place] >= end {
        return;
    }
    let normal = unpack_normal(points[members[place].x].normal);
    var sums: array<vec3f, HARMONICS>;
    for (var at = offsets[place]; at < end; at++) {
        let link = links[at];
        let code = (link.y >> 16u) & 255u;
        let amount = select(exp2((f32(code) - 192.0) / 16.0), 0.0, code == 0u);
        var light = vec3f(0.0);
        if link.x < pass_.points {
            light = sent[min(link.x, arrayLength(&sent) - 1u)].rgb;
        } else {
            light = emission[min(link.x - pass_.points, arrayLength(&emission) - 1u)].rgb;
        }
        light *= amount;
        let place_on_square = vec2f(vec2u(link.y & 255u, (link.y >> 8u) & 255u)) / 127.0 - 1.0;
        let direction = octahedral_decode(min(place_on_square, vec2f(1.0)));
        let above = harmonics(direction);
        let below = harmonics(reflect(direction, normal));
        var bands = harmonics_lobe(f32(link.y >> 24u) / 255.0);
        var i = 0u;
        for (var band = 0u; band < 5u; band++) {
            for (var order = 0u; order < 2u * band + 1u; order++) {
                sums[i] += light * ((above[i] + below[i]) * bands[band]);
                i++;
            }
        }
    }
    for (var i = 0u; i < HARMONICS; i++) {
        let before = arriving[place * HARMONICS + i];
        arriving[place * HARMONICS + i] = vec4f(sums[i], before.w);
    }
}
