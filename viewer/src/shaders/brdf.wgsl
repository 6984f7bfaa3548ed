// What share of the light from one direction goes to the eye: glTF 2.0, appendix B, with the light that a rough
// surface scatters more than once given back (Fdez-Aguera 2019), so that a white metal loses none. radiosity/brdf_coated.wgsl
// is the same for materials with more properties.

struct MaterialRecord {
    // Linear RGB radiance that the surface sends out by itself.
    emission: vec3f,
    // Strength of the highlights of what is not metal.
    specular: f32,
    metallic: f32,
    roughness: f32,
    // 1 where the picture shows the albedo as it is.
    unlit: f32,
    pad: f32,
}

// Per steradian, RGB, without the cosine. `normal`, `to_light` and `to_eye` are unit vectors; `solid`: lobe.wgsl.
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
    let head_on = mix(vec3f(0.04 * look.specular), albedo, look.metallic);
    let grazing = mix(look.specular, 1.0, look.metallic);
    let fresnel = head_on + (vec3f(grazing) - head_on) * pow(1.0 - vh, 5.0);
    let again = 1.0 + head_on * (1.0 / (1.0 - brdf_lost(roughness, nv)) - 1.0);
    // What the highlights do not take: for the eye's direction, which keeps energy where glTF's mix by the angle to
    // the light makes a fifth too much.
    let kept = saturate(1.0 - look.specular * dot(vec2f(0.04, 1.0), brdf_varnish(roughness, nv)));
    return albedo * ((1.0 - look.metallic) * kept / PI) + fresnel * again * lobe(roughness, nh, nl, nv, solid);
}
