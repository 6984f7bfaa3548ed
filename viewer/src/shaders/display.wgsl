// Irradiance along each point's own normal, which is what pictures interpolate: the vector was gathered over the
// normal's hemisphere, and says too little about others.

@group(0) @binding(1) var<storage, read> points: array<Point>;
@group(0) @binding(2) var<storage, read> values: array<f32>;
@group(0) @binding(3) var<storage, read_write> display: array<vec4f>;

@compute @workgroup_size(64)
fn display_values(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x + id.y * step_.threads;
    if i >= step_.count {
        return;
    }
    let normal = unpack_normal(points[i].normal);
    let irradiance = value_irradiance(i, normal);
    var tilt = 0.0;
    if step_.tilts != 0u {
        let flow = value(i, 0u) + value(i, 1u) + value(i, 2u);
        let along = dot(flow, normal);
        tilt = tilt_pack(select(vec3f(0.0), flow / along - normal, along > 1e-20));
    }
    display[i] = vec4f(irradiance, tilt);
}
