// The weight function of the basis (Lehtinen et al. 2008, Eq. 8 to 10); as shared/src/kernel.rs.

const SQUASH = 2.0;
const LEAST_COSINE = 0.5;
// A level whose weights sum to no more than this does not cover a place.
const LEAST_TOTAL = 1e-6;

fn falloff(t: f32) -> f32 {
    return select(1.0 + t * t * (2.0 * t - 3.0), 0.0, t >= 1.0);
}

fn squashed_distance_squared(offset: vec3f, normal_j: vec3f) -> f32 {
    let d = offset + SQUASH * dot(offset, normal_j) * normal_j;
    return dot(d, d);
}

fn likeness(cosine: f32) -> f32 {
    let above = max((cosine - LEAST_COSINE) * (1.0 / (1.0 - LEAST_COSINE)), 0.0);
    return above * above;
}

// offset = x - x_j; zero outside the support and for normals 60 degrees or more apart.
fn weight(offset: vec3f, normal: vec3f, normal_j: vec3f, radius_j: f32) -> f32 {
    let cosine = dot(normal, normal_j);
    let distance_squared = squashed_distance_squared(offset, normal_j);
    if cosine <= LEAST_COSINE || distance_squared >= radius_j * radius_j {
        return 0.0;
    }
    return falloff(sqrt(distance_squared) / radius_j) * likeness(cosine);
}
