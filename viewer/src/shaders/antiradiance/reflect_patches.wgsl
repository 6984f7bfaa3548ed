// The local pass, K: radiance of the patches; as shared/src/antiradiance/solve.rs.

@group(0) @binding(3) var<storage, read> albedo: array<vec4f>;
@group(0) @binding(4) var<storage, read> direct: array<vec4f>;
// Bounced irradiance.
@group(0) @binding(5) var<storage, read> irradiance: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> radiance: array<vec4f>;

@compute @workgroup_size(64)
fn reflect_patches(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let i = (group.y * pass_.groups + group.x) * 64u + thread;
    if i >= pass_.count {
        return;
    }
    let light = albedo[i].xyz / 3.14159265 * (direct[i].xyz + irradiance[i].xyz);
    radiance[i] = vec4f(light, radiance[i].w);
}
