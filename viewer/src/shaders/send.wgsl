// What the senders send: their irradiance in the colour of their surfaces.

@group(0) @binding(1) var<storage, read> points: array<Point>;
@group(0) @binding(2) var<storage, read> irradiance: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> sent: array<vec4f>;

@compute @workgroup_size(64)
fn send(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x + id.y * step_.threads;
    if i >= step_.count {
        return;
    }
    sent[i] = vec4f(unpack_rgb9e5(points[i].tint) * irradiance[i].xyz, 0.0);
}
