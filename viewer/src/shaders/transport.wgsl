// Irradiance along a point's normal: links times what the senders send (paper, Eq. 15), and what the point's parents
// say (Eq. 4). One level a dispatch, coarse to fine. LANES threads share a row.

@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> links: array<u32>;
@group(0) @binding(3) var<storage, read> sent: array<vec4f>;
@group(0) @binding(4) var<storage, read> push_offsets: array<u32>;
@group(0) @binding(5) var<storage, read> push_entries: array<u32>;
@group(0) @binding(6) var<storage, read> points: array<Point>;
// RGB, and its tilt.
@group(0) @binding(7) var<storage, read_write> display: array<vec4f>;

var<workgroup> sums: array<array<vec3f, 2>, 64>;

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
    if LANES > 1u {
        sums[thread] = array<vec3f, 2>(sum, flow);
        for (var reach = LANES / 2u; reach > 0u; reach /= 2u) {
            workgroupBarrier();
            if lane < reach {
                sum += sums[thread + reach][0];
                flow += sums[thread + reach][1];
                sums[thread] = array<vec3f, 2>(sum, flow);
            }
        }
    }
    if k >= step_.count || lane != 0u {
        return;
    }
    var parents = vec3f(0.0);
    var parents_flow = vec3f(0.0);
    var total = 0.0;
    for (var at = push_offsets[i]; at < push_offsets[i + 1u]; at++) {
        let entry = push_entries[at];
        let parent = display[entry_point(entry)];
        parents += parent.xyz * entry_weight(entry);
        total += entry_weight(entry);
        if step_.tilts != 0u {
            parents_flow += tilt_unpack(parent.w) * (tilt_weight(parent.xyz) * entry_weight(entry));
        }
    }
    if total > 0.0 {
        sum += parents / total;
        flow += parents_flow / total;
    }
    var tilt = 0.0;
    if step_.tilts != 0u {
        tilt = tilt_mean(vec4f(flow, tilt_weight(sum)));
    }
    display[i] = vec4f(sum, tilt);
}
