// The local pass, K: radiance of the matt patches; as shared/src/antiradiance/solve.rs.

// Linear RGB, and whether it is of a metal, whose radiance goes by bins.
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
    let matt = (1.0 - albedo[i].w) / 3.14159265 * albedo[i].xyz;
    let light = matt * (direct[i].xyz + irradiance[i].xyz);
    radiance[i] = vec4f(light, radiance[i].w);
}
