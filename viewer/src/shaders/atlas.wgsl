// Where splats are summed: one texture with the picture in full size, of which only the pixels with slots of their own
// are drawn, and below it the picture of the blocks, a texel each.

// The slot of every pixel that has one of its own, else 0.
@group(0) @binding(6) var<storage, read> slots: array<u32>;
// `brightest_bits` of brightest.wgsl.
@group(0) @binding(7) var<storage, read> brightest: u32;

// Weights are summed in so many parts, for the smallest not to vanish.
const PARTS = 512.0;
// In the w of a slot's light where no level so far covers its place.
const OPEN = -1.0;
const NO_SLOT = 0xffffffffu;

// The pixel that a texel stands for.
fn atlas_pixel(texel: vec2u) -> vec2u {
    let height = u32(frame.height);
    return select(texel, 2u * (texel - vec2u(0u, height)), texel.y >= height);
}

// The slot that a texel is for.
fn atlas_slot(texel: vec2u) -> u32 {
    let size = vec2u(u32(frame.width), u32(frame.height));
    if texel.y < size.y {
        let slot = slots[texel.y * size.x + texel.x];
        return select(slot, NO_SLOT, slot == 0u || texel.x >= size.x);
    }
    let blocks = slots_blocks(frame);
    let block = texel - vec2u(0u, size.y);
    return select(NO_SLOT, block.y * blocks.x + block.x, all(block < blocks));
}

// What splatted irradiance is multiplied with to fit 16-bit floats: a power of two, which rounds nothing, that makes the
// brightest function's 512 to 1024, so that weights of 64 together do not overflow.
fn splat_scale() -> f32 {
    return bitcast<f32>((263u - clamp(brightest >> 23u, 20u, 250u)) << 23u);
}
