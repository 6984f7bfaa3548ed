// A basis function, as section PNTS stores it: 24 bytes.

struct Point {
    x: f32,
    y: f32,
    z: f32,
    radius: f32,
    normal: u32,
    // Eight times the index of its first cut, plus their number.
    cuts: u32,
}

fn point_position(p: Point) -> vec3f {
    return vec3f(p.x, p.y, p.z);
}
