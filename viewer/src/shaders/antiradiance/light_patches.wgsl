// Direct irradiance of the patches: that of their points.

@group(0) @binding(1) var<storage, read> point_of: array<u32>;
@group(0) @binding(2) var<storage, read> irradiance: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> direct: array<vec4f>;

@compute @workgroup_size(64)
fn light_patches(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let i = number_of(group, thread);
    if i < points_.count {
        direct[i] = vec4f(irradiance[point_of[i]].xyz, 0.0);
    }
}
