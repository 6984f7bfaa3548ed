// Where the file has the visible surfaces of meshes that deform. Drawn over the G-buffer's depth.

@group(0) @binding(0) var<uniform> frame: Frame;

struct Resting {
    // As in mesh.wgsl: the depth is equal.
    @builtin(position) @invariant position: vec4f,
    @location(0) rest: vec3f,
    @location(1) normal: vec3f,
}

@vertex
fn vertex(
    @location(0) position: vec3f,
    @location(6) rest: vec3f,
    @location(7) rest_normal: vec2f,
    place: Place,
) -> Resting {
    let local = placed(place, position);
    return Resting(frame.clip_from_local * vec4f(local, 1.0), rest, octahedral_decode(rest_normal));
}

// Position, and the normal on the side of the eye; its lowest bit says that there is one.
@fragment
fn fragment(in: Resting, @builtin(front_facing) is_front: bool) -> @location(0) vec4u {
    let normal = normalize(in.normal);
    return vec4u(bitcast<vec3u>(in.rest), pack_normal(select(-normal, normal, is_front)) | 1u);
}
