// Coefficients become values: each point adds what its parents' values interpolate to (paper,
// Eq. 4); one level a dispatch, coarse to fine.

@group(0) @binding(1) var<storage, read> offsets: array<u32>;
@group(0) @binding(2) var<storage, read> entries: array<u32>;
@group(0) @binding(3) var<storage, read> points: array<Point>;
@group(0) @binding(4) var<storage, read_write> values: array<f32>;

// As turn in shared/src/link.rs: v turned as the normal `a` turns into `b`.
fn turn(v: vec3f, a: vec3f, b: vec3f) -> vec3f {
    let axis = cross(a, b);
    let across = cross(axis, v);
    let cosine = 1.0 + dot(a, b);
    if cosine < 0.01 {
        return v;
    }
    return v + across + cross(axis, across) / cosine;
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
        for (var c = 0u; c < 3u; c++) {
            sum[c] += turn(value(entry_point(entry), c), parent_normal, normal) * share;
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
