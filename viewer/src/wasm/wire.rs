//! Cameras, lights, animations and statistics as lists of numbers, exchanged between the wasm module and the page.
//! The page handles objects and JSON: a JSON parser here would add a tenth to the bundle.
//!
//! ```text
//! camera  10 numbers  position, target, up: three each; yfov_deg
//! light   17 numbers  kind (0 point, 1 spot, 2 directional, …); its fields by their places in the table of kinds
//!                     (shared/src/light/kinds.rs): zero where the kind has no such field, NaN where it is absent;
//!                     texts are left to the page
//! channel  6 numbers  of the mixer: stops; mute and solo, 0 or 1; colour, NaN for the light's own
//! ```

use crate::error::ViewerError;
use crate::gpu::LIMITS;
use rebounce_shared::camera::Camera;
use rebounce_shared::environment::PackedEnvironment;
use rebounce_shared::light::{self, Light};
use rebounce_shared::mix::Channel;

/// Numbers of a camera.
pub const CAMERA: usize = 10;
/// Numbers of a channel of the mixer.
pub const CHANNEL: usize = 6;
/// Numbers of a light.
pub const LIGHT: usize = light::NUMBERS;

fn wrong(what: &'static str) -> ViewerError {
    ViewerError::BadJson { what, problem: "the list of numbers has another length or kind".into() }
}

fn three(numbers: &[f64]) -> [f64; 3] {
    [numbers[0], numbers[1], numbers[2]]
}

/// A camera's numbers.
pub fn camera_numbers(camera: &Camera) -> Vec<f64> {
    let mut out = [camera.position, camera.target, camera.up].concat();
    out.push(camera.yfov_deg);
    out
}

/// A camera from its numbers.
///
/// # Errors
/// [`ViewerError::BadJson`] for a list of another length.
pub fn camera_of(numbers: &[f64]) -> Result<Camera, ViewerError> {
    if numbers.len() != CAMERA {
        return Err(wrong("camera"));
    }
    Ok(Camera {
        position: three(numbers),
        target: three(&numbers[3..]),
        up: three(&numbers[6..]),
        yfov_deg: numbers[9],
    })
}

/// The lights' numbers, one light after the other.
pub fn light_numbers(lights: &[Light]) -> Vec<f64> {
    lights.iter().flat_map(Light::numbers).collect()
}

/// The lights from their numbers.
///
/// # Errors
/// [`ViewerError::BadJson`] for a list with an incomplete light, or with an unknown kind.
pub fn lights_of(numbers: &[f64]) -> Result<Vec<Light>, ViewerError> {
    numbers.chunks(LIGHT).map(|light| Light::from_numbers(light).ok_or_else(|| wrong("lights"))).collect()
}

/// The channels of a mix from their numbers; an incomplete one is left out.
pub fn mix_of(numbers: &[f64]) -> Vec<Channel> {
    let channel = |n: &[f64]| Channel {
        stops: n[0],
        mute: n[1] != 0.0,
        solo: n[2] != 0.0,
        color: Some(three(&n[3..])).filter(|color| !color[0].is_nan()),
    };
    numbers.chunks_exact(CHANNEL).map(channel).collect()
}

/// The picture of environment lights: rows of rgb9e5 texels from the top, `scale` the radiance of a texel of 1; none
/// without texels.
///
/// # Errors
/// [`ViewerError::BadArgument`] if the rows are incomplete, or too many or too long for a texture.
pub fn environment_of(
    width: u32,
    scale: f32,
    texels: Vec<u32>,
) -> Result<Option<PackedEnvironment>, ViewerError> {
    let height = texels.len() as u32 / width.max(1);
    let most = LIMITS.max_texture_dimension_2d;
    let is_whole = u64::from(width) * u64::from(height) == texels.len() as u64;
    if !is_whole || width > most || height > most {
        return Err(ViewerError::BadArgument("environment: the texels are no picture".into()));
    }
    let picture = PackedEnvironment { width, height, scale, pixels: texels };
    Ok(Some(picture).filter(|picture| picture.height > 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_out_comes_back() {
        let camera = Camera {
            position: [1.0, 2.0, 3.0],
            target: [4.0, 5.0, 6.0],
            up: [7.0, 8.0, 9.0],
            yfov_deg: 10.0,
        };
        assert_eq!(camera_of(&camera_numbers(&camera)).ok(), Some(camera));
        let (position, direction, color) = ([1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [0.1, 0.2, 0.3]);
        let spot = |inner_cone_deg| Light::Spot {
            position,
            direction,
            outer_cone_deg: 40.0,
            inner_cone_deg,
            intensity: 7.0,
            color,
            radius: 0.3,
        };
        let lights = vec![
            Light::Point { position, intensity: 2.0, color, radius: 0.3 },
            spot(None),
            spot(Some(20.0)),
            Light::Directional { direction, intensity: 3.0, color, radius_deg: 0.27 },
        ];
        assert_eq!(lights_of(&light_numbers(&lights)).ok(), Some(lights));
    }

    #[test]
    fn channels_have_their_own_colour_or_none() {
        let nan = f64::NAN;
        let mix = mix_of(&[-1.0, 1.0, 0.0, nan, nan, nan, 2.0, 0.0, 1.0, 0.5, 0.25, 1.0, 7.0]);
        let first = Channel { stops: -1.0, mute: true, ..Channel::default() };
        assert_eq!(
            mix,
            [first, Channel { stops: 2.0, solo: true, color: Some([0.5, 0.25, 1.0]), mute: false }]
        );
    }

    #[test]
    fn other_lists_are_refused() {
        assert!(camera_of(&[0.0; 9]).is_err() && camera_of(&[0.0; 11]).is_err());
        let unknown = light::KINDS.len() as f64;
        assert!(lights_of(&[0.0; LIGHT - 1]).is_err() && lights_of(&[unknown; LIGHT]).is_err());
        assert_eq!(lights_of(&[]).ok(), Some(Vec::new()));
    }

    #[test]
    fn environments_have_whole_rows() {
        let picture = environment_of(4, 2.0, vec![7; 8]).ok().flatten().unwrap();
        assert_eq!((picture.width, picture.height, picture.scale, picture.pixels), (4, 2, 2.0, vec![7; 8]));
        assert_eq!(environment_of(0, 1.0, Vec::new()).ok(), Some(None));
        assert!(environment_of(3, 1.0, vec![7; 8]).is_err() && environment_of(0, 1.0, vec![7]).is_err());
        let most = LIMITS.max_texture_dimension_2d as usize + 1;
        assert!(environment_of(most as u32, 1.0, vec![7; most]).is_err());
    }
}
