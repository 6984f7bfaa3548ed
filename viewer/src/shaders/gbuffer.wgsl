// What the camera sees: albedo, normals, material; the depth buffer holds the position.

@group(0) @binding(0) var<uniform> frame: Frame;

struct Out {
    @builtin(position) position: vec4f,
    @location(0) local: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
}

@vertex
fn vertex(
    @location(0) position: vec3f,
    @location(1) normal: vec2f,
    @location(2) uv: vec2f,
) -> Out {
    return Out(frame.clip_from_local * vec4f(position, 1.0), position, octahedral_decode(normal), uv);
}

struct Targets {
    // Albedo; alpha 1 where the surface reflects, 0 on the back of a one-sided surface.
    @location(0) albedo: vec4f,
    // Shading normal, flipped to the viewer on two-sided surfaces (snorm16x2); flat normal
    // (snorm8x2, low half) and material (high half).
    @location(1) surface: vec2u,
}

@fragment
fn fragment(in: Out) -> Targets {
    // Derivatives and filtered samples before any discard.
    var color = material.base_color.rgb;
    if frame.unfiltered == 0u {
        color *= textureSample(base_color_texture, color_sampler, in.uv).rgb;
    } else {
        color *= textureSampleLevel(base_color_texture, plain_sampler, in.uv, 0.0).rgb;
    }
    let to_eye = frame.eye - in.local;
    var flat_normal = normalize(cross(dpdx(in.local), dpdy(in.local)));
    if !(dot(flat_normal, flat_normal) > 0.5) {
        flat_normal = normalize(in.normal);
    }
    flat_normal = select(flat_normal, -flat_normal, dot(flat_normal, to_eye) < 0.0);
    if !covered(in.uv, in.position.xy, frame.sample) {
        discard;
    }
    var normal = normalize(in.normal);
    var reflects = 1.0;
    if dot(normal, to_eye) < 0.0 {
        if material.double_sided == 0u {
            reflects = 0.0;
        }
        normal = -normal;
    }
    let packed_flat = pack4x8snorm(vec4f(octahedral_encode(flat_normal), 0.0, 0.0));
    return Targets(vec4f(color, reflects), vec2u(pack_normal(normal), packed_flat | (material.index << 16u)));
}
