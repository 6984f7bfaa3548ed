// Light of the lightmap on the visible surfaces: the layers of its texture times the strengths of the lights. Drawn over the
// G-buffer's depth. Twin: shared/src/lightmap.rs.

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(0) var layers: texture_2d_array<f32>;
@group(1) @binding(1) var layer_sampler: sampler;
// By layer: RGB strength of its light, times the layer's scale.
@group(1) @binding(2) var<storage, read> strengths: array<vec4f>;

// Steps of coordinates in a texel: STEPS of shared/src/rbn/lightmap.rs.
const TEXEL_STEPS = 16.0;
// Coordinates of vertices without a chart.
const NO_CHART = 65535u;

struct Charted {
    // As in mesh.wgsl: the depth is equal.
    @builtin(position) @invariant position: vec4f,
    @location(0) local: vec3f,
    @location(1) normal: vec3f,
    @location(2) texels: vec2f,
    // On fronts and on backs.
    @location(3) @interpolate(flat) offsets: vec4u,
    @location(4) @interpolate(flat) has_chart: u32,
}

@vertex
fn vertex(
    @location(0) position: vec3f,
    @location(1) normal: vec2f,
    @location(6) coordinates: vec2u,
    @location(7) offsets: vec4u,
    place: Place,
) -> Charted {
    let local = placed(place, position);
    let facing = placed_normal(place, octahedral_decode(normal));
    let texels = vec2f(coordinates) / TEXEL_STEPS;
    let has_chart = select(0u, 1u, coordinates.x != NO_CHART);
    return Charted(frame.clip_from_local * vec4f(local, 1.0), local, facing, texels, offsets, has_chart);
}

@fragment
fn fragment(in: Charted) -> @location(0) vec4f {
    if in.has_chart == 0u {
        discard;
    }
    let is_back = dot(in.normal, frame.eye - in.local) < 0.0;
    let offset = select(in.offsets.xy, in.offsets.zw, is_back);
    let at = (in.texels + vec2f(offset)) / vec2f(textureDimensions(layers));
    var sum = vec3f(0.0);
    for (var layer = 0u; layer < textureNumLayers(layers); layer++) {
        sum += strengths[layer].rgb * textureSampleLevel(layers, layer_sampler, at, layer, 0.0).rgb;
    }
    return vec4f(sum, 1.0);
}
