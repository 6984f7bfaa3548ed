// How a surface's bounced light changes with a small turn of its normal n to n': E(n') = E(n) (n·n' + tilt·n'), as of
// vector irradiance. A tilt is packed in 24 bits of a float that is a whole number, 8 bits a component.

const STEEPEST = 2.0;

fn tilt_pack(tilt: vec3f) -> f32 {
    let steps = vec3u(round(clamp(tilt / STEEPEST, vec3f(-1.0), vec3f(1.0)) * 127.0) + 128.0);
    return f32(steps.x | (steps.y << 8u) | (steps.z << 16u));
}

fn tilt_unpack(whole: f32) -> vec3f {
    let bits = u32(whole);
    let steps = vec3f(vec3u(bits & 255u, (bits >> 8u) & 255u, (bits >> 16u) & 255u));
    return (steps - 128.0) * (STEEPEST / 127.0);
}

// The mean of tilts, from their weighted sum and the sum of the weights.
fn tilt_mean(sum: vec4f) -> f32 {
    return tilt_pack(sum.xyz / max(sum.w, 1e-20));
}

// What light weighs when tilts are averaged.
fn tilt_weight(irradiance: vec3f) -> f32 {
    return max(irradiance.x + irradiance.y + irradiance.z, 0.0);
}
