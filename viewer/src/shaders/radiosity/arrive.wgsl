// What arrives at the points of a level: the mean of the parents, and the point's own matrix (Lehtinen et al. 2007, 6.4); as
// `GlossyField` of shared/src/gloss.rs. A thread a coefficient.

// By point of the transfer: its number in the file, and its cluster, 255 for none, with the number of its matrix from bit 8 on.
@group(0) @binding(1) var<storage, read> members: array<vec2u>;
// Weights of the matrices, four a word; by cluster the scales of its components.
@group(0) @binding(2) var<storage, read> weights: array<u32>;
@group(0) @binding(3) var<storage, read> weight_scales: array<f32>;
@group(0) @binding(4) var<storage, read> lit: array<vec4f>;
@group(0) @binding(5) var<storage, read> push_offsets: array<u32>;
@group(0) @binding(6) var<storage, read> push_entries: array<u32>;
// By point of the file: its number in the transfer, or NOWHERE.
@group(0) @binding(7) var<storage, read> places: array<u32>;
@group(0) @binding(8) var<storage, read_write> arriving: array<vec4f>;

const NOWHERE = 0xffffffffu;

@compute @workgroup_size(64)
fn arrive(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) thread: u32) {
    let id = (group.y * pass_.groups + group.x) * 64u + thread;
    if id >= pass_.count * HARMONICS {
        return;
    }
    let place = pass_.first + id / HARMONICS;
    let row = id % HARMONICS;
    let member = members[place];
    var sum = vec4f(0.0);
    var total = 0.0;
    for (var at = push_offsets[member.x]; at < push_offsets[member.x + 1u]; at++) {
        let parent = places[entry_point(push_entries[at])];
        if parent != NOWHERE {
            sum += arriving[parent * HARMONICS + row] * entry_weight(push_entries[at]);
            total += entry_weight(push_entries[at]);
        }
    }
    sum /= max(total, 1e-20);
    let cluster = member.y & 255u;
    if cluster != 255u {
        let vector = cluster * (1u + pass_.components);
        sum += lit[vector * HARMONICS + row];
        for (var k = 0u; k < pass_.components; k++) {
            let weight = (member.y >> 8u) * pass_.components + k;
            let scale = weight_scales[cluster * pass_.components + k];
            sum += scale * signed_byte(weights[weight >> 2u], weight) * lit[(vector + 1u + k) * HARMONICS + row];
        }
    }
    arriving[place * HARMONICS + row] = sum;
}
