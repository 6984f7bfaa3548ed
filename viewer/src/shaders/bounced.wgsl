// Bounced light of a pixel from the slots around it. `light` and `slots`: of the module.

// Irradiance that has bounced at least once, RGB, and its tilt, where it is asked for.
fn bounced_irradiance(pixel: vec2u, tilts: bool) -> mat2x3f {
    let slot = slots[pixel.y * u32(frame.width) + pixel.x];
    if slot != 0u {
        return mat2x3f(light[slot].rgb, tilt_unpack(light[slot].w));
    }
    let blocks = slots_blocks(frame);
    let low = pixel / 2u;
    let high = min((pixel + 1u) / 2u, blocks - 1u);
    let a = light[low.y * blocks.x + low.x];
    let b = light[low.y * blocks.x + high.x];
    let c = light[high.y * blocks.x + low.x];
    let d = light[high.y * blocks.x + high.x];
    var tilt = vec3f(0.0);
    if tilts {
        tilt = 0.25 * (tilt_unpack(a.w) + tilt_unpack(b.w) + tilt_unpack(c.w) + tilt_unpack(d.w));
    }
    return mat2x3f(0.25 * (a.rgb + b.rgb + (c.rgb + d.rgb)), tilt);
}
