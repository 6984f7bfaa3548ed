// Planes at which supports end.

@group(0) @binding(5) var<storage, read> cuts: array<f32>;

fn is_cut(offset: vec3f, packed: u32) -> bool {
    for (var i = 0u; i < (packed & 7u); i++) {
        let k = 3u * ((packed >> 11u) + i);
        if dot(vec3f(cuts[k], cuts[k + 1u], cuts[k + 2u]), offset) > 1.0 {
            return true;
        }
    }
    return false;
}
