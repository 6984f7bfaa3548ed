// Later bounces at the points of the coarse levels: their irradiance after one bounce, which lies in `display`,
// and all further ones between them. Added to their direct light.

@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> links: array<vec2u>;
@group(0) @binding(3) var<storage, read> display: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> bounced: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> irradiance: array<vec4f>;

var<workgroup> sums: array<vec3f, 64>;

@compute @workgroup_size(64)
fn bounce(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let lane = thread % LANES;
    let k = lanes_row(group, thread);
    let receiver = step_.first + k;
    var sum = vec3f(0.0);
    if k < step_.count {
        let end = offsets[receiver + 1u];
        for (var i = offsets[receiver] + lane; i < end; i += LANES) {
            sum += unpack_rgb9e5(links[i].y) * display[links[i].x].xyz;
        }
    }
    if LANES > 1u {
        sums[thread] = sum;
        for (var reach = LANES / 2u; reach > 0u; reach /= 2u) {
            workgroupBarrier();
            if lane < reach {
                sum += sums[thread + reach];
                sums[thread] = sum;
            }
        }
    }
    if k < step_.count && lane == 0u {
        let all = vec4f(display[receiver].xyz + sum, 0.0);
        bounced[receiver] = all;
        irradiance[receiver] += all;
    }
}
