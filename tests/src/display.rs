//! What the viewer's pictures say about radiance.

use glam::Vec3;

/// Linear radiance from display values: sRGB, 8 bits, and below its shoulder Khronos PBR Neutral.
pub fn linear(rgb: &[u8]) -> Vec3 {
    let display = Vec3::from_slice(&[rgb[0], rgb[1], rgb[2]].map(|c| {
        let c = f32::from(c) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    }));
    let least = display.min_element();
    let before = if least < 0.04 { (least / 6.25).sqrt() } else { least + 0.04 };
    display + (before - least)
}
