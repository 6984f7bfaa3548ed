//! How materials shine besides metalness, roughness and specular strength: section `MATG`, present only in files with a
//! non-default [`SpecularExtras`].

use super::limits::{MAX_BYTES, all_sane, sane};
use super::{RbnError, small};
use bincode::de::Decoder;
use bincode::enc::Encoder;
use bincode::error::{DecodeError, EncodeError};
use bincode::{Decode, Encode};
use glam::Vec3;

/// Name of the section in errors.
const SECTION: &str = "MATG";
/// Index of refraction that a material has unless its file says another: a reflectance of 0.04.
pub const DEFAULT_IOR: f32 = 1.5;

/// Index of refraction, specular colour and clear layer of a material, for pictures. In section `META` the encoding is empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpecularExtras {
    /// Index of refraction of what is not metal, at least 1; or 0 for what reflects all light at normal incidence.
    pub ior: f32,
    /// Factor of the reflectance of what is not metal at normal incidence, linear RGB, at least 0.
    pub specular_color: [f32; 3],
    /// Strength of a clear layer over the material, 0 to 1.
    pub clearcoat: f32,
    /// Roughness of the clear layer, 0 to 1.
    pub clearcoat_roughness: f32,
}

impl Default for SpecularExtras {
    /// As a material without the section.
    fn default() -> Self {
        Self { ior: DEFAULT_IOR, specular_color: [1.0; 3], clearcoat: 0.0, clearcoat_roughness: 0.0 }
    }
}

impl SpecularExtras {
    /// Returns the reflectance F₀ of what is not metal at normal incidence, linear RGB, 0 to 1, for a specular strength.
    pub fn head_on(&self, specular: f32) -> Vec3 {
        let amplitude = (self.ior - 1.0) / (self.ior + 1.0);
        (amplitude * amplitude * Vec3::from(self.specular_color)).min(Vec3::ONE) * specular
    }

    /// Whether the numbers are in range.
    fn is_sound(&self) -> bool {
        let is_share = |x: f32| (0.0..=1.0).contains(&x);
        sane(self.ior)
            && (self.ior == 0.0 || self.ior >= 1.0)
            && all_sane(&self.specular_color)
            && self.specular_color.iter().all(|x| *x >= 0.0)
            && is_share(self.clearcoat)
            && is_share(self.clearcoat_roughness)
    }
}

impl Encode for SpecularExtras {
    fn encode<E: Encoder>(&self, _: &mut E) -> Result<(), EncodeError> {
        Ok(())
    }
}

impl<C> Decode<C> for SpecularExtras {
    fn decode<D: Decoder<Context = C>>(_: &mut D) -> Result<Self, DecodeError> {
        Ok(Self::default())
    }
}

bincode::impl_borrow_decode!(SpecularExtras);

/// Index of a material and its properties, in the order of [`SpecularExtras`].
type SpecularRecord = (u32, f32, [f32; 3], f32, f32);

/// Encodes the section; `None` if every material has the default.
///
/// # Errors
/// [`RbnError::TooLarge`] past [`MAX_BYTES`].
pub(crate) fn encode<'a>(
    materials: impl Iterator<Item = &'a SpecularExtras>,
) -> Result<Option<Vec<u8>>, RbnError> {
    let some = (0u32..).zip(materials).filter(|(_, specular)| **specular != SpecularExtras::default());
    let records: Vec<SpecularRecord> = some
        .map(|(number, g)| (number, g.ior, g.specular_color, g.clearcoat, g.clearcoat_roughness))
        .collect();
    if records.is_empty() {
        return Ok(None);
    }
    let too_large = || format!("materials that shine need over {MAX_BYTES} bytes: merge some");
    small::encode(&records, too_large).map(Some)
}

/// Decodes the section into the materials; records are in ascending order of material index. The caller checks the numbers.
///
/// # Errors
/// [`RbnError::Invalid`].
pub(crate) fn decode(bytes: &[u8], materials: &mut [&mut SpecularExtras]) -> Result<(), RbnError> {
    let bad = |problem: String| RbnError::invalid(SECTION, problem);
    let records: Vec<SpecularRecord> = small::decode(SECTION, bytes)?;
    let mut least = 0;
    for (number, ior, specular_color, clearcoat, clearcoat_roughness) in records {
        let material = materials.get_mut(number as usize).filter(|_| number >= least);
        let material = material.ok_or_else(|| bad(format!("there is no material {number}, or not here")))?;
        least = number + 1;
        **material = SpecularExtras { ior, specular_color, clearcoat, clearcoat_roughness };
    }
    Ok(())
}

/// Checks the numbers of all materials.
///
/// # Errors
/// [`RbnError::Invalid`].
pub(crate) fn check<'a>(materials: impl Iterator<Item = &'a SpecularExtras>) -> Result<(), RbnError> {
    match (0u32..).zip(materials).find(|(_, specular)| !specular.is_sound()) {
        Some((number, _)) => {
            Err(RbnError::invalid(SECTION, format!("material {number} has a number outside its range")))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reflectance_follows_from_the_index_of_refraction_and_is_at_most_one() {
        let head_on = |ior: f32, specular_color: [f32; 3], specular: f32| {
            SpecularExtras { ior, specular_color, ..SpecularExtras::default() }.head_on(specular)
        };
        let near = |a: Vec3, b: [f32; 3]| assert!((a - Vec3::from(b)).abs().max_element() < 1e-6, "{a}");
        near(SpecularExtras::default().head_on(1.0), [0.04; 3]);
        near(SpecularExtras::default().head_on(0.5), [0.02; 3]);
        // No change of refraction, diamond, and the value that stands for a mirror.
        near(head_on(1.0, [1.0; 3], 1.0), [0.0; 3]);
        near(head_on(2.42, [1.0; 3], 1.0), [0.172_394_58; 3]);
        near(head_on(0.0, [1.0, 0.5, 2.0], 0.5), [0.5, 0.25, 0.5]);
        near(head_on(1.5, [50.0, 1.0, 0.0], 1.0), [1.0, 0.04, 0.0]);
    }
}
