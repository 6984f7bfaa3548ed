//! Tone mapping: from exposed linear RGB to displayable linear RGB, as composite.wgsl.

use glam::{Mat3, Vec3};

/// Khronos PBR Neutral: keeps colours below the shoulder unchanged.
pub fn neutral(mut color: Vec3) -> Vec3 {
    const START: f32 = 0.8 - 0.04;
    const DESATURATION: f32 = 0.15;
    let least = color.min_element().max(0.0);
    color -= if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let peak = color.max_element();
    if peak < START {
        return color.max(Vec3::ZERO);
    }
    let d = 1.0 - START;
    let new_peak = 1.0 - d * d / (peak + d - START);
    color *= new_peak / peak;
    let g = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    color.lerp(Vec3::splat(new_peak), g).max(Vec3::ZERO)
}

/// Start and extent of AgX's logarithm, stops.
const AGX_STOPS: [f32; 2] = [-12.473_93, 16.5];

/// AgX (Troy Sobotka), in the form of Benjamin Wrensch: softer, bright colours fade to white.
pub fn agx(color: Vec3) -> Vec3 {
    let inset = Mat3::from_cols_array(&[
        0.842_479_06,
        0.042_328_242,
        0.042_375_655,
        0.078_433_6,
        0.878_468_64,
        0.078_433_6,
        0.079_223_745,
        0.079_166_13,
        0.879_143,
    ]);
    let outset = Mat3::from_cols_array(&[
        1.196_879,
        -0.052_896_852,
        -0.052_971_635,
        -0.098_020_88,
        1.151_903_1,
        -0.098_043_45,
        -0.099_029_74,
        -0.098_961_18,
        1.151_073_7,
    ]);
    let stops = (inset * color).max(Vec3::splat(1e-10)).map(f32::log2);
    let x = ((stops - AGX_STOPS[0]) / AGX_STOPS[1]).clamp(Vec3::ZERO, Vec3::ONE);
    let curve = x.map(|x| {
        [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232].into_iter().fold(0.0, |sum, c| sum * x + c)
    });
    (outset * curve).clamp(Vec3::ZERO, Vec3::ONE).map(|c| c.powf(2.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_continuous_rise_and_stay_below_one() {
        for curve in [neutral, agx] {
            let (mut last, mut most) = (Vec3::ZERO, Vec3::ZERO);
            for i in 0..200_000 {
                let x = i as f32 * 1e-3;
                let y = curve(Vec3::new(x, 0.5 * x, 0.2 * x));
                // The polynomial of AgX falls by 0.0035 after reaching 1.
                assert!(y.cmpge(most - 4e-3).all() && y.max_element() <= 1.0, "{x}: {y} after {most}");
                assert!(y.distance(last) < 4e-3, "a step at {x}");
                (last, most) = (y, most.max(y));
            }
        }
    }

    #[test]
    fn greys_stay_grey_and_neutral_keeps_base_colours() {
        for i in 0..60 {
            let grey = Vec3::splat((0.2 * i as f32 - 8.0).exp2());
            for curve in [neutral, agx] {
                let shown = curve(grey);
                assert!(shown.max_element() - shown.min_element() < 2e-3, "{grey}: {shown}");
            }
        }
        let brown = Vec3::new(0.4, 0.22, 0.1);
        assert!((neutral(brown) + 0.04).distance(brown) < 1e-6);
    }
}
