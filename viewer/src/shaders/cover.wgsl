// The basis functions at a place: with what weight each covers it.

@group(0) @binding(4) var<storage, read> points: array<Point>;

// The weight of function j; negative where the place is outside its sphere, so that no kernel was evaluated.
fn cover(j: u32, position: vec3f, normal: vec3f) -> f32 {
    let offset = position - vec3f(points[j].x, points[j].y, points[j].z);
    let radius = points[j].radius;
    if dot(offset, offset) >= radius * radius {
        return -1.0;
    }
    let w = weight(offset, normal, unpack_normal(points[j].normal), radius);
    if w <= 0.0 || is_cut(offset, points[j].cuts) {
        return 0.0;
    }
    return w;
}
