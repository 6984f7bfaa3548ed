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
    let again = 1.0 + head_on * (1.0 / (1.0 - brdf_lost(roughness, nv)) - 1.0);
    // What the highlights do not take, of all channels alike, so that a coloured highlight does not tint what is below.
    let strongest = max(look.head_on.r, max(look.head_on.g, look.head_on.b));
    let kept = saturate(1.0 - dot(vec2f(strongest, look.specular), brdf_varnish(roughness, nv)));
    let below = albedo * ((1.0 - look.metallic) * kept / PI) + fresnel * again * lobe(roughness, nh, nl, nv, solid);
    if look.clearcoat <= 0.0 {
        return below;
    }
    let smooth_roughness = max(look.clearcoat_roughness, LEAST_ROUGHNESS);
    let taken = look.clearcoat * dot(vec2f(CLEARCOAT, 1.0), brdf_varnish(smooth_roughness, nv));
    let coat = look.clearcoat * mix(CLEARCOAT, 1.0, glancing) * lobe(smooth_roughness, nh, nl, nv, solid);
    return below * saturate(1.0 - taken) + coat;
}
