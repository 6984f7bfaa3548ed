// Where direct light is sampled around a point; as shared/src/footprint.rs.

const SAMPLES = 8u;
const LIFT = 0.02;

// 0.25 · √((k + ½) / 8) at the golden angle times k.
const PLACES = array<vec2f, SAMPLES>(
    vec2f(0.06250000, 0.00000000),
    vec2f(-0.07982252, 0.07312397),
    vec2f(0.01221811, -0.13921914),
    vec2f(0.10061113, 0.13122938),
    vec2f(-0.18463378, -0.03265909),
    vec2f(0.17490122, -0.11125787),
    vec2f(-0.05850100, 0.21762096),
    vec2f(-0.11156787, -0.21481704),
);

fn footprint_offset(sample: u32, normal: vec3f, support_radius: f32) -> vec3f {
    let sign = select(-1.0, 1.0, normal.z >= 0.0);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let first = vec3f(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    let second = vec3f(b, sign + normal.y * normal.y * a, -normal.y);
    var places = PLACES;
    let place = places[sample];
    return support_radius * (first * place.x + second * place.y + normal * LIFT);
}
