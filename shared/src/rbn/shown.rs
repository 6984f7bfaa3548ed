//! Presentation of a scene apart from its light: names, and the ground under an object. Optional section `SHOW`;
//! readers without support show the same surfaces in the same light.

use bincode::de::Decoder;
use bincode::enc::Encoder;
use bincode::error::{DecodeError, EncodeError};
use bincode::{Decode, Encode};
use std::iter::once;

/// Resolution of a [`Ground`] along each side.
pub const SIDE: usize = 32;
/// Size of a ground, bytes: eight floats (three of them zero), and the shadow.
pub const GROUND: usize = 32 + SIDE * SIDE;

/// Names and ground. In section `META` the encoding is empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shown {
    /// Names of the lights, then of the cameras, terminated by zero bytes (an empty name is a lone zero byte); empty
    /// for a scene without names.
    pub names: String,
    /// [`Ground::to_bytes`] for an object, shown in front of a backdrop instead of black; empty otherwise.
    pub ground: Vec<u8>,
}

/// Horizontal plane under an object, with the object's shadow, in local space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ground {
    /// Least x and z of the shadow.
    pub low: [f32; 2],
    /// Greatest x and z.
    pub high: [f32; 2],
    /// y of the plane.
    pub height: f32,
    /// Occluded share of the sky, 0 to 255, at the centres of [`SIDE`] by [`SIDE`] squares, row by row along x.
    pub shade: Vec<u8>,
}

impl Encode for Shown {
    fn encode<E: Encoder>(&self, _: &mut E) -> Result<(), EncodeError> {
        Ok(())
    }
}

impl<C> Decode<C> for Shown {
    fn decode<D: Decoder<Context = C>>(_: &mut D) -> Result<Self, DecodeError> {
        Ok(Self::default())
    }
}

bincode::impl_borrow_decode!(Shown);

impl Shown {
    /// Creates `Shown` from the names of lights, then cameras, and a ground.
    pub fn new<'a>(names: impl Iterator<Item = &'a str> + Clone, ground: Option<&Ground>) -> Self {
        let is_named = names.clone().any(|name| !name.is_empty());
        // A zero within a name would terminate the name.
        let letters = |name: &'a str| name.chars().filter(|c| *c != '\0').chain(once('\0'));
        Self {
            names: if is_named { names.flat_map(letters).collect() } else { String::new() },
            ground: ground.map(Ground::to_bytes).unwrap_or_default(),
        }
    }

    /// Returns the names in order; empty if nothing is named.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.split_terminator('\0')
    }

    /// Returns the ground, if present.
    pub fn ground(&self) -> Option<Ground> {
        let (numbers, shade) = self.ground.split_at_checked(32)?;
        let numbers: [f32; 8] = bytemuck::pod_read_unaligned(numbers);
        let [x, z, right, back, height, ..] = numbers;
        Some(Ground { low: [x, z], high: [right, back], height, shade: shade.to_vec() })
    }
}

impl Ground {
    /// Encodes as little-endian floats: least x and z, greatest x and z, y, three zeros; then the shadow.
    pub fn to_bytes(&self) -> Vec<u8> {
        let numbers = [self.low, self.high, [self.height, 0.0], [0.0; 2]];
        let numbers = numbers.as_flattened().iter().flat_map(|x| x.to_le_bytes());
        numbers.chain(self.shade.iter().copied()).collect()
    }
}

/// Encodes section `SHOW`; `None` for no names and no ground.
pub(crate) fn encode(shown: &Shown) -> Option<Vec<u8>> {
    let is_some = *shown != Shown::default();
    is_some.then(|| [&[!shown.ground.is_empty() as u8], &shown.ground[..], shown.names.as_bytes()].concat())
}

/// Decodes section `SHOW`; `None` for malformed bytes.
pub(crate) fn decode(bytes: &[u8]) -> Option<Shown> {
    let (has_ground, rest) = bytes.split_first()?;
    let (ground, names) = rest.split_at_checked(if *has_ground == 1 { GROUND } else { 0 })?;
    Some(Shown { names: String::from_utf8(names.to_vec()).ok()?, ground: ground.to_vec() })
}
