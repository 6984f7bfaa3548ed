//! Transmission through a surface: KHR_materials_transmission, _volume, _diffuse_transmission.

use gltf::json::texture::Info;
use rebounce_shared::elementary::Elementary;
use rebounce_shared::rbn::extras::Extras;
use serde::Deserialize;

/// Name of the extension unknown to the `gltf` crate.
pub(super) const DIFFUSE: &str = "KHR_materials_diffuse_transmission";

/// JSON of KHR_materials_diffuse_transmission.
#[derive(Debug, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct DiffuseTransmission {
    pub diffuse_transmission_factor: f32,
    pub diffuse_transmission_texture: Option<Info>,
    /// Linear RGB.
    pub diffuse_transmission_color_factor: [f32; 3],
    pub diffuse_transmission_color_texture: Option<Info>,
}

impl Default for DiffuseTransmission {
    fn default() -> Self {
        Self {
            diffuse_transmission_factor: 0.0,
            diffuse_transmission_texture: None,
            diffuse_transmission_color_factor: [1.0; 3],
            diffuse_transmission_color_texture: None,
        }
    }
}

/// Transmission parameters of a file; absent parameters are `default`.
#[derive(Clone, Copy, Debug)]
pub(super) struct TransmissionFactors {
    /// `transmissionFactor`.
    pub transmission: f32,
    /// `thicknessFactor`, scene units.
    pub thickness: f32,
    /// `attenuationDistance`, scene units; may be infinite.
    pub attenuation_distance: f32,
    /// `attenuationColor`, linear RGB.
    pub attenuation_color: [f32; 3],
    /// `diffuseTransmissionFactor`.
    pub scattered: f32,
    /// `diffuseTransmissionColorFactor`, linear RGB.
    pub scattered_color: [f32; 3],
}

impl Default for TransmissionFactors {
    fn default() -> Self {
        Self {
            transmission: 0.0,
            thickness: 0.0,
            attenuation_distance: f32::INFINITY,
            attenuation_color: [1.0; 3],
            scattered: 0.0,
            scattered_color: [1.0; 3],
        }
    }
}

impl TransmissionFactors {
    /// Whether all parameters are numbers, not NaN.
    pub fn are_usable(&self) -> bool {
        let factors = [self.transmission, self.thickness, self.attenuation_distance, self.scattered];
        !factors.iter().chain(&self.attenuation_color).chain(&self.scattered_color).any(|x| x.is_nan())
    }

    /// Converts to [`Extras`]. Light crosses two faces of a volume: the tint of a face is the attenuation by half the
    /// thickness.
    pub fn extras(&self) -> Extras {
        let unit = |x: f32| x.clamp(0.0, 1.0);
        let depth = 0.5 * self.thickness.max(0.0) / self.attenuation_distance.max(f32::MIN_POSITIVE);
        let scattered_color = self.scattered_color.map(unit);
        Extras {
            transmission: unit(self.transmission),
            transmission_tint: match depth > 0.0 {
                true => self.attenuation_color.map(|c| unit(c).power(depth)),
                false => [1.0; 3],
            },
            scattered: unit(self.scattered),
            scattered_color,
            ..Extras::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_takes_what_its_thickness_says_once() {
        let attenuation_color = [0.25, 0.5, 1.0];
        for (thickness, attenuation_distance, power) in
            [(0.2, 0.2, 1.0), (0.1, 0.2, 0.5), (0.2, f32::INFINITY, 0.0), (0.0, 0.2, 0.0)]
        {
            let numbers = TransmissionFactors {
                thickness,
                attenuation_distance,
                attenuation_color,
                ..TransmissionFactors::default()
            };
            let tint = numbers.extras().transmission_tint;
            for (face, color) in tint.into_iter().zip(attenuation_color) {
                assert!((face * face - color.powf(power)).abs() < 1e-6, "{thickness}: {face}");
            }
        }
    }
}
