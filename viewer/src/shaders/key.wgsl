// The automatic exposure: brings the picture to a middle grey, halfway (as the eye counts) between its
// mean radiance and its geometric mean: bright spots keep their texture, dark rooms can be seen. From the exposure that a
// scene begins with it moves only as far as the picture would leave the latitude: a lamp that is turned down
// looks turned down, and neither a sun nor a night leaves the picture without texture. What gets next to nothing of the
// light in the scene, as a closed room beside a lit one, stays dark, whether or not the rest is in view.
//
// One thread: there is little to add up, and threads that wait for each other take a software adapter a quarter of a
// second to compile.

// Luminance of evenly spread pixels (look.wgsl), four at a time; negative where there is no surface.
@group(0) @binding(0) var<storage, read> looked: array<vec4f>;
// What radiance is multiplied with; the same as the scene began with, 0 while that is not known; the most, or 0.
@group(0) @binding(1) var<storage, read_write> key: array<f32>;
// Of shares of the scene's places, two by two: the sum of the luminances of irradiance; of these times their logarithms
// (light_level.wgsl).
@group(0) @binding(2) var<storage, read> levels: array<vec4f>;

const MIDDLE_GREY = 0.18;
// Stops that a picture may be brighter or darker than the scene began with.
const LATITUDE = 1.5;
// Where little of a picture is lit, as through a door, that is what counts: it gets no brighter than so many times the
// middle grey by following.
const BRIGHTEST = 8.0;
// Pixels darker than this share of the mean count as that dark: black corners do not blow up the rest.
const DARKEST = 0.02;
// As in rebounce_shared::exposure: stops between what is lit in the scene and what may become the middle grey; what is lit
// counts as reflecting so much; the irradiance of a surface that reflects all of it is so many times its radiance.
const DEPTH = 7.0;
const REFLECTANCE = 0.5;
const PI = 3.14159265;

// What radiance may be multiplied with at most; 0 where nothing is lit.
fn most() -> f32 {
    var sums = vec4f(0.0);
    for (var k = 0u; k < arrayLength(&levels); k++) {
        sums += levels[k];
    }
    let sum = sums.x + sums.z;
    if sum <= 0.0 {
        return 0.0;
    }
    return MIDDLE_GREY * exp2(DEPTH - (sums.y + sums.w) / sum) * PI / REFLECTANCE;
}

@compute @workgroup_size(1)
fn measure() {
    var sum = vec4f(0.0);
    var squares = 0.0;
    var count = vec4f(0.0);
    for (var k = 0u; k < arrayLength(&looked); k++) {
        let light = max(looked[k], vec4f(0.0));
        sum += light;
        squares += dot(light, light);
        count += step(vec4f(0.0), looked[k]);
    }
    let pixels = max(dot(count, vec4f(1.0)), 1.0);
    let total = dot(sum, vec4f(1.0));
    let mean = total / pixels;
    if mean <= 0.0 {
        key[0] = select(1.0, key[1], key[1] > 0.0);
        return;
    }
    var logs = vec4f(0.0);
    for (var k = 0u; k < arrayLength(&looked); k++) {
        logs += step(vec4f(0.0), looked[k]) * log2(max(looked[k], vec4f(mean * DARKEST)) + 1e-30);
    }
    let geometric = exp2(dot(logs, vec4f(1.0)) / pixels);
    key[2] = most();
    let limit = select(1e38, key[2], key[2] > 0.0);
    let wanted = min(MIDDLE_GREY / sqrt(geometric * mean), limit);
    if key[1] <= 0.0 {
        key[1] = wanted;
    }
    let stops = log2(wanted / key[1]);
    let followed = key[1] * exp2(stops - clamp(stops, -LATITUDE, LATITUDE));
    let bright = BRIGHTEST * MIDDLE_GREY * total / squares;
    key[0] = min(min(followed, max(key[1], bright)), limit);
}
