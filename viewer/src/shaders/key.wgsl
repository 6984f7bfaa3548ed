// The automatic exposure: brings the picture to a middle grey, halfway (as the eye counts) between its
// mean radiance and its geometric mean: bright spots keep their texture, dark rooms can be seen.

@group(0) @binding(7) var<storage, read_write> key: array<f32>;

const SIDE = 64u;
const THREADS = 256u;
const SAMPLES = SIDE * SIDE / THREADS;
const MIDDLE_GREY = 0.18;
// Pixels darker than this share of the mean count as that dark: black corners do not blow up the rest.
const DARKEST = 0.02;

var<workgroup> partial: array<vec2f, 256>;

// The sum over all threads.
fn total(thread: u32, value: vec2f) -> vec2f {
    workgroupBarrier();
    partial[thread] = value;
    for (var reach = THREADS / 2u; reach > 0u; reach /= 2u) {
        workgroupBarrier();
        if thread < reach {
            partial[thread] += partial[thread + reach];
        }
    }
    workgroupBarrier();
    return partial[0];
}

@compute @workgroup_size(256)
fn measure(@builtin(local_invocation_index) thread: u32) {
    var luminance: array<f32, SAMPLES>;
    var sum = vec2f(0.0);
    for (var k = 0u; k < SAMPLES; k++) {
        let i = thread + k * THREADS;
        let at = (vec2f(f32(i % SIDE), f32(i / SIDE)) + 0.5) / f32(SIDE) * vec2f(frame.width, frame.height);
        let light = radiance(vec2u(at));
        luminance[k] = dot(light.rgb, vec3f(0.2126, 0.7152, 0.0722)) - select(1.0, 0.0, light.a > 0.0) * 1e30;
        if light.a > 0.0 {
            sum += vec2f(luminance[k], 1.0);
        }
    }
    let all = total(thread, sum);
    let mean = all.x / max(all.y, 1.0);
    var logs = vec2f(0.0);
    for (var k = 0u; k < SAMPLES; k++) {
        if luminance[k] >= 0.0 {
            logs += vec2f(log2(max(luminance[k], mean * DARKEST) + 1e-30), 1.0);
        }
    }
    let all_logs = total(thread, logs);
    if thread == 0u {
        let geometric = exp2(all_logs.x / max(all_logs.y, 1.0));
        key[0] = select(1.0, MIDDLE_GREY / sqrt(geometric * mean), mean > 0.0);
    }
}
