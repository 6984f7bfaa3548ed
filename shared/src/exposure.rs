//! Automatic exposure of a picture: the geometric mean of mean and geometric-mean radiance becomes middle grey,
//! limited by the light level of the scene. The limit keeps a room dark that receives next to no light from a lit
//! neighbour, for any camera. key.wgsl, look.wgsl and light_level.wgsl of the viewer do the same.

use crate::elementary::Elementary;

/// Overall radiance of a picture after automatic exposure.
pub const MIDDLE_GREY: f32 = 0.18;
/// Lower clamp of pixel luminance, as a share of the mean.
pub const DARKEST: f32 = 0.02;
/// Number of sampled pixels along each side of the picture, evenly spread.
pub const LOOKED: u32 = 64;
/// Maximum distance below the scene's light level, in stops, at which a surface is raised to middle grey.
pub const DEPTH: f32 = 7.0;
/// Assumed reflectance of lit surfaces, since light is known better than albedo.
const REFLECTANCE: f32 = 0.5;

/// Returns the light level of a scene, from luminances of irradiance at places all over the scene: the geometric mean
/// weighted by the luminances. Dark places do not count, in any number; a few very bright places count little. 0 for
/// a scene without light.
pub fn level(luminances: impl IntoIterator<Item = f32>) -> f32 {
    let lit = luminances.into_iter().filter(|light| *light > 0.0 && light.is_finite()).map(f64::from);
    let (sum, logs) =
        lit.fold((0.0, 0.0), |(sum, logs), light| (sum + light, logs + light * light.logarithm2()));
    if sum > 0.0 { (logs / sum).exponential2() as f32 } else { 0.0 }
}

/// Returns the sampled pixels of a picture of this size.
pub fn looked([width, height]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    let at = move |i: u32, size: u32| (((i as f32 + 0.5) / LOOKED as f32 * size as f32) as u32).min(size - 1);
    (0..LOOKED * LOOKED).map(move |i| [at(i % LOOKED, width), at(i / LOOKED, height)])
}

/// Returns the exposure factor of radiance, at most `most`, from the luminances of sampled pixels that show surfaces;
/// 1 without light.
pub fn key(luminances: &[f32], most: f32) -> f32 {
    let lights = luminances.iter().map(|light| f64::from(light.max(0.0))).filter(|light| light.is_finite());
    let mean = lights.clone().sum::<f64>() / lights.clone().count().max(1) as f64;
    if mean <= 0.0 {
        return 1.0;
    }
    let darkest = f64::from(DARKEST) * mean;
    let logs =
        lights.clone().map(|light| light.max(darkest).logarithm()).sum::<f64>() / lights.count() as f64;
    (f64::from(MIDDLE_GREY) / (logs.exponential() * mean).sqrt()).min(most.into()) as f32
}

/// Returns the maximum exposure factor at a light level; infinite for level 0.
pub fn most(level: f32) -> f32 {
    MIDDLE_GREY * DEPTH.exponential2() * std::f32::consts::PI / (REFLECTANCE * level)
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
        // Radiance of a surface with the assumed reflectance at a share of the light.
        let radiance = |share: f32| REFLECTANCE * 3.0 * share / std::f32::consts::PI;
        let most = most(level([3.0; 10]));
        assert!((most * radiance(1.0 / 128.0) - MIDDLE_GREY).abs() < 1e-5);
        assert!(most * radiance(2e-5) < 0.001);
    }
}
