// Direct irradiance of glossy patches by bin: that of each lamp by the bin of its way, all else evenly.

// Points of the glossy patches.
@group(0) @binding(1) var<storage, read> point_of: array<u32>;
@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> irradiance: array<vec4f>;
// Directions of the middles of the bins.
@group(0) @binding(4) var<storage, read> ways: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> direct: array<vec4f>;

// The bin whose middle is nearest to a way.
fn nearest_bin(way: vec3f) -> u32 {
    var best = 0u;
    for (var bin = 1u; bin < arrayLength(&ways); bin++) {
        if dot(ways[bin].xyz, way) > dot(ways[best].xyz, way) {
            best = bin;
        }
    }
    return best;
}

@compute @workgroup_size(64)
fn direct_lobes(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let i = number_of(group, thread);
    if i >= points_.count {
        return;
    }
    let p = points[point_of[i]];
    let normal = unpack_normal(p.normal);
    let lift = LIFT * p.radius;
    let position = point_position(p) + lift * normal;
    let bins = arrayLength(&ways);
    let row = i * (bins + 1u);
    for (var bin = 0u; bin <= bins; bin++) {
        direct[row + bin] = vec4f(0.0);
    }
    var rest = irradiance[point_of[i]].xyz;
    for (var k = 0u; k < points_.lights; k++) {
        var light = vec3f(0.0);
        if is_area(lights[k]) {
            light = lit_by_area(lights[k], position, normal);
        } else {
            light = lit(lights[k], position, normal, lift);
        }
        if any(light > vec3f(0.0)) {
            var way = normalize(position - lights[k].position);
            if lights[k].kind == DIRECTIONAL {
                way = lights[k].direction;
            }
            // A point has the mean over its footprint, and no more than that.
            let share = min(light, rest);
            rest -= share;
            direct[row + nearest_bin(way)] += vec4f(share, 0.0);
        }
    }
    direct[row + bins] = vec4f(max(rest, vec3f(0.0)), 0.0);
}
