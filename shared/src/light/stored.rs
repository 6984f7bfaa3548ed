//! Lights in a .rbn file: the number of the kind, then the stored fields of the table in its order.
//!
//! Written over the table and not by a derive: the viewer has the code of a field once, not once a kind.

use super::field::Stored;
use super::kinds::{KINDS, Light, NUMBERS};
use bincode::de::Decoder;
use bincode::enc::Encoder;
use bincode::error::{AllowedEnumVariants, DecodeError, EncodeError};
use bincode::{Decode, Encode};

/// Numbers of the kinds.
const ALLOWED: AllowedEnumVariants = AllowedEnumVariants::Range { min: 0, max: KINDS.len() as u32 - 1 };

impl Light {
    /// The one field that is a text: the picture of an environment.
    fn text(&self) -> Option<&Option<String>> {
        match self {
            Self::Environment { file, .. } => Some(file),
            _ => None,
        }
    }
}

impl Encode for Light {
    fn encode<E: Encoder>(&self, encoder: &mut E) -> Result<(), EncodeError> {
        let (kind, numbers) = (self.kind() as u32, self.numbers());
        kind.encode(encoder)?;
        for (field, _) in KINDS[kind as usize].fields {
            let own = &numbers[field.at..field.at + field.width];
            match field.stored {
                Stored::No => {}
                Stored::Numbers => own.iter().try_for_each(|number| number.encode(encoder))?,
                Stored::Optional => Some(own[0]).filter(|number| !number.is_nan()).encode(encoder)?,
                Stored::Whole => (own[0] as u32).encode(encoder)?,
                Stored::Text => self.text().cloned().flatten().encode(encoder)?,
            }
        }
        Ok(())
    }
}

impl<Context> Decode<Context> for Light {
    fn decode<D: Decoder<Context = Context>>(decoder: &mut D) -> Result<Self, DecodeError> {
        let found = u32::decode(decoder)?;
        let unknown = || DecodeError::UnexpectedVariant { type_name: "Light", allowed: &ALLOWED, found };
        let mut numbers = [0.0; NUMBERS];
        numbers[0] = f64::from(found);
        let mut text = None;
        for (field, _) in KINDS.get(found as usize).ok_or_else(unknown)?.fields {
            let own = &mut numbers[field.at..field.at + field.width];
            match field.stored {
                Stored::No => {}
                Stored::Numbers => own.iter_mut().try_for_each(|number| read(number, decoder))?,
                Stored::Optional => {
                    own[0] = f64::NAN;
                    if bool::decode(decoder)? {
                        read(&mut own[0], decoder)?;
                        if own[0].is_nan() {
                            return Err(DecodeError::Other("a number that is there is NaN"));
                        }
                    }
                }
                Stored::Whole => own[0] = f64::from(u32::decode(decoder)?),
                Stored::Text => text = Option::decode(decoder)?,
            }
        }
        let mut light = Self::from_numbers(&numbers).ok_or_else(unknown)?;
        if let Self::Environment { file, .. } = &mut light {
            *file = text;
        }
        Ok(light)
    }
}

bincode::impl_borrow_decode!(Light);

/// Decodes a number into its place. Not inlined: the viewer has the code once.
#[inline(never)]
fn read<D: Decoder>(place: &mut f64, decoder: &mut D) -> Result<(), DecodeError> {
    *place = f64::decode(decoder)?;
    Ok(())
}
