// What becomes of the light that meets a material which lets some of it through; as shared/src/rbn/extras.rs.

@group(1) @binding(11) var transmission_texture: texture_2d<f32>;
@group(1) @binding(12) var transmission_sampler: sampler;

const TRANSMISSION = 3u;

struct Passage {
    // RGB share that goes straight through.
    through: vec3f,
    // What the base colour is multiplied with to become the share that is reflected.
    reflected: f32,
}

// Where the base colour is `color`; alpha counts besides.
fn passage(color: vec3f, uv: vec2f) -> Passage {
    var metallic = material.metallic;
    if detail_has(METALLIC_ROUGHNESS) {
        let at = detail_uv(METALLIC_ROUGHNESS, uv);
        metallic *= textureSampleLevel(metallic_roughness_texture, metallic_roughness_sampler, at, 0.0).b;
    }
    var straight = (1.0 - metallic) * material.transmission;
    if detail_has(TRANSMISSION) {
        let at = detail_uv(TRANSMISSION, uv);
        straight *= textureSampleLevel(transmission_texture, transmission_sampler, at, 0.0).r;
    }
    let scattered = ((1.0 - metallic) - straight) * material.scattered;
    let through = straight * color * material.transmission_tint + scattered * material.scattered_color;
    return Passage(through, 1.0 - straight - scattered);
}

// Alpha, 1 where it does not matter.
fn cover_of(alpha: f32) -> f32 {
    if material.alpha_mode == MASK {
        return select(0.0, 1.0, alpha >= material.cutoff);
    }
    return select(1.0, saturate(alpha), material.alpha_mode == BLEND);
}
