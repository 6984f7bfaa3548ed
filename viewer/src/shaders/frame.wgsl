// The camera of one picture, in scene-local space.

struct Frame {
    clip_from_local: mat4x4f,
    eye: vec3f,
    // Distance of the near plane; the depth buffer holds near / (distance along forward).
    near: f32,
    // To the right edge and the top edge of the picture, at distance 1.
    right: vec3f,
    width: f32,
    up: vec3f,
    height: f32,
    forward: vec3f,
    // 1 where textures are read without mip levels, for pictures that are averaged from many.
    unfiltered: u32,
    // Reach of openness (openness.wgsl), scene units; 0 without detail.
    open_reach: f32,
}

// The local position seen at a pixel (its centre, y down) with this depth-buffer value.
fn position_at(frame: Frame, pixel: vec2f, depth: f32) -> vec3f {
    let x = pixel.x * 2.0 / frame.width - 1.0;
    let y = 1.0 - pixel.y * 2.0 / frame.height;
    return frame.eye + (frame.forward + x * frame.right + y * frame.up) * (frame.near / depth);
}
