// Light of a point from its row of links: the sum over the threads of a row, and what the point's parents say (paper,
// Eq. 4). One level a dispatch, coarse to fine.

@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(4) var<storage, read> push_offsets: array<u32>;
@group(0) @binding(5) var<storage, read> push_entries: array<u32>;
@group(0) @binding(6) var<storage, read> points: array<Point>;
// RGB, and its tilt.
@group(0) @binding(7) var<storage, read_write> pushed: array<vec4f>;

var<workgroup> sums: array<array<vec3f, 2>, 64>;

// The light of row k of the dispatch, from a thread's share of its sum and of its flow: irradiance along the normal, RGB,
// and across it, all channels together. All threads of a workgroup call it.
fn push_row(k: u32, thread: u32, sum_of_thread: vec3f, flow_of_thread: vec3f) {
    let lane = thread % LANES;
    var sum = sum_of_thread;
    var flow = flow_of_thread;
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
    let i = step_.first + k;
    var parents = vec3f(0.0);
    var parents_flow = vec3f(0.0);
    var total = 0.0;
    for (var at = push_offsets[i]; at < push_offsets[i + 1u]; at++) {
        let entry = push_entries[at];
        let parent = pushed[entry_point(entry)];
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
    pushed[i] = vec4f(sum, tilt);
}
