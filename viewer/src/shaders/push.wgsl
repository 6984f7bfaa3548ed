// Coefficients become values: each point adds what its parents' values interpolate to (paper,
// Eq. 4); one level a dispatch, coarse to fine.

@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> entries: array<u32>;
@group(0) @binding(3) var<storage, read> points: array<Point>;
@group(0) @binding(4) var<storage, read_write> values: array<f32>;

// As turn in shared/src/link.rs: the rotation that turns the normal `a` into `b`.
fn turning(a: vec3f, b: vec3f) -> mat3x3f {
    let v = cross(a, b);
    let cosine = 1.0 + dot(a, b);
    if cosine < 0.01 {
        return mat3x3f(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    }
    let s = v / cosine;
    return mat3x3f(
        vec3f(1.0 - s.y * v.y - s.z * v.z, v.z + s.x * v.y, s.x * v.z - v.y),
        vec3f(s.x * v.y - v.z, 1.0 - s.x * v.x - s.z * v.z, v.x + s.y * v.z),
        vec3f(v.y + s.x * v.z, s.y * v.z - v.x, 1.0 - s.x * v.x - s.y * v.y),
    );
}

@compute @workgroup_size(64)
fn push(@builtin(global_invocation_id) id: vec3u) {
    let k = id.x + id.y * step_.threads;
    if k >= step_.count {
        return;
    }
    let i = step_.first + k;
    var sum = array<vec3f, 3>();
    var total = 0.0;
    let normal = unpack_normal(points[i].normal);
    for (var at = offsets[i]; at < offsets[i + 1u]; at++) {
        let entry = entries[at];
        let share = entry_weight(entry);
        let parent_normal = unpack_normal(points[entry_point(entry)].normal);
        total += share;
        let turn = turning(parent_normal, normal) * share;
        for (var c = 0u; c < 3u; c++) {
            sum[c] += turn * value(entry_point(entry), c);
        }
    }
    if total <= 0.0 {
        return;
    }
    for (var c = 0u; c < 3u; c++) {
        let pushed = value(i, c) + sum[c] / total;
        let at = i * 9u + c * 3u;
        values[at] = pushed.x;
        values[at + 1u] = pushed.y;
        values[at + 2u] = pushed.z;
    }
}
