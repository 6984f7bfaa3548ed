// The scene's triangles as the camera sees them. Group 0 has the `frame`.

struct Out {
    // The same in all passes: layers of blended surfaces are told apart by their depth.
    @builtin(position) @invariant position: vec4f,
    @location(0) local: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
}

@vertex
fn vertex(
    @location(0) position: vec3f,
    @location(1) normal: vec2f,
    @location(2) uv: vec2f,
    place: Place,
) -> Out {
    let local = placed(place, position);
    let facing = placed_normal(place, octahedral_decode(normal));
    return Out(frame.clip_from_local * vec4f(local, 1.0), local, facing, uv);
}

// Base colour and alpha. Called for all pixels alike: derivatives are taken.
fn mesh_color(uv: vec2f) -> vec4f {
    if frame.unfiltered == 0u {
        return material.base_color * textureSample(base_color_texture, color_sampler, uv);
    }
    return material.base_color * textureSampleLevel(base_color_texture, plain_sampler, uv, 0.0);
}

// Which way a surface faces, unit vectors on the side of the eye.
struct Facing {
    // Of the triangle.
    facet: vec3f,
    // For shading. At the silhouette of a one-sided surface, whose backs are culled, it may point away from the eye.
    normal: vec3f,
}

// Called for all pixels alike: derivatives are taken.
fn mesh_facing(in: Out) -> Facing {
    let to_eye = frame.eye - in.local;
    var facet = normalize(cross(dpdx(in.local), dpdy(in.local)));
    if !(dot(facet, facet) > 0.5) {
        facet = normalize(in.normal);
    }
    facet = select(facet, -facet, dot(facet, to_eye) < 0.0);
    let normal = normalize(in.normal);
    let back = material.double_sided != 0u && dot(normal, to_eye) < 0.0;
    return Facing(facet, select(normal, -normal, back));
}
