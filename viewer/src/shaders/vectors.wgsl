// Links times what the senders send: vector irradiance at the receivers (paper, Eq. 15).

@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> links: array<vec2u>;
@group(0) @binding(3) var<storage, read> sent: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> values: array<f32>;

var<workgroup> sums: array<array<vec3f, 3>, 64>;

@compute @workgroup_size(64)
fn vectors(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let lane = thread % LANES;
    let k = lanes_row(group, thread);
    let receiver = step_.first + k;
    var red = vec3f(0.0);
    var green = vec3f(0.0);
    var blue = vec3f(0.0);
    if k < step_.count {
        let end = offsets[receiver + 1u] - step_.extra;
        for (var i = offsets[receiver] - step_.extra + lane; i < end; i += LANES) {
            let link = links[i];
            let vector = link_direction(link.y) * (link_amount(link.x) * (1.0 / 511.0));
            let power = sent[link_sender(link.x)];
            red += vector * power.x;
            green += vector * power.y;
            blue += vector * power.z;
        }
    }
    if LANES > 1u {
        sums[thread] = array<vec3f, 3>(red, green, blue);
        for (var reach = LANES / 2u; reach > 0u; reach /= 2u) {
            workgroupBarrier();
            if lane < reach {
                red += sums[thread + reach][0];
                green += sums[thread + reach][1];
                blue += sums[thread + reach][2];
                sums[thread] = array<vec3f, 3>(red, green, blue);
            }
        }
    }
    if k < step_.count && lane == 0u {
        let at = receiver * 9u;
        for (var c = 0u; c < 3u; c++) {
            values[at + c] = red[c];
            values[at + 3u + c] = green[c];
            values[at + 6u + c] = blue[c];
        }
    }
}
