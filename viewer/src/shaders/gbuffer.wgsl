// What the camera sees of all that is not blended: albedo, normals, material; the depth buffer holds the position. Backs of
// one-sided surfaces are culled before.

@group(0) @binding(0) var<uniform> frame: Frame;

struct Targets {
    // Albedo; alpha 1.
    @location(0) albedo: vec4f,
    // Shading normal, flipped to the viewer on two-sided surfaces (snorm16x2); flat normal
    // (snorm8x2, low half) and material (high half); what the textures of detail say, kept in the wide format only.
    @location(1) surface: vec4u,
}

@fragment
fn fragment(in: Out) -> Targets {
    // Derivatives and filtered samples before any discard.
    let color = mesh_color(in.uv).rgb;
    let facing = mesh_facing(in);
    var seen = vec2u(0u);
    if material.wide != 0u && frame.unfiltered == 0u {
        seen = detail_pack(detail(facing.normal, in.local, in.uv));
    }
    if !covered(in.uv, in.position.xy, true) {
        discard;
    }
    let facet = pack4x8snorm(vec4f(octahedral_encode(facing.facet), 0.0, 0.0));
    let surface = vec4u(pack_normal(facing.normal), facet | (material.index << 16u), seen);
    return Targets(vec4f(color, 1.0), surface);
}
