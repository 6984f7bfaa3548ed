// Reflectance and emission of surfaces at places that rays have met: a texel for each hit of a material.

// Size of the targets: RAYS and BATCH of probes/hits.rs.
const WIDTH = 1024u;
const HEIGHT = 64u;

struct Hit {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
}

struct Targets {
    // Reflectance, and 1 where the surface is not cut away.
    @location(0) albedo: vec4f,
    // Share of the material's emission.
    @location(1) emission: vec4f,
}

// A triangle around the middle of the hit's texel.
@vertex
fn vertex(@builtin(vertex_index) corner: u32, @location(0) uv: vec2f, @location(1) texel: u32) -> Hit {
    let middle = vec2f(vec2u(texel % WIDTH, texel / WIDTH)) + 0.5;
    let offset = vec2f(f32(corner & 1u) * 0.8 - 0.4, f32(corner >> 1u) * 0.8 - 0.3);
    let place = (middle + offset) / vec2f(vec2u(WIDTH, HEIGHT));
    return Hit(vec4f(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y, 0.0, 1.0), uv);
}

@fragment
fn fragment(in: Hit) -> Targets {
    let color = material.base_color.rgb * textureSampleLevel(base_color_texture, plain_sampler, in.uv, 0.0).rgb;
    var emission = vec3f(1.0);
    if detail_has(EMISSION) {
        emission = textureSampleLevel(emission_texture, emission_sampler, detail_uv(EMISSION, in.uv), 0.0).rgb;
    }
    return Targets(vec4f(color, select(0.0, 1.0, covered(in.uv, in.position.xy, true))), vec4f(emission, 1.0));
}
