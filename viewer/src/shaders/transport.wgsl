// Irradiance along a point's normal: links times what the senders send (paper, Eq. 15), and what the point's parents
// say (Eq. 4). One level a dispatch, coarse to fine. LANES threads share a row.

@group(0) @binding(2) var<storage, read> links: array<u32>;
@group(0) @binding(3) var<storage, read> sent: array<vec4f>;

@compute @workgroup_size(64)
fn transport(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let lane = thread % LANES;
    let k = lanes_row(group, thread);
    let i = step_.first + k;
    var sum = vec3f(0.0);
    // Irradiance across the normal, all channels together.
    var flow = vec3f(0.0);
    if k < step_.count {
        let end = offsets[i + 1u] - step_.extra;
        for (var at = offsets[i] - step_.extra + lane; at < end; at += LANES) {
            sum += link_amount(links[at]) * sent[link_sender(links[at])].xyz;
        }
        if step_.tilts != 0u {
            let position = point_position(points[i]);
            let normal = unpack_normal(points[i].normal);
            for (var at = offsets[i] - step_.extra + lane; at < end; at += LANES) {
                let sender = link_sender(links[at]);
                let light = link_amount(links[at]) * dot(sent[sender].xyz, vec3f(1.0));
                let way = point_position(points[sender]) - position;
                flow += light * tilt_across(way / max(length(way), 1e-20), normal);
            }
        }
    }
    push_row(k, thread, sum, flow);
}
