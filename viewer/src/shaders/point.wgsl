// A basis function, as section PNTS stores it: 20 bytes.

struct Point {
    x: f32,
    y: f32,
    z: f32,
    radius: f32,
    normal: u32,
}

fn point_position(p: Point) -> vec3f {
    return vec3f(p.x, p.y, p.z);
}
