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
    var count = 0.0;
    for (var sample = 0u; sample < SAMPLES; sample++) {
        if ((p.cuts >> (3u + sample)) & 1u) != 0u {
            let place = position + footprint_offset(sample, normal, p.radius);
            sum += direct_irradiance(place, normal, normal, step_.extra, 0, LIFT * p.radius);
            count += 1.0;
        }
    }
    if count == 0.0 {
        sum = direct_irradiance(position, normal, normal, step_.extra, 0, 0.0);
        count = 1.0;
    }
    irradiance[i] = vec4f(sum / count, 0.0);
}
