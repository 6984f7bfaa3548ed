//! A light mixer: strength and colour of lights, apart from the lights themselves.

use crate::light::{COLOR, INTENSITY, Light};
use serde::{Deserialize, Serialize};

/// Greatest strength of a channel, stops up or down: beyond, pictures are black or white.
pub const MOST_STOPS: f64 = 20.0;

/// Channel of a mixer: what is done to one light.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Channel {
    /// Strength relative to the light's own, stops.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub stops: f64,
    /// Whether the light is off.
    #[serde(default, skip_serializing_if = "is_false")]
    pub mute: bool,
    /// Whether the light is heard alone, with others that are solo.
    #[serde(default, skip_serializing_if = "is_false")]
    pub solo: bool,
    /// Linear RGB in place of the light's colour; the light's own when absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub color: Option<[f64; 3]>,
}

/// Returns lights as a mix has them. The channels are those of the lights in their order; a light without one is as it
/// is. While a channel is solo, all lights that are not are off.
pub fn mixed(lights: &[Light], mix: &[Channel]) -> Vec<Light> {
    let is_any_solo = mix.iter().any(|channel| channel.solo);
    let neutral = Channel::default();
    let channels = mix.iter().chain(std::iter::repeat(&neutral));
    let through = |(light, channel): (&Light, &Channel)| {
        let is_on = !channel.mute && (channel.solo || !is_any_solo);
        // In 32 bits, which take no table in the viewer.
        let factor = if is_on { (channel.stops as f32).exp2() } else { 0.0 };
        let light = light.with(INTENSITY.at, &[light.intensity() * f64::from(factor)]);
        channel.color.map_or_else(|| light.clone(), |color| light.with(COLOR.at, &color))
    };
    lights.iter().zip(channels).map(through).collect()
}

impl Channel {
    fn has_stops(&self) -> bool {
        self.stops.abs() <= MOST_STOPS
    }

    /// Returns whether SHOT.json may have the channel.
    pub fn is_usable(&self) -> bool {
        let is_color = |color: [f64; 3]| color.iter().all(|x| (0.0..=1.0).contains(x));
        self.has_stops() && self.color.is_none_or(is_color)
    }
}

/// Returns what is wrong with a mix, in words; `None` for one that SHOT.json may have.
pub fn problem(mix: &[Channel]) -> Option<String> {
    let (i, channel) = mix.iter().enumerate().find(|(_, channel)| !channel.is_usable())?;
    let rule = match channel.has_stops() {
        true => "color is linear RGB, each from 0 to 1".to_owned(),
        false => format!("stops lie between -{MOST_STOPS} and {MOST_STOPS}"),
    };
    Some(format!("channel {i} of the mix: {rule}"))
}

fn is_zero(stops: &f64) -> bool {
    *stops == 0.0
}

fn is_false(flag: &bool) -> bool {
    !flag
}

#[cfg(test)]
mod tests {
    use super::*;

    fn intensities(mix: &[Channel]) -> Vec<f64> {
        let lamp = |intensity| Light::Point { position: [0.0; 3], intensity, color: [1.0; 3], radius: 0.0 };
        let lights = [
            lamp(3.0),
            lamp(5.0),
            Light::Environment {
                file: Some("a.hdr".into()),
                rotation_deg: 20.0,
                intensity: 1.0,
                color: [1.0; 3],
            },
        ];
        let mixed = mixed(&lights, mix);
        assert!(matches!(&mixed[2], Light::Environment { file: Some(file), .. } if file == "a.hdr"));
        mixed.iter().map(Light::intensity).collect()
    }

    #[test]
    fn strength_is_in_stops_mute_is_off_and_solo_silences_all_others() {
        let channel = Channel::default();
        assert_eq!(intensities(&[]), [3.0, 5.0, 1.0]);
        assert_eq!(intensities(&[Channel { stops: 2.0, ..channel.clone() }]), [12.0, 5.0, 1.0]);
        assert_eq!(
            intensities(&[channel.clone(), Channel { mute: true, ..channel.clone() }]),
            [3.0, 0.0, 1.0]
        );
        let solo = Channel { solo: true, stops: -1.0, ..channel.clone() };
        assert_eq!(intensities(&[channel.clone(), solo.clone()]), [0.0, 2.5, 0.0]);
        // Two may be solo; a muted one stays off.
        assert_eq!(intensities(&[solo.clone(), solo.clone()]), [1.5, 2.5, 0.0]);
        assert_eq!(intensities(&[Channel { mute: true, ..solo.clone() }, solo]), [0.0, 2.5, 0.0]);
    }

    #[test]
    fn a_colour_takes_the_place_of_the_lights_and_what_is_none_is_refused() {
        let lamp = Light::Point { position: [0.0; 3], intensity: 1.0, color: [0.5; 3], radius: 0.0 };
        let red = Channel { color: Some([1.0, 0.0, 0.0]), ..Channel::default() };
        assert_eq!(mixed(&[lamp], std::slice::from_ref(&red))[0].color(), [1.0, 0.0, 0.0]);
        assert_eq!(problem(&[red]), None);
        let wrong = |channel: Channel| problem(&[Channel::default(), channel]).unwrap();
        assert!(wrong(Channel { stops: f64::NAN, ..Channel::default() }).contains("channel 1"));
        assert!(wrong(Channel { color: Some([0.0, 2.0, 0.0]), ..Channel::default() }).contains("color"));
    }
}
