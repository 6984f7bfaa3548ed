// Direct irradiance at the points of the levels at which it is sampled.

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
    let e = direct_irradiance(point_position(p), normal, normal, step_.extra, 0);
    irradiance[i] = vec4f(e, 0.0);
}
