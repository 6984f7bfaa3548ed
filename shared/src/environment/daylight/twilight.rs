//! How the sky fades after sunset: Janiczek and DeYoung, *Computer Programs for Sun and Moon Illuminance*, U.S. Naval
//! Observatory Circular 171, 1987.

use crate::elementary::Elementary;

/// Elevation of the sun at which night begins, degrees.
pub const NIGHT_DEG: f32 = -18.0;

/// Pieces of the curve: from which elevation in degrees, and the coefficients of the decimal logarithm of the
/// illuminance in lux, a polynomial in the elevation over 90°.
const PIECES: [(f32, [f32; 4]); 3] = [
    (-5.0, [2.88, 21.81, -258.11, -858.36]),
    (-12.0, [2.70, 12.17, -431.69, -1899.83]),
    (NIGHT_DEG, [13.84, 262.72, 1447.42, 2797.93]),
];

/// Illuminance of twilight over that at sunset: 1 with the sun at or above the horizon, falling with it; below −18° that
/// of a moonless night, 0.00065 over 759 lux. Pieces of the curve meet to half a percent.
pub fn share(elevation_deg: f32) -> f32 {
    let elevation = elevation_deg.clamp(NIGHT_DEG, 0.0);
    let piece = PIECES.iter().find(|(from, _)| elevation >= *from).unwrap_or(&PIECES[2]);
    let x = elevation / 90.0;
    let logarithm = piece.1.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient);
    10f32.power(logarithm - PIECES[0].1[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twilight_falls_to_night_without_a_jump() {
        assert_eq!(share(0.0), 1.0);
        assert_eq!(share(40.0), 1.0);
        let mut before = 1.0;
        for step in 1..=400 {
            let now = share(-0.05 * step as f32);
            assert!(now <= before * 1.005 && now > 0.9 * before, "{step}: {now} after {before}");
            before = now;
        }
        assert_eq!(share(-90.0), share(-18.0));
        // Civil, nautical and astronomical twilight end at 3.4, 0.008 and 0.00065 lux.
        for (elevation, lux) in [(-6.0, 3.4), (-12.0, 0.008), (-18.0, 0.000_65)] {
            assert!((share(elevation) * 758.6 / lux - 1.0).abs() < 0.02, "{elevation}");
        }
    }
}
