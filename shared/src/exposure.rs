//! How far an automatic exposure may go: a room that gets next to nothing of its neighbour's light is shown dark, wherever
//! the camera stands. The viewer's light_level.wgsl and key.wgsl do the same.

/// What an automatic exposure makes of a picture's radiance on the whole.
pub const MIDDLE_GREY: f32 = 0.18;
/// Stops between what is lit in a scene and what may be brought to the middle grey at most.
pub const DEPTH: f32 = 7.0;
/// What is lit counts as reflecting this much, since light is known better than what it falls on.
const REFLECTANCE: f32 = 0.5;

/// The level of a scene's light, from the luminance of the irradiance at places all over it: the geometric mean, where each
/// place counts by its light. So dark places do not count, however many there are, and a few very bright ones
/// count little. 0 where nothing is lit.
pub fn level(luminances: impl IntoIterator<Item = f32>) -> f32 {
    let lit = luminances.into_iter().filter(|light| *light > 0.0 && light.is_finite()).map(f64::from);
    let (sum, logs) = lit.fold((0.0, 0.0), |(sum, logs), light| (sum + light, logs + light * light.log2()));
    if sum > 0.0 { (logs / sum).exp2() as f32 } else { 0.0 }
}

/// What radiance may be multiplied with at most where the light is of this level; infinite where there is none.
pub fn most(level: f32) -> f32 {
    MIDDLE_GREY * DEPTH.exp2() * std::f32::consts::PI / (REFLECTANCE * level)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dark_places_do_not_count_and_units_do_not_matter() {
        let lit = [2.0, 8.0, 4.0, 4.0];
        let alone = level(lit);
        assert!((2.0..8.0).contains(&alone), "{alone}");
        let among_dark = level(lit.into_iter().chain([1e-5; 1000]).chain([0.0; 1000]));
        assert!((among_dark / alone - 1.0).abs() < 0.01, "{among_dark}, {alone}");
        for unit in [1e-12, 1e12] {
            let scaled = level(lit.map(|light| light * unit));
            assert!((scaled / (alone * unit) - 1.0).abs() < 1e-4, "{scaled}");
            assert!((most(scaled) * unit / most(alone) - 1.0).abs() < 1e-4);
        }
    }

    #[test]
    fn without_light_there_is_no_limit() {
        assert_eq!(level([0.0, f32::NAN]), 0.0);
        assert_eq!(most(level([])), f32::INFINITY);
    }

    #[test]
    fn a_share_of_the_light_becomes_grey_and_less_than_that_stays_darker() {
        // A surface that reflects half of what is typical.
        let radiance = |share: f32| REFLECTANCE * 3.0 * share / std::f32::consts::PI;
        let most = most(level([3.0; 10]));
        assert!((most * radiance(1.0 / 128.0) - MIDDLE_GREY).abs() < 1e-5);
        assert!(most * radiance(2e-5) < 0.001);
    }
}
