// Points of the basis that ride on triangles that deform. Twin: `ridden` in shared/src/rig/skin.rs.

// RigPoint: point, corners, barycentric coordinates of the second and third corner.
@group(0) @binding(2) var<storage, read> riders: array<u32>;
@group(0) @binding(3) var<storage, read> vertices: array<u32>;
@group(0) @binding(4) var<storage, read_write> points: array<u32>;

const RIDER_WORDS = 6u;
const POINT_WORDS = 7u;

fn corner_position(vertex: u32) -> vec3f {
    let at = VERTEX_WORDS * vertex;
    return bitcast<vec3f>(vec3u(vertices[at], vertices[at + 1u], vertices[at + 2u]));
}

fn corner_normal(vertex: u32) -> vec3f {
    return unpack_normal(vertices[VERTEX_WORDS * vertex + 3u]);
}

@compute @workgroup_size(64)
fn ride(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + 64u * groups.x * id.y;
    if i >= rig.count {
        return;
    }
    let at = RIDER_WORDS * i;
    let v = bitcast<f32>(riders[at + 4u]);
    let w = bitcast<f32>(riders[at + 5u]);
    let a = binds[BIND_WORDS * riders[at + 1u]];
    let b = binds[BIND_WORDS * riders[at + 2u]];
    let c = binds[BIND_WORDS * riders[at + 3u]];
    let shares = vec3f(1.0 - v - w, v, w);
    let places = mat3x3f(corner_position(a), corner_position(b), corner_position(c));
    let position = places * shares;
    var normal = mat3x3f(corner_normal(a), corner_normal(b), corner_normal(c)) * shares;
    if !(dot(normal, normal) > 0.0) {
        normal = corner_normal(a);
    }
    // Corners of a point on the back go around the other way.
    let front = cross(places[1] - places[0], places[2] - places[0]);
    if dot(front, normal) < 0.0 {
        normal = -normal;
    }
    let to = POINT_WORDS * riders[at];
    points[to] = bitcast<u32>(position.x);
    points[to + 1u] = bitcast<u32>(position.y);
    points[to + 2u] = bitcast<u32>(position.z);
    points[to + 4u] = pack_normal(normal);
}
