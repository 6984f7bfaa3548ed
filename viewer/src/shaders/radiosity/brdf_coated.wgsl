// As brdf.wgsl, with the reflectance of what is not metal by material (KHR_materials_ior, KHR_materials_specular), and a
// clear layer over all (KHR_materials_clearcoat).

struct MaterialRecord {
    // Linear RGB radiance that the surface sends out by itself.
    emission: vec3f,
    // Strength of the highlights of what is not metal.
    specular: f32,
    metallic: f32,
    roughness: f32,
    // 1 where the picture shows the albedo as it is.
    unlit: f32,
    // Strength of the clear layer, 0 to 1.
    clearcoat: f32,
    // Reflectance of what is not metal at normal incidence, RGB.
    head_on: vec3f,
    clearcoat_roughness: f32,
}

// Reflectance of a clear layer at normal incidence: that of an index of refraction of 1.5.
const CLEARCOAT = 0.04;

// As brdf_varnish, for smooth surfaces and strong reflectances, too: within 0.02 of what the terms below integrate to (0.03 at
// grazing angles) for a reflectance of 0.04.
fn brdf_shares(roughness: f32, cosine: f32) -> vec2f {
    let glancing = pow(saturate(1.0 - cosine), 5.0) / (1.0 + 2.66 * pow(roughness, 2.67) / (cosine + 0.068));
    return (1.0 - brdf_lost(roughness, cosine)) * vec2f(1.0 - glancing, glancing);
}

// Per steradian, RGB, without the cosine. `normal`, `to_light` and `to_eye` are unit vectors; `solid`: lobe.wgsl.
fn brdf(albedo: vec3f, look: MaterialRecord, normal: vec3f, to_light: vec3f, to_eye: vec3f, solid: f32) -> vec3f {
    if max(look.specular, max(look.metallic, look.clearcoat)) <= 0.0 {
        return albedo / PI;
    }
    let middle = normalize(to_light + to_eye);
    let nl = max(dot(normal, to_light), 1e-4);
    let nv = max(dot(normal, to_eye), 1e-4);
    let nh = saturate(dot(normal, middle));
    let glancing = pow(1.0 - saturate(dot(to_eye, middle)), 5.0);
    let roughness = max(look.roughness, LEAST_ROUGHNESS);
    let head_on = mix(look.head_on, albedo, look.metallic);
    let grazing = mix(look.specular, 1.0, look.metallic);
    let fresnel = head_on + (vec3f(grazing) - head_on) * glancing;
    let scattered_more = 1.0 / (1.0 - brdf_lost(roughness, nv)) - 1.0;
    let again = 1.0 + head_on * scattered_more;
    // What the highlights do not take: that of brdf.wgsl, and what they take beyond a reflectance of 0.04, of all channels
    // alike, so that a coloured highlight does not tint what is below.
    let usual = 0.04 * look.specular;
    let beyond = max(look.head_on.r, max(look.head_on.g, look.head_on.b)) - usual;
    let varnish = dot(vec2f(usual, look.specular), brdf_varnish(roughness, nv));
    let taken = (varnish + beyond * brdf_shares(roughness, nv).x) * (1.0 + beyond * scattered_more);
    let kept = saturate(1.0 - taken);
    let below = albedo * ((1.0 - look.metallic) * kept / PI) + fresnel * again * lobe(roughness, nh, nl, nv, solid);
    if look.clearcoat <= 0.0 {
        return below;
    }
    let smooth_roughness = max(look.clearcoat_roughness, LEAST_ROUGHNESS);
    let coat = look.clearcoat * mix(CLEARCOAT, 1.0, glancing) * lobe(smooth_roughness, nh, nl, nv, solid);
    let coat_taken = look.clearcoat * dot(vec2f(CLEARCOAT, 1.0), brdf_shares(smooth_roughness, nv));
    return below * (1.0 - coat_taken) + coat;
}
