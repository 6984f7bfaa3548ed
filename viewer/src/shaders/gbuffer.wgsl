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
    // (snorm8x2, low half) and material (high half); what the textures of detail say, kept in the wide format only.
    @location(1) surface: vec4u,
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
    var normal = normalize(in.normal);
    var reflects = 1.0;
    if dot(normal, to_eye) < 0.0 {
        if material.double_sided == 0u {
            reflects = 0.0;
        }
        normal = -normal;
    }
    var seen = vec2u(0u);
    if material.wide != 0u && frame.unfiltered == 0u {
        seen = detail_pack(detail(normal, in.local, in.uv));
    }
    if !covered(in.uv, in.position.xy, frame.sample) {
        discard;
    }
    let facet = pack4x8snorm(vec4f(octahedral_encode(flat_normal), 0.0, 0.0));
    let surface = vec4u(pack_normal(normal), facet | (material.index << 16u), seen);
    return Targets(vec4f(color, reflects), surface);
}
