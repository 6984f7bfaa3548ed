// What share of the light from one direction goes to the eye: glTF 2.0, appendix B, with the light that a rough
// surface scatters more than once given back (Fdez-Aguera 2019), so that a white metal loses none.

// Narrower highlights of a point light than this are single pixels.
const LEAST_ROUGHNESS = 0.08;

// Share of all light that a white mirror of this roughness keeps to itself after one bounce, seen at this cosine: a
// fit, within 0.04, to what the terms below integrate to.
fn brdf_lost(roughness: f32, cosine: f32) -> f32 {
    let c = max(cosine, 0.12);
    let fit = mat3x3f(2.681, -5.72, 3.262, -7.008, 19.746, -11.943, 3.471, -10.715, 6.921);
    let r = vec3f(1.0, roughness, roughness * roughness);
    return clamp(r.z * dot(r, fit * vec3f(1.0, c, c * c)), 0.0, 0.75);
}

// Share of all light that a varnish reflects to an eye at this cosine (Karis 2014, Physically Based Shading on Mobile).
fn brdf_varnish(roughness: f32, cosine: f32) -> f32 {
    let r = roughness * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
    let a = min(r.x * r.x, exp2(-9.28 * cosine)) * r.x + r.y;
    return 0.04 * (r.z - 1.04 * a) + 1.04 * a + r.w;
}

// Per steradian, RGB, without the cosine. `normal`, `to_light` and `to_eye` are unit vectors. Of a light with a surface,
// `solid` is the projected solid angle: a highlight is no brighter than the light's mirror image, and as a lobe of normal
// distribution over a disk, is that bright in a share 1 - exp(-x) where a point light's highlight would be x times as bright.
fn brdf(albedo: vec3f, look: MaterialRecord, normal: vec3f, to_light: vec3f, to_eye: vec3f, solid: f32) -> vec3f {
    if look.specular <= 0.0 && look.metallic <= 0.0 {
        return albedo / PI;
    }
    let middle = normalize(to_light + to_eye);
    let nl = max(dot(normal, to_light), 1e-4);
    let nv = max(dot(normal, to_eye), 1e-4);
    let nh = saturate(dot(normal, middle));
    let vh = saturate(dot(to_eye, middle));
    let roughness = max(look.roughness, LEAST_ROUGHNESS);
    let alpha = roughness * roughness;
    let a2 = alpha * alpha;
    let spread = nh * nh * (a2 - 1.0) + 1.0;
    let density = a2 / (PI * spread * spread);
    let masking = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2));
    let head_on = mix(vec3f(0.04 * look.specular), albedo, look.metallic);
    let grazing = mix(look.specular, 1.0, look.metallic);
    let fresnel = head_on + (vec3f(grazing) - head_on) * pow(1.0 - vh, 5.0);
    let again = 1.0 + head_on * (1.0 / (1.0 - brdf_lost(roughness, nv)) - 1.0);
    // What the highlights do not take: for the eye's direction, which keeps energy where glTF's mix by the angle to
    // the light makes a fifth too much.
    let kept = saturate(1.0 - look.specular * brdf_varnish(roughness, nv));
    var lobe = density * masking;
    if solid > 0.0 {
        lobe = (1.0 - exp(-lobe * solid)) / solid;
    }
    return albedo * ((1.0 - look.metallic) * kept / PI) + fresnel * again * lobe;
}
