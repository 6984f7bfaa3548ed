// Irradiance of glossy patches by bin, direct and bounced; as shared/src/antiradiance/local.rs.

@group(0) @binding(4) var<storage, read> incident: array<vec2u>;
// By glossy patch, direct irradiance by bin, then what comes evenly from all sides.
@group(0) @binding(5) var<storage, read> direct: array<vec4f>;
@group(0) @binding(6) var<storage, read> radiance: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> arriving_by_bin: array<vec4f>;

@compute @workgroup_size(64)
fn arrive_lobes(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let cell = glossy_cell(group, thread);
    if cell.x >= pass_.count {
        return;
    }
    let own = glossy[cell.x].element;
    let row = cell.x * (pass_.bins + 1u);
    let cosines = bin_cosines(dot(elements[own].normal, ways[cell.y].xyz));
    let bounced = arriving(cosines) * unpacked(incident[own * pass_.bins + cell.y]);
    let even = cosines.back / 3.14159265 * direct[row + pass_.bins].xyz;
    let factor = radiance[elements[own].first].w * pass_.solid_angle;
    let light = factor * (bounced + even) + direct[row + cell.y].xyz;
    arriving_by_bin[cell.x * pass_.bins + cell.y] = vec4f(light, 0.0);
}
