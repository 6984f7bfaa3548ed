// The brightest component of any function's irradiance, a float that is not negative: those compare as
// their bits. For atlas.wgsl.

@group(0) @binding(0) var<storage, read> display: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> brightest_bits: atomic<u32>;

// All threads of the one dispatch.
const THREADS = 4096u;

@compute @workgroup_size(64)
fn brightest(@builtin(global_invocation_id) id: vec3u) {
    var most = 0.0;
    for (var i = id.x; i < arrayLength(&display); i += THREADS) {
        most = max(most, max(display[i].x, max(display[i].y, display[i].z)));
    }
    atomicMax(&brightest_bits, bitcast<u32>(most));
}
