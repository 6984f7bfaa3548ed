// The automatic exposure: brings the picture to a middle grey, halfway (as the eye counts) between its
// mean radiance and its geometric mean: bright spots keep their texture, dark rooms can be seen.
//
// One thread: it runs once a scene, and threads that wait for each other take a software adapter a quarter of a second
// to compile.

// Luminance of evenly spread pixels (look.wgsl), four at a time; negative where there is no surface.
@group(0) @binding(0) var<storage, read> looked: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> key: array<f32>;

const MIDDLE_GREY = 0.18;
// Pixels darker than this share of the mean count as that dark: black corners do not blow up the rest.
const DARKEST = 0.02;

@compute @workgroup_size(1)
fn measure() {
    var sum = vec4f(0.0);
    var count = vec4f(0.0);
    for (var k = 0u; k < arrayLength(&looked); k++) {
        sum += max(looked[k], vec4f(0.0));
        count += step(vec4f(0.0), looked[k]);
    }
    let pixels = max(dot(count, vec4f(1.0)), 1.0);
    let mean = dot(sum, vec4f(1.0)) / pixels;
    var logs = vec4f(0.0);
    for (var k = 0u; k < arrayLength(&looked); k++) {
        logs += step(vec4f(0.0), looked[k]) * log2(max(looked[k], vec4f(mean * DARKEST)) + 1e-30);
    }
    let geometric = exp2(dot(logs, vec4f(1.0)) / pixels);
    key[0] = select(1.0, MIDDLE_GREY / sqrt(geometric * mean), mean > 0.0);
}
