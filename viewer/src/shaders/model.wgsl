// Where a model's triangles stand.

// Rows of the matrix that takes their space to local space.
struct Place {
    @location(3) x: vec4f,
    @location(4) y: vec4f,
    @location(5) z: vec4f,
}

fn placed(place: Place, position: vec3f) -> vec3f {
    let p = vec4f(position, 1.0);
    return vec3f(dot(place.x, p), dot(place.y, p), dot(place.z, p));
}

// A unit vector across a surface: by the cofactors, as areas are.
fn placed_normal(place: Place, normal: vec3f) -> vec3f {
    let x = cross(place.y.xyz, place.z.xyz);
    let y = cross(place.z.xyz, place.x.xyz);
    let z = cross(place.x.xyz, place.y.xyz);
    return normalize(vec3f(dot(x, normal), dot(y, normal), dot(z, normal)));
}
