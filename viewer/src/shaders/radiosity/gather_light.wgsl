// Gather: irradiance of receivers as the mean over rays of the light that is sent towards them (Schäfer et al. 2011, 4.1);
// as shared/src/radiosity/gather.rs and levels.rs. LANES threads share a receiver.

override LANES = 64u;

// Irradiance of each point, and its state.
@group(0) @binding(8) var<storage, read_write> values: array<vec4f>;

const LIFT = 0.02;

// Sum of light, and of its squares.
var<workgroup> sums: array<vec4f, 64>;

// Light that the nearest surface sends back along a ray, times π.
fn sent_back(origin: vec3f, direction: vec3f, seed: u32) -> vec3f {
    let hit = bvh_nearest(pass_.top, origin, direction, seed);
    if hit.triangle == BVH_NONE {
        return vec3f(0.0);
    }
    let triangle = 3u * hit.triangle;
    let row = 8u * hit.model;
    // The transposed inverse of the matrix to local space.
    let front = cross(triangles[triangle + 1u].xyz, triangles[triangle + 2u].xyz);
    let across = normalize(models[row].xyz * front.x + models[row + 1u].xyz * front.y + models[row + 2u].xyz * front.z);
    let back = dot(across, direction) > 0.0;
    if back && (bitcast<u32>(triangles[triangle + 1u].w) & 1u) == 0u {
        return vec3f(0.0);
    }
    let place = Sender(
        origin + hit.distance * direction,
        select(across, -across, back),
        bitcast<u32>(triangles[triangle].w),
        row + 3u,
    );
    return sent_light(place, pass_.sender_level, pass_.levels, pass_.exact != 0u);
}

fn brightness_of(light: vec3f) -> f32 {
    return (light.x + light.y + light.z) / 3.0;
}

// What was gathered, with the part of its difference from the parents that stands out of its noise, and the point's new state.
fn judged(gathered: vec3f, variance: f32, before: vec4f) -> vec4f {
    if before.w < 0.0 {
        return vec4f(gathered, REFINED);
    }
    let difference = gathered - before.xyz;
    let square = dot(difference, difference) / 3.0;
    let noise = pass_.significance * pass_.significance * variance;
    let value = before.xyz + difference * select(0.0, 1.0 - noise / square, square > noise);
    let own = brightness_of(value);
    let coarse = brightness_of(before.xyz);
    return vec4f(value, select(0.0, REFINED, abs(own - coarse) > pass_.epsilon * max(max(own, coarse), before.w)));
}

@compute @workgroup_size(64)
fn gather_light(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let k = (group.y * pass_.groups + group.x) * (64u / LANES) + thread / LANES;
    let receiver = pass_.first + min(k, pass_.count - 1u);
    let lane = thread % LANES;
    let before = values[receiver];
    let p = points[receiver];
    let normal = unpack_normal(p.normal);
    let origin = point_position(p) + normal * (LIFT * min(p.radius, pass_.finest_radius));
    let shift = hemisphere_shift(receiver, pass_.number);
    var sum = vec4f(0.0);
    // The loop's end says whether the point is gathered for.
    let rays = select(pass_.rays, 0u, before.w == 0.0 || k >= pass_.count);
    for (var ray = lane; ray < rays; ray += LANES) {
        let direction = hemisphere_direction(hemisphere_square(ray, pass_.rays, shift), normal);
        let light = sent_back(origin, direction, hash(receiver ^ hash(ray ^ hash(pass_.number))));
        let bright = brightness_of(light);
        sum += vec4f(light, bright * bright);
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
    if lane == 0u && rays > 0u {
        sum /= f32(pass_.rays);
        let bright = brightness_of(sum.xyz);
        values[receiver] = judged(sum.xyz, max(sum.w - bright * bright, 0.0) / f32(pass_.rays), before);
    }
}
