// Depth of the scene as a light sees it. Cut-out and blended materials discard.

@group(0) @binding(0) var<uniform> clip_from_local: mat4x4f;

struct Out {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn opaque(@location(0) position: vec3f, place: Place) -> @builtin(position) vec4f {
    return clip_from_local * vec4f(placed(place, position), 1.0);
}

@vertex
fn cutout(@location(0) position: vec3f, @location(2) uv: vec2f, place: Place) -> Out {
    return Out(clip_from_local * vec4f(placed(place, position), 1.0), uv);
}

@fragment
fn cut(in: Out, @builtin(front_facing) front: bool) {
    if !covered(in.uv, in.position.xy, front) {
        discard;
    }
}
