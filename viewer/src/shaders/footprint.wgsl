// Where direct light is sampled around a point; as shared/src/footprint.rs.

const SAMPLES = 8u;
const RADIUS = 0.25;
const LIFT = 0.02;

fn footprint_offset(sample: u32, normal: vec3f, support_radius: f32) -> vec3f {
    let sign = select(-1.0, 1.0, normal.z >= 0.0);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let first = vec3f(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    let second = vec3f(b, sign + normal.y * normal.y * a, -normal.y);
    let angle = f32(sample) * 2.3999632;
    let place = RADIUS * sqrt((f32(sample) + 0.5) / f32(SAMPLES)) * vec2f(cos(angle), sin(angle));
    return support_radius * (first * place.x + second * place.y + normal * LIFT);
}
