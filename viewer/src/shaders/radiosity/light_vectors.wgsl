// The vectors of the clusters under distant light: what arrives for a weight of 1; as `lit_vector` of shared/src/gloss.rs.

// Entries, four a word, and a scale a vector.
@group(0) @binding(1) var<storage, read> entries: array<u32>;
@group(0) @binding(2) var<storage, read> scales: array<f32>;
// Coefficients of distant radiance, RGB.
@group(0) @binding(3) var<storage, read> sky: array<vec4f, HARMONICS>;
// By vector: coefficients of arriving radiance, RGB, and of visibility.
@group(0) @binding(4) var<storage, read_write> lit: array<vec4f>;

fn entry(i: u32) -> f32 {
    return signed_byte(entries[i >> 2u], i);
}

@compute @workgroup_size(64)
fn light_vectors(@builtin(global_invocation_id) id: vec3u) {
    let vector = id.x / HARMONICS;
    let row = id.x % HARMONICS;
    if vector >= pass_.vectors {
        return;
    }
    let matrix = HARMONICS * HARMONICS;
    let start = vector * (pass_.channels * matrix + HARMONICS);
    var sum = vec3f(0.0);
    if pass_.channels > 0u {
        for (var j = 0u; j < HARMONICS; j++) {
            let at = start + row * HARMONICS + j;
            let red = entry(at);
            var rgb = vec3f(red);
            if pass_.channels == 3u {
                rgb = vec3f(red, entry(at + matrix), entry(at + 2u * matrix));
            }
            sum += rgb * sky[j].rgb;
        }
    }
    let visibility = entry(start + pass_.channels * matrix + row);
    lit[id.x] = scales[vector] * vec4f(sum, visibility);
}
