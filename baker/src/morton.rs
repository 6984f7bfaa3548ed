//! Space-filling curve: near points have near indices.

use glam::Vec3;

/// The Morton code of a point in the box from `low` to `high`: 21 bits an axis.
pub fn code(position: Vec3, low: Vec3, high: Vec3) -> u64 {
    let extent = (high - low).max_element().max(f32::MIN_POSITIVE);
    let cell = ((position - low) / extent * 2_097_151.0).clamp(Vec3::ZERO, Vec3::splat(2_097_151.0));
    spread(cell.x as u64) | spread(cell.y as u64) << 1 | spread(cell.z as u64) << 2
}

/// Inserts two zero bits between neighbouring bits of a 21-bit number.
fn spread(mut x: u64) -> u64 {
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_order_the_corners() {
        let code = |x: f32, y: f32, z: f32| code(Vec3::new(x, y, z), Vec3::ZERO, Vec3::ONE);
        assert_eq!(code(0.0, 0.0, 0.0), 0);
        assert_eq!(code(1.0, 1.0, 1.0), (1 << 63) - 1);
        assert!(code(0.9, 0.1, 0.1) < code(0.1, 0.9, 0.1));
        assert!(code(0.1, 0.9, 0.1) < code(0.1, 0.1, 0.9));
    }
}
