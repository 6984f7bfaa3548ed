// Opaque surfaces of files without glossy transfer.

fn shaded(surface: Surface, albedo: vec3f, position: vec3f, bounced: mat2x3f, pixel: vec2u) -> vec3f {
    return reflected(surface, albedo, position, bounced, true);
}
