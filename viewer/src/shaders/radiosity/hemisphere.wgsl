// Directions of a gather's rays; as shared/src/radiosity/directions.rs.

fn hemisphere_shift(receiver: u32, number: u32) -> vec2f {
    let first = hash(receiver ^ hash(number));
    return vec2f(hash_unit(first), hash_unit(hash(first)));
}

// Place k of Hammersley's point set in the unit square, shifted.
fn hemisphere_square(k: u32, count: u32, shift: vec2f) -> vec2f {
    return fract(vec2f((f32(k) + 0.5) / f32(count), hash_unit(reverseBits(k))) + shift);
}

fn hemisphere_direction(place: vec2f, normal: vec3f) -> vec3f {
    let sign = select(-1.0, 1.0, normal.z >= 0.0);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let first = vec3f(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    let second = vec3f(b, sign + normal.y * normal.y * a, -normal.y);
    let angle = 6.28318531 * place.y;
    return sqrt(place.x) * (first * cos(angle) + second * sin(angle)) + normal * sqrt(max(1.0 - place.x, 0.0));
}
