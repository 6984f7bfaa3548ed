// Mean irradiance of the coarsest level, always added up in the same order.

@group(0) @binding(1) var<storage, read> values: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> means: array<f32>;

@compute @workgroup_size(1)
fn bounce_mean() {
    var sum = 0.0;
    for (var i = 0u; i < pass_.count; i++) {
        let e = values[pass_.first + i];
        sum += (e.x + e.y + e.z) / 3.0;
    }
    means[pass_.bounce] = sum / f32(max(pass_.count, 1u));
}
