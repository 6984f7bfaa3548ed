//! Optional material properties: section `MATX`, present only in files with a non-default [`Extras`].

use super::limits::MAX_BYTES;
use super::texture::DetailTexture;
use super::{RbnError, small};
use bincode::de::Decoder;
use bincode::enc::Encoder;
use bincode::error::{DecodeError, EncodeError};
use bincode::{Decode, Encode};
use glam::Vec3;

/// Transmission and unlit colour of a material. In section `META` the encoding is empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extras {
    /// Unlit: pictures show the base colour independent of light; to transport the surface is ordinary.
    pub unlit: bool,
    /// Specular transmission of non-metal, 0 to 1, tinted by base colour times `transmission_tint`; multiplied by the
    /// texture's red.
    pub transmission: f32,
    /// Transmission texture, in the red channel.
    pub transmission_texture: Option<DetailTexture>,
    /// Linear RGB, 0 to 1.
    pub transmission_tint: [f32; 3],
    /// Share of the remaining light transmitted diffusely in `scattered_color` instead of reflected, 0 to 1.
    pub scattered: f32,
    /// Linear RGB, 0 to 1.
    pub scattered_color: [f32; 3],
}

impl Default for Extras {
    /// Lit and opaque.
    fn default() -> Self {
        Self {
            unlit: false,
            transmission: 0.0,
            transmission_texture: None,
            transmission_tint: [1.0; 3],
            scattered: 0.0,
            scattered_color: [1.0; 3],
        }
    }
}

/// Split of incident light into transmission and reflection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Transmitted share, linear RGB, 0 to 1.
    pub through: Vec3,
    /// Factor from base colour to reflected share, 0 to 1. Transmission plus reflection is at most 1 per channel.
    pub reflected: f32,
}

impl Extras {
    /// Returns the split of light for a base colour, alpha, metalness, and the transmission texture's red; range 0 to
    /// 1.
    pub fn passage(&self, base: Vec3, alpha: f32, metallic: f32, red: f32) -> Passage {
        let straight = (1.0 - metallic) * self.transmission * red;
        let scattered = ((1.0 - metallic) - straight) * self.scattered;
        let tint = base * Vec3::from(self.transmission_tint);
        let through = straight * tint + scattered * Vec3::from(self.scattered_color);
        Passage {
            through: Vec3::splat(1.0 - alpha) + alpha * through,
            reflected: alpha * (1.0 - straight - scattered),
        }
    }
}

impl Encode for Extras {
    fn encode<E: Encoder>(&self, _: &mut E) -> Result<(), EncodeError> {
        Ok(())
    }
}

impl<C> Decode<C> for Extras {
    fn decode<D: Decoder<Context = C>>(_: &mut D) -> Result<Self, DecodeError> {
        Ok(Self::default())
    }
}

bincode::impl_borrow_decode!(Extras);

/// Index of a material and its extras, in the order of [`Extras`].
type Record = (u32, bool, f32, Option<DetailTexture>, [f32; 3], f32, [f32; 3]);

/// Encodes the section; `None` if every material has default extras.
///
/// # Errors
/// [`RbnError::TooLarge`] past [`MAX_BYTES`].
pub(crate) fn encode<'a>(materials: impl Iterator<Item = &'a Extras>) -> Result<Option<Vec<u8>>, RbnError> {
    let some = (0u32..).zip(materials).filter(|(_, extras)| **extras != Extras::default());
    let records: Vec<Record> = some
        .map(|(number, e)| {
            let texture = e.transmission_texture;
            (number, e.unlit, e.transmission, texture, e.transmission_tint, e.scattered, e.scattered_color)
        })
        .collect();
    if records.is_empty() {
        return Ok(None);
    }
    let too_large = || format!("materials that let light through need over {MAX_BYTES} bytes: merge some");
    small::encode(&records, too_large).map(Some)
}

/// Decodes the section into the materials; records are in ascending order of material index.
///
/// # Errors
/// [`RbnError::Invalid`].
pub(crate) fn decode(bytes: &[u8], materials: &mut [&mut Extras]) -> Result<(), RbnError> {
    let bad = |problem: String| RbnError::invalid("MATX", problem);
    let records: Vec<Record> = small::decode("MATX", bytes)?;
    let mut least = 0;
    for (number, unlit, transmission, transmission_texture, transmission_tint, scattered, scattered_color) in
        records
    {
        let material = materials.get_mut(number as usize).filter(|_| number >= least);
        let material = material.ok_or_else(|| bad(format!("there is no material {number}, or not here")))?;
        least = number + 1;
        **material = Extras {
            unlit,
            transmission,
            transmission_texture,
            transmission_tint,
            scattered,
            scattered_color,
        };
    }
    Ok(())
}
