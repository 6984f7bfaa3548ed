//! Colours in four bytes: rgb9e5, three 9-bit mantissas (red low) and a shared 5-bit exponent, a GPU format (Vulkan's
//! `E5B9G9R9`). Not negative; mantissa · 2^(E − 24).

use glam::Vec3;

const LARGEST: f32 = 511.0 / 512.0 * 65536.0;

/// Packs a colour; negative channels become zero.
pub fn pack_rgb9e5(colour: Vec3) -> u32 {
    pack_rounded(colour, 1)
}

/// As [`pack_rgb9e5`], with mantissas rounded to multiples of `unit`, a power of two.
pub fn pack_rounded(colour: Vec3, unit: u32) -> u32 {
    let (unit, most) = (unit as f32, (512 - unit) as f32);
    let colour = colour.clamp(Vec3::ZERO, Vec3::splat(LARGEST));
    let largest = colour.max_element();
    if largest <= 0.0 {
        return 0;
    }
    // 2^E is above the largest channel, unless its mantissa rounds up to 512.
    let floor = (largest.to_bits() >> 23) as i32 - 127;
    let mut exponent = (floor.max(-16) + 16).clamp(0, 31);
    let step = |exponent: i32| ((exponent - 24) as f32).exp2();
    if (largest / step(exponent) / unit).round() * unit > most {
        exponent = (exponent + 1).min(31);
    }
    let mantissas = ((colour / step(exponent) / unit).round() * unit).min(Vec3::splat(most));
    let [r, g, b] = mantissas.to_array().map(|m| m as u32);
    r | g << 9 | b << 18 | (exponent as u32) << 27
}

/// The inverse of [`pack_rgb9e5`].
#[inline]
pub fn unpack_rgb9e5(bits: u32) -> Vec3 {
    let step = f32::from_bits(((bits >> 27) + 127 - 24) << 23);
    Vec3::new((bits & 511) as f32, (bits >> 9 & 511) as f32, (bits >> 18 & 511) as f32) * step
}

/// Rec. 709 luminance of linear RGB.
pub fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_keep_nine_bits_of_their_largest_channel() {
        for k in 0..500 {
            let scale = 2f32.powf(-14.0 + 29.0 * k as f32 / 500.0);
            let colour = Vec3::new(0.3, 1.0, 0.004) * scale;
            let back = unpack_rgb9e5(pack_rgb9e5(colour));
            assert!((back - colour).abs().max_element() <= scale / 500.0, "{colour} became {back}");
        }
        assert_eq!(unpack_rgb9e5(pack_rgb9e5(Vec3::ONE)), Vec3::ONE);
        assert_eq!(unpack_rgb9e5(pack_rgb9e5(Vec3::splat(-1.0))), Vec3::ZERO);
        assert!(unpack_rgb9e5(pack_rgb9e5(Vec3::splat(1e9))).x > 65000.0);
    }
}
