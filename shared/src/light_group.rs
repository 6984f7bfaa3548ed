//! Groups of light of a fixed solution: from the lights of a picture to a strength for each group.
//!
//! The lights of such a file stay in place. A picture may have fewer of them, dimmer and in other colours.

use crate::light::{COLOR, INTENSITY, KINDS, Light, LightKind, NUMBERS, ROTATION, SIZE};
use glam::Vec3;

/// Greatest difference of a number that counts as equal, as a share of its magnitude plus 1: links and SHOT.json round.
const EQUAL: f64 = 1e-5;

/// A light that no group of light is for.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "light {number}, {kind}, is not where the file was solved for it: intensity and color alone change; `rebounce bake` makes files whose lights move"
)]
pub struct MovedLight {
    /// Number of the light in the picture, from 0.
    pub number: usize,
    /// Name of its kind.
    pub kind: &'static str,
}

/// Returns the strength of each group, linear RGB; `solved` are the lights of the file, `lights` those of the picture. A
/// group without a light is dark.
///
/// # Errors
/// [`MovedLight`] for a light that is elsewhere, larger or of another kind than every light of the file.
pub fn group_strengths(solved: &[Light], lights: &[Light]) -> Result<Vec<Vec3>, MovedLight> {
    let mut out = vec![Vec3::ZERO; solved.len()];
    let mut is_free = vec![true; solved.len()];
    for (number, light) in lights.iter().enumerate() {
        let is_own = |group: &usize| is_free[*group] && is_in_place(&solved[*group], light);
        let group = (0..solved.len()).find(is_own);
        let kind = KINDS[light.kind() as usize].name;
        let group = group.ok_or(MovedLight { number, kind })?;
        is_free[group] = false;
        out[group] = light.strength();
    }
    Ok(out)
}

/// Whether a light equals another but for intensity and colour. The radius of a punctual light counts for its direct light
/// alone; the picture of an environment is the file's own.
fn is_in_place(solved: &Light, light: &Light) -> bool {
    let (solved, light) = (place(solved), place(light));
    (0..NUMBERS).all(|at| {
        let [a, b] = [solved[at], light[at]];
        let mut apart = a - b;
        // A turn may be written in several ways.
        if at == ROTATION.at && solved[0] == f64::from(LightKind::Environment as u32) {
            apart -= 360.0 * (apart / 360.0).round_ties_even();
        }
        a.is_nan() && b.is_nan() || apart.abs() <= EQUAL * (1.0 + a.abs())
    })
}

/// Numbers of a light that stay.
fn place(light: &Light) -> [f64; NUMBERS] {
    let mut numbers = light.numbers();
    numbers[INTENSITY.at] = 0.0;
    numbers[COLOR.at..COLOR.at + 3].fill(0.0);
    if light.kind().is_punctual() {
        numbers[SIZE.at] = 0.0;
    }
    numbers
}

/// Returns a light at unit strength, white.
pub fn at_unit_strength(light: &Light) -> Light {
    light.with(INTENSITY.at, &[1.0]).with(COLOR.at, &[1.0; 3])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, intensity: f64, color: [f64; 3]) -> Light {
        Light::Point { position: [x, 0.0, 0.0], intensity, color, radius: 0.0 }
    }

    #[test]
    fn lights_in_their_places_set_the_strengths_and_the_others_are_dark() {
        let solved = [point(0.0, 5.0, [1.0; 3]), point(1.0, 7.0, [1.0; 3]), point(1.0, 7.0, [1.0; 3])];
        let now = [point(1.0 + 1e-9, 2.0, [1.0, 0.5, 0.0])];
        let strengths = group_strengths(&solved, &now).unwrap();
        assert_eq!(strengths, [Vec3::ZERO, Vec3::new(2.0, 1.0, 0.0), Vec3::ZERO]);
        assert_eq!(group_strengths(&solved, &solved).unwrap()[0], Vec3::splat(5.0));
        // Two lights in one place are two groups.
        assert_eq!(group_strengths(&solved, &solved).unwrap()[2], Vec3::splat(7.0));
    }

    #[test]
    fn a_light_elsewhere_is_refused_with_what_to_do() {
        let solved = [point(0.0, 5.0, [1.0; 3])];
        let spot = Light::Spot {
            position: [0.0; 3],
            direction: [0.0, -1.0, 0.0],
            outer_cone_deg: 40.0,
            inner_cone_deg: None,
            intensity: 1.0,
            color: [1.0; 3],
            radius: 0.0,
        };
        for moved in [point(0.01, 5.0, [1.0; 3]), spot.clone()] {
            let error = group_strengths(&solved, &[moved]).unwrap_err().to_string();
            assert!(error.contains("light 0") && error.contains("rebounce bake"), "{error}");
        }
        assert!(group_strengths(&solved, &[solved[0].clone(), solved[0].clone()]).is_err());
        let turned =
            |rotation_deg| Light::Environment { file: None, rotation_deg, intensity: 1.0, color: [1.0; 3] };
        assert!(group_strengths(&[turned(-90.0)], &[turned(270.0)]).is_ok());
        assert!(group_strengths(&[turned(0.0)], &[turned(360.0 - 1e-9)]).is_ok());
        assert!(group_strengths(&[turned(-90.0)], &[turned(0.0)]).is_err());
    }
}
