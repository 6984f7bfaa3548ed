// The light that points send, and the sum of unshot light over the bounces; as shared/src/radiosity/solver.rs.

// Albedo of each point, rgb9e5.
@group(0) @binding(1) var<storage, read> albedo: array<u32>;
// Unshot irradiance.
@group(0) @binding(2) var<storage, read> unshot: array<vec4f>;
@group(0) @binding(3) var<storage, read> means: array<f32>;
// Sum of unshot irradiance.
@group(0) @binding(4) var<storage, read_write> sum: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> sent: array<vec4f>;

// Most that a bounce is taken to keep of the one before.
const MOST_KEPT = 0.95;
// Most that two bounces are taken to bring together, as a multiple of the second.
const MOST_PAIR = 16.0;

// What the bounces after this one bring, as a multiple of it: the last two bounces' ratio goes on.
fn further() -> f32 {
    if pass_.bounce == 0u {
        return 0.0;
    }
    let before = means[pass_.bounce - 1u];
    if pass_.bounce > 1u {
        let last = means[pass_.bounce];
        let pair = clamp(last / max(means[pass_.bounce - 2u], 1e-30), 0.0, MOST_KEPT * MOST_KEPT);
        return min(1.0 + before / max(last, 1e-30), MOST_PAIR) * pair / (1.0 - pair);
    }
    let kept = clamp(means[pass_.bounce] / max(before, 1e-30), 0.0, MOST_KEPT);
    return kept / (1.0 - kept);
}

// `factor` 0: the sum begins with the light that is unshot; 1: it is added; 2: with all that will follow. Where `none` is 0
// the unshot light is sent, where it is 1 the sum.
@compute @workgroup_size(64)
fn send_light(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let k = (group.y * pass_.groups + group.x) * 64u + thread;
    if k >= pass_.count {
        return;
    }
    let i = pass_.first + k;
    let light = unshot[i].xyz;
    var total = light;
    if pass_.factor > 0.0 {
        total = sum[i].xyz + light;
    }
    if pass_.factor > 1.0 {
        total += light * further();
    }
    sum[i] = vec4f(total, 0.0);
    sent[i] = vec4f(unpack_rgb9e5(albedo[i]) * select(light, total, pass_.none != 0u), 0.0);
}
