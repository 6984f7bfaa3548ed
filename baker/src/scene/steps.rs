//! Steps in which a file counts coordinates: powers of two, so that rounding to one changes nothing twice.

use glam::Vec3;

/// The largest power of two that is at most `size`; `size` is positive.
pub fn power_of_two_under(size: f32) -> f32 {
    f32::from_bits(size.max(f32::MIN_POSITIVE).to_bits() & 0x7f80_0000)
}

/// Each coordinate to the nearest multiple of `step`, a power of two. Never negative zero.
pub fn to_steps(position: Vec3, step: f32) -> Vec3 {
    // A step so small, against the position, that rounding changes nothing may overflow.
    let rounded = (position / step).round() * step + Vec3::ZERO;
    if rounded.is_finite() { rounded } else { position }
}

/// The least step, a power of two, in which the file counts all coordinates from `low` to `high` by 32-bit numbers.
pub fn least_step(low: Vec3, high: Vec3) -> f32 {
    power_of_two_under(low.abs().max(high.abs()).max_element() * (1.0 / (1u32 << 30) as f32))
}
