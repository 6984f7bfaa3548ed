//! Steps of coordinates in a file: powers of two, so that rounding is idempotent.

use glam::Vec3;

/// Largest power of two that is at most `size`; `size` is positive.
pub fn power_of_two_under(size: f32) -> f32 {
    f32::from_bits(size.max(f32::MIN_POSITIVE).to_bits() & 0x7f80_0000)
}

/// Rounds each coordinate to the nearest multiple of `step`, a power of two. Never negative zero.
pub fn to_steps(position: Vec3, step: f32) -> Vec3 {
    // With a step too small to change the position, the quotient may overflow.
    let rounded = (position / step).round() * step + Vec3::ZERO;
    if rounded.is_finite() { rounded } else { position }
}

/// Smallest power-of-two step with which a file encodes all coordinates from `low` to `high` as 32-bit numbers.
pub fn least_step(low: Vec3, high: Vec3) -> f32 {
    power_of_two_under(low.abs().max(high.abs()).max_element() * (1.0 / (1u32 << 30) as f32))
}
