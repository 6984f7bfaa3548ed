// Microfacets, for brdf.wgsl and brdf_coated.wgsl: how much a rough surface reflects, all in all and from one direction.

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

// Share of all light that a varnish reflects to an eye at this cosine: what its reflectances head on and at a grazing
// angle are multiplied with (Karis 2014, Physically Based Shading on Mobile).
fn brdf_varnish(roughness: f32, cosine: f32) -> vec2f {
    let r = roughness * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
    let a = min(r.x * r.x, exp2(-9.28 * cosine)) * r.x + r.y;
    return vec2f(r.z - 1.04 * a, 1.04 * a + r.w);
}

// Reflectance but for Fresnel's factor, per steradian, without the cosine; n, l, v, h are the normal, the ways to the light
// and to the eye, and the one in the middle. Of a light with a surface, `solid` is the projected solid angle: a highlight is
// no brighter than the light's mirror image, and as a lobe of normal distribution over a disk, is that bright in a share
// 1 - exp(-x) where a point light's highlight would be x times as bright.
fn lobe(roughness: f32, nh: f32, nl: f32, nv: f32, solid: f32) -> f32 {
    let alpha = roughness * roughness;
    let a2 = alpha * alpha;
    let spread = nh * nh * (a2 - 1.0) + 1.0;
    let density = a2 / (PI * spread * spread);
    let masking = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2));
    let sharp = density * masking;
    if solid > 0.0 {
        return (1.0 - exp(-sharp * solid)) / solid;
    }
    return sharp;
}
