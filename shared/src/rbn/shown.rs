//! How a scene is shown besides its light: names, and the ground under an object. Section `SHOW`, which only files with any
//! of it have; readers that do not know it show the same surfaces in the same light.

use super::meta::Meta;
use bincode::de::Decoder;
use bincode::enc::Encoder;
use bincode::error::{DecodeError, EncodeError};
use bincode::{Decode, Encode};

/// Places of a [`Ground`] along each side.
pub const SIDE: usize = 32;

/// Names and ground. Section `META` has nothing of it: it encodes to no bytes there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shown {
    /// Names of the lights, one each, where any has one; empty for one without.
    pub lights: Vec<String>,
    /// Names of the cameras, likewise.
    pub cameras: Vec<String>,
    /// Of an object, which stands before a backdrop instead of black.
    pub ground: Option<Ground>,
}

/// A level plane under an object, with the shadow of what stands on it, in local space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ground {
    /// y of the plane.
    pub height: f32,
    /// Least x and z of the shadow.
    pub low: [f32; 2],
    /// Greatest x and z.
    pub high: [f32; 2],
    /// Share of the sky that is hidden, 0 to 255, at the middles of [`SIDE`] by [`SIDE`] squares, row after row along x.
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
    /// The light's name, or none.
    pub fn light(&self, light: usize) -> &str {
        self.lights.get(light).map_or("", String::as_str)
    }

    /// The camera's name, or none.
    pub fn camera(&self, camera: usize) -> &str {
        self.cameras.get(camera).map_or("", String::as_str)
    }
}

/// Names as a file has them: none at all where all are empty.
pub fn names(names: Vec<String>) -> Vec<String> {
    if names.iter().all(String::is_empty) { Vec::new() } else { names }
}

/// Bytes of a ground: five floats, and its shadow.
const GROUND: usize = 20 + SIDE * SIDE;

/// Encodes the section; `None` where there is nothing of it. A zero in a name ends it.
pub(super) fn encode(meta: &Meta) -> Option<Vec<u8>> {
    let shown = &meta.shown;
    if *shown == Shown::default() {
        return None;
    }
    let mut out = vec![shown.ground.is_some() as u8];
    if let Some(ground) = &shown.ground {
        let ([x, z], [right, back]) = (ground.low, ground.high);
        out.extend([ground.height, x, z, right, back].iter().flat_map(|x| x.to_le_bytes()));
        out.extend(&ground.shade);
    }
    if shown.lights.len() + shown.cameras.len() > 0 {
        let lights = (0..meta.lights.len()).map(|i| shown.light(i));
        let cameras = (0..meta.cameras.len()).map(|i| shown.camera(i));
        for name in lights.chain(cameras) {
            out.extend(name.bytes().take_while(|byte| *byte != 0).chain([0]));
        }
    }
    Some(out)
}

/// Decodes the section of a file with so many lights; `None` for bytes that are none.
pub(super) fn decode(bytes: &[u8], lights: usize) -> Option<Shown> {
    let (has_ground, rest) = bytes.split_first()?;
    let (ground, texts) = rest.split_at_checked(if *has_ground == 1 { GROUND } else { 0 })?;
    let ground = ground.split_at_checked(20).map(|(numbers, shade)| {
        let [height, x, z, right, back] = bytemuck::pod_read_unaligned(numbers);
        Ground { height, low: [x, z], high: [right, back], shade: shade.to_vec() }
    });
    let texts = std::str::from_utf8(texts).ok().filter(|texts| texts.is_empty() || texts.ends_with('\0'))?;
    let mut all: Vec<String> = texts.split_terminator('\0').map(str::to_owned).collect();
    let cameras = names(all.split_off(lights.min(all.len())));
    Some(Shown { lights: names(all), cameras, ground })
}

/// Whether there are as many names as lights and cameras, or none, and the ground's numbers can be used.
pub(super) fn is_sound(meta: &Meta) -> bool {
    let shown = &meta.shown;
    let fits = |names: &[String], count| names.is_empty() || names.len() == count;
    fits(&shown.lights, meta.lights.len())
        && fits(&shown.cameras, meta.cameras.len())
        && shown.ground.iter().all(|ground| {
            let ([x, z], [right, back]) = (ground.low, ground.high);
            let numbers = [ground.height, x, z, right, back];
            super::check::all_sane(&numbers) && x < right && z < back && ground.shade.len() == SIDE * SIDE
        })
}
