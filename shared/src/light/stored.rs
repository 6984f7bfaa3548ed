//! Encoding of lights in a .rbn file: as in glTF, without a size.

use super::Light;
use bincode::de::Decoder;
use bincode::enc::Encoder;
use bincode::error::{AllowedEnumVariants, DecodeError, EncodeError};
use bincode::{Decode, Encode};

impl Encode for Light {
    fn encode<E: Encoder>(&self, encoder: &mut E) -> Result<(), EncodeError> {
        match self {
            Self::Point { position, intensity, color, .. } => {
                (0u32, position, intensity, color).encode(encoder)
            }
            Self::Spot { position, direction, outer_cone_deg, inner_cone_deg, intensity, color, .. } => {
                (1u32, position, direction, outer_cone_deg, inner_cone_deg, intensity, color).encode(encoder)
            }
            Self::Directional { direction, intensity, color, .. } => {
                (2u32, direction, intensity, color).encode(encoder)
            }
        }
    }
}

impl<Context> Decode<Context> for Light {
    fn decode<D: Decoder<Context = Context>>(decoder: &mut D) -> Result<Self, DecodeError> {
        // Members in the order of the file.
        Ok(match u32::decode(decoder)? {
            0 => Self::Point {
                position: Decode::decode(decoder)?,
                intensity: Decode::decode(decoder)?,
                color: Decode::decode(decoder)?,
                radius: 0.0,
            },
            1 => Self::Spot {
                position: Decode::decode(decoder)?,
                direction: Decode::decode(decoder)?,
                outer_cone_deg: Decode::decode(decoder)?,
                inner_cone_deg: Decode::decode(decoder)?,
                intensity: Decode::decode(decoder)?,
                color: Decode::decode(decoder)?,
                radius: 0.0,
            },
            2 => Self::Directional {
                direction: Decode::decode(decoder)?,
                intensity: Decode::decode(decoder)?,
                color: Decode::decode(decoder)?,
                radius_deg: 0.0,
            },
            found => {
                let allowed = &AllowedEnumVariants::Range { min: 0, max: 2 };
                return Err(DecodeError::UnexpectedVariant { type_name: "Light", allowed, found });
            }
        })
    }
}

bincode::impl_borrow_decode!(Light);
