// What light from a direction says of light across a normal, for tilts (tilt.wgsl).

// Least cosine by which light along a normal tells of light across it.
const LEAST_COSINE = 0.2;

// Light that arrives from a direction across the normal, for each unit along it.
fn tilt_across(direction: vec3f, normal: vec3f) -> vec3f {
    let cosine = dot(direction, normal);
    return (direction - normal * cosine) / max(cosine, LEAST_COSINE);
}
