// A basis function, as section PNTS stores it: 28 bytes.

struct Point {
    x: f32,
    y: f32,
    z: f32,
    radius: f32,
    normal: u32,
    // Number of its cuts, samples of its direct light from bit 3 on, first cut from bit 11 on.
    cuts: u32,
    // What colour the surface gives to light, rgb9e5.
    tint: u32,
}

fn point_position(p: Point) -> vec3f {
    return vec3f(p.x, p.y, p.z);
}
