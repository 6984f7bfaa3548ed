// Direct irradiance at the points of the levels at which it is sampled: the mean over a point's
// footprint, without the samples that do not belong to its surface.

@group(0) @binding(1) var<storage, read> points: array<Point>;
@group(0) @binding(2) var<storage, read_write> irradiance: array<vec4f>;

@compute @workgroup_size(64)
fn direct(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x + id.y * step_.threads;
    if i >= step_.count {
        return;
    }
    let p = points[i];
    let normal = unpack_normal(p.normal);
    let position = point_position(p);
    var sum = vec3f(0.0);
    let samples = (p.cuts >> 3u) & 0xffu;
    for (var l = 0u; l < step_.extra; l++) {
        // The footprint's samples lie within 0.27 radii.
        if !may_reach(lights[l], position, normal, 0.27 * p.radius) {
            continue;
        }
        if samples == 0u {
            sum += lit(lights[l], position, normal, normal, 0, 0.0).irradiance;
            continue;
        }
        for (var sample = 0u; sample < SAMPLES; sample++) {
            if ((samples >> sample) & 1u) != 0u {
                let place = position + footprint_offset(sample, normal, p.radius);
                sum += lit(lights[l], place, normal, normal, 0, LIFT * p.radius).irradiance;
            }
        }
    }
    irradiance[i] = vec4f(sum / f32(max(countOneBits(samples), 1u)), 0.0);
}
