// The reconstruction group of what a pixel of the G-buffer shows.

fn group_at(pixel: vec2u) -> u32 {
    return group_of(textureLoad(surface_texture, pixel, 0).y >> 16u);
}
