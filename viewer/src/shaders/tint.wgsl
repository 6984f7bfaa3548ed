// The colour that a light has behind surfaces that let some of it through, as the light sees them; in alpha, the depth of
// the nearest of them.

@group(0) @binding(0) var<uniform> clip_from_local: mat4x4f;
// What is not glass, in twice as many texels.
@group(0) @binding(1) var solid_depth: texture_depth_2d;

struct Out {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn vertex(@location(0) position: vec3f, @location(2) uv: vec2f, place: Place) -> Out {
    return Out(clip_from_local * vec4f(placed(place, position), 1.0), uv);
}

@fragment
fn fragment(in: Out) -> @location(0) vec4f {
    // Blended surfaces hold a share of every 3 x 3 texels: what is hidden in all of them is behind something solid.
    var solid = 1.0;
    let middle = vec2i(in.position.xy) * 2;
    for (var k = 0; k < 9; k++) {
        solid = min(solid, textureLoad(solid_depth, max(middle + vec2i(k % 3, k / 3) - 1, vec2i(0)), 0));
    }
    if in.position.z < solid {
        return vec4f(1.0, 1.0, 1.0, 0.0);
    }
    let color = material.base_color * textureSampleLevel(base_color_texture, plain_sampler, in.uv, 0.0);
    let alpha = cover_of(color.a);
    return vec4f(1.0 - alpha + alpha * passage(color.rgb, in.uv).through, in.position.z);
}
