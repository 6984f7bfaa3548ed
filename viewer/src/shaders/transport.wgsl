// A matrix of links times the irradiance of the senders (paper, Eq. 15): LANES threads a row, 64 / LANES rows a workgroup.

override LANES: u32 = 8u;
// Whether rows hold page marks, that is whether there are more than 65536 senders.
override PAGED: bool = false;

struct Row {
    receiver: u32,
    first_link: u32,
}

@group(0) @binding(1) var<storage, read> rows: array<Row>;
@group(0) @binding(2) var<storage, read> links: array<vec2u>;
@group(0) @binding(3) var<storage, read> irradiance: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> values: array<f32>;

var<workgroup> sums: array<array<vec3f, 3>, 64>;

@compute @workgroup_size(64)
fn transport(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    let lane = thread % LANES;
    let k = (group.x + group.y * step_.threads) * (64u / LANES) + thread / LANES;
    let present = k < step_.count;
    var receiver = 0u;
    var red = vec3f(0.0);
    var green = vec3f(0.0);
    var blue = vec3f(0.0);
    if present {
        let row = rows[step_.first + k];
        receiver = row.receiver;
        let begin = row.first_link - step_.extra;
        let end = rows[step_.first + k + 1u].first_link - step_.extra;
        var base = 0u;
        var seen = begin;
        for (var i = begin + lane; i < end; i += LANES) {
            if PAGED {
                // Page marks between this lane's last link and this one.
                for (; seen <= i; seen++) {
                    if links[seen].x == PAGE_MARK {
                        base = link_column(links[seen]) << 16u;
                    }
                }
            }
            let link = links[i];
            if link.x != PAGE_MARK {
                let power = link_magnitude(link) * irradiance[base + link_column(link)].xyz;
                let direction = link_direction(link);
                red += direction * power.x;
                green += direction * power.y;
                blue += direction * power.z;
            }
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
    if present && lane == 0u {
        let at = receiver * 9u;
        for (var c = 0u; c < 3u; c++) {
            values[at + c] = red[c];
            values[at + 3u + c] = green[c];
            values[at + 6u + c] = blue[c];
        }
    }
}
