// How much light there is in the scene, whatever is in view: what each thread's share of the senders gets, for the automatic
// exposure (key.wgsl; on the CPU rebounce_shared::exposure).

@group(0) @binding(1) var<storage, read> irradiance: array<vec4f>;
// By thread: the sum of the places' luminances; of these times their logarithms to base 2.
@group(0) @binding(2) var<storage, read_write> levels: array<vec2f>;

@compute @workgroup_size(64)
fn level(@builtin(global_invocation_id) id: vec3u) {
    var sums = vec2f(0.0);
    for (var i = id.x; i < step_.count; i += step_.threads) {
        let light = dot(irradiance[step_.first + i].rgb, vec3f(0.2126, 0.7152, 0.0722));
        if light > 0.0 {
            sums += light * vec2f(1.0, log2(light));
        }
    }
    levels[id.x] = sums;
}
