// Samples of the GGX lobe by visible normals; as shared/src/ggx.rs. Directions are in the surface's frame, the normal along z.

const LOBE_SAMPLES = 16u;
const LEAST_ALPHA = 0.01;

struct LobeSample {
    to_light: vec3f,
    // Reflectance times cosine over the density, without Fresnel's factor; 0 below the surface.
    weight: f32,
    density: f32,
    // Cosine between the microfacet and the eye.
    cosine: f32,
}

fn lobe_sample(alpha: f32, to_eye: vec3f, i: u32) -> LobeSample {
    let nv = max(to_eye.z, 1e-4);
    let stretched = normalize(vec3f(alpha * to_eye.xy, nv));
    let angle = 6.28318530717959 * fract(f32(i) * 0.618034);
    let z = (1.0 - (f32(i) + 0.5) / f32(LOBE_SAMPLES)) * (1.0 + stretched.z) - stretched.z;
    let r = sqrt(max(1.0 - z * z, 0.0));
    let standard = vec3f(r * cos(angle), r * sin(angle), z) + stretched;
    let h = normalize(vec3f(alpha * standard.xy, max(standard.z, 0.0)));
    let cosine = dot(to_eye, h);
    let to_light = 2.0 * cosine * h - to_eye;
    let masked = 1.0 + smith_lambda(alpha, nv);
    let a2 = alpha * alpha;
    let spread = h.z * h.z * (a2 - 1.0) + 1.0;
    let density = a2 / (3.14159265 * spread * spread) / (masked * 4.0 * nv);
    let weight = select(0.0, masked / (masked + smith_lambda(alpha, to_light.z)), to_light.z > 0.0);
    return LobeSample(to_light, weight, density, cosine);
}
