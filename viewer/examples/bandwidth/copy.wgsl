// Copies a buffer, as fast as memory allows: what the passes of a frame are held against.

@group(0) @binding(0) var<storage, read> from_words: array<vec4u>;
@group(0) @binding(1) var<storage, read_write> to_words: array<vec4u>;

@compute @workgroup_size(256)
fn copy(@builtin(global_invocation_id) id: vec3u) {
    to_words[id.x] = from_words[id.x];
}
