// Directions of the texels of a cube; as shared/src/cube_map/cube.rs.

// The direction, not of unit length, of a place on a face; coordinates from -1 to 1 on it.
fn cube_toward(face: u32, at: vec2f) -> vec3f {
    switch face {
        case 0u: { return vec3f(1.0, -at.y, -at.x); }
        case 1u: { return vec3f(-1.0, -at.y, at.x); }
        case 2u: { return vec3f(at.x, 1.0, at.y); }
        case 3u: { return vec3f(at.x, -1.0, -at.y); }
        case 4u: { return vec3f(at.x, -at.y, 1.0); }
        default: { return vec3f(-at.x, -at.y, -1.0); }
    }
}

// The place of the middle of a texel on its face.
fn cube_place(texel: vec2u, side: u32) -> vec2f {
    return (vec2f(texel) + 0.5) * (2.0 / f32(side)) - 1.0;
}
