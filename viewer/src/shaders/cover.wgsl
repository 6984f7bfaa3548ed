// The basis functions at a place: with what weight each covers it.

@group(0) @binding(4) var<storage, read> points: array<Point>;
@group(0) @binding(5) var<storage, read> cuts: array<f32>;
@group(0) @binding(6) var<storage, read> lookup: array<u32>;

// A level whose weights sum to no more than this does not cover a place.
const LEAST_TOTAL = 1e-6;

fn is_cut(offset: vec3f, packed: u32) -> bool {
    for (var i = 0u; i < (packed & 7u); i++) {
        let k = 3u * ((packed >> 11u) + i);
        if dot(vec3f(cuts[k], cuts[k + 1u], cuts[k + 2u]), offset) > 1.0 {
            return true;
        }
    }
    return false;
}

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
