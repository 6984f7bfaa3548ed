// Vertices in a pose: morph targets, then linear blend skinning (glTF 2.0, 3.7.2.2 and 3.7.3.3). Twin: shared/src/rig/skin.rs.

// MorphDelta: position, normal.
@group(0) @binding(2) var<storage, read> deltas: array<f32>;
// Rows of the matrices from mesh space to local space.
@group(0) @binding(3) var<storage, read> matrices: array<vec4f>;
@group(0) @binding(4) var<storage, read> weights: array<f32>;
@group(0) @binding(5) var<storage, read_write> vertices: array<u32>;

const DELTA_FLOATS = 6u;

fn delta(at: u32) -> vec3f {
    return vec3f(deltas[at], deltas[at + 1u], deltas[at + 2u]);
}

@compute @workgroup_size(64)
fn skin(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + 64u * groups.x * id.y;
    if i >= rig.count {
        return;
    }
    let at = BIND_WORDS * (rig.first + i);
    var position = bitcast<vec3f>(vec3u(binds[at + 1u], binds[at + 2u], binds[at + 3u]));
    var normal = unpack_normal(binds[at + 4u]);
    for (var target_number = 0u; target_number < rig.targets; target_number++) {
        let weight = weights[rig.first_weight + target_number];
        if weight != 0.0 {
            let record = DELTA_FLOATS * (rig.first_delta + target_number * rig.count + i);
            position += weight * delta(record);
            normal += weight * delta(record + 3u);
        }
    }
    var rows = array<vec4f, 3>();
    for (var j = 0u; j < 4u; j++) {
        let half = 16u * (j & 1u);
        let share = f32((binds[at + 7u + j / 2u] >> half) & 0xffffu) / 65535.0;
        let row = 3u * (rig.first_matrix + ((binds[at + 5u + j / 2u] >> half) & 0xffffu));
        for (var r = 0u; r < 3u; r++) {
            rows[r] += share * matrices[row + r];
        }
    }
    let from = vec4f(position, 1.0);
    let local = vec3f(dot(rows[0], from), dot(rows[1], from), dot(rows[2], from));
    // The inverse transpose up to a positive factor: columns of cofactors are crosses of rows.
    let x = cross(rows[1].xyz, rows[2].xyz);
    let y = cross(rows[2].xyz, rows[0].xyz);
    let z = cross(rows[0].xyz, rows[1].xyz);
    let mirrored = select(1.0, -1.0, dot(rows[0].xyz, x) < 0.0);
    let across = mirrored * vec3f(dot(x, normal), dot(y, normal), dot(z, normal));
    let length = length(across);
    let facing = select(vec3f(0.0, 1.0, 0.0), across / length, length > 0.0);
    let to = VERTEX_WORDS * binds[at];
    vertices[to] = bitcast<u32>(local.x);
    vertices[to + 1u] = bitcast<u32>(local.y);
    vertices[to + 2u] = bitcast<u32>(local.z);
    vertices[to + 3u] = pack_normal(facing);
}
