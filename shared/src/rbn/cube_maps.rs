//! Cube maps: the surfaces that are seen from places near metals, for pictures to light. Optional sections; readers without
//! support reflect by glossy transfer.
//!
//! | section | contents |
//! |---|---|
//! | `CMLY` | [`CubeMapLayout`], bincode 2 standard configuration |
//! | `CMTX` | [texels](CubeTexel), map after map, in the order of [`Cube`](crate::cube_map::cube::Cube) |
//!
//! ```text
//! CubeTexel: 12 bytes   bits  0..15  distance d: near (far / near)^((d − 1) / 65534); 0 where nothing is seen
//!                       bits 16..23  unit normal, octahedral: x, 127 for 0 and 254 for 1
//!                       bits 24..31  y, likewise
//!                       bytes 4..6   reflectance, RGB: the root in 255ths
//!                       byte 7       roughness of a metal: 1 + 254 r; 0 of what is not metal
//!                       u16 at 8     group of emissive surfaces plus one; 0 where nothing shines
//!                       u16 at 10    reconstruction group
//! ```

use super::codec::columns::{Columns, Kind};
use super::limits::{all_sane, sane};
use super::{RbnError, small};
use crate::elementary::Elementary;
use crate::octahedral::{pack_bytes, unpack_bytes};
use bincode::{Decode, Encode};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Maximum number of maps: a texture has 256 layers.
pub const MAX_MAPS: usize = 42;
/// Maximum number of texels along an edge.
pub const MAX_SIDE: u32 = 256;

/// Code of the farthest distance, and of the nearest.
const FARTHEST: f32 = 65_535.0;
const NEAREST: f32 = 1.0;
/// Codes of all roughnesses.
const ROUGHNESS: f32 = 254.0;

/// Places and sizes of the maps.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct CubeMapLayout {
    /// Texels along an edge of a face; a power of two.
    pub side: u32,
    /// Least and greatest distance of what is seen, scene units.
    pub range: [f32; 2],
    /// By map, its place, local space.
    pub places: Vec<[f32; 3]>,
}

/// A surface as a texel sees it; see the module's head for the bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct CubeTexel {
    /// Distance and normal.
    pub geometry: u32,
    /// Reflectance and roughness.
    pub reflectance: u32,
    /// Groups.
    pub groups: u32,
}

impl Columns for CubeTexel {
    const KINDS: &'static [Kind] = &[Kind::Number; 3];
}

/// A surface before it is packed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenSurface {
    /// Distance from the map's place, scene units.
    pub distance: f32,
    /// Unit normal, on the side that is seen.
    pub normal: Vec3,
    /// Reflectance, linear RGB, 0 to 1.
    pub reflectance: Vec3,
    /// Roughness of a metal.
    pub metal: Option<f32>,
    /// Group of emissive surfaces.
    pub emitter: Option<u32>,
    /// Reconstruction group.
    pub group: u32,
}

impl CubeTexel {
    /// Packs a surface.
    pub fn pack(layout: &CubeMapLayout, surface: &SeenSurface) -> Self {
        let [near, far] = layout.range;
        let octaves = (far / near).max(1.0).logarithm2();
        let share = match octaves > 0.0 {
            true => (surface.distance / near).max(1.0).logarithm2() / octaves,
            false => 0.0,
        };
        let distance = (NEAREST + (FARTHEST - NEAREST) * share).round().clamp(NEAREST, FARTHEST);
        let byte = |x: f32| x.clamp(0.0, 255.0) as u32;
        let root = |x: f32| byte((x.clamp(0.0, 1.0).sqrt() * 255.0).round());
        let [red, green, blue] = surface.reflectance.to_array().map(root);
        let metal = surface.metal.map_or(0, |roughness| byte((1.0 + ROUGHNESS * roughness).round()).max(1));
        Self {
            geometry: distance as u32 | pack_bytes(surface.normal) << 16,
            reflectance: red | green << 8 | blue << 16 | metal << 24,
            groups: surface.emitter.map_or(0, |group| group + 1) & 0xffff | surface.group << 16,
        }
    }

    /// Distance from the map's place, scene units; infinite where nothing is seen.
    pub fn distance(self, layout: &CubeMapLayout) -> f32 {
        let [near, far] = layout.range;
        match self.geometry & 0xffff {
            0 => f32::INFINITY,
            code => {
                let share = (code as f32 - NEAREST) / (FARTHEST - NEAREST);
                near * (share * (far / near).max(1.0).logarithm2()).exponential2()
            }
        }
    }

    /// Unit normal, on the side that is seen.
    pub fn normal(self) -> Vec3 {
        unpack_bytes(self.geometry >> 16)
    }

    /// Reflectance, linear RGB.
    pub fn reflectance(self) -> Vec3 {
        let root = |shift: u32| (self.reflectance >> shift & 255) as f32 / 255.0;
        Vec3::new(root(0), root(8), root(16)).map(|x| x * x)
    }

    /// Roughness of a metal; `None` of what is not.
    pub fn metal(self) -> Option<f32> {
        (self.reflectance >> 24).checked_sub(1).map(|code| code as f32 / ROUGHNESS)
    }

    /// Group of emissive surfaces.
    pub fn emitter(self) -> Option<usize> {
        (self.groups & 0xffff).checked_sub(1).map(|group| group as usize)
    }

    /// Reconstruction group.
    pub fn group(self) -> u32 {
        self.groups >> 16
    }
}

/// Cube maps of a file; empty if it has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CubeMaps {
    /// Places and sizes.
    pub layout: CubeMapLayout,
    /// Map after map.
    pub texels: Vec<CubeTexel>,
}

impl CubeMaps {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.texels.is_empty()
    }
}

/// Encodes section `CMLY`.
///
/// # Errors
/// [`RbnError::TooLarge`] past [`MAX_BYTES`](super::limits::MAX_BYTES).
pub fn encode(layout: &CubeMapLayout) -> Result<Vec<u8>, RbnError> {
    small::encode(layout, || "there are too many cube maps".to_owned())
}

/// Decodes section `CMLY`; the caller checks it.
///
/// # Errors
/// [`RbnError::Invalid`].
pub fn decode(bytes: &[u8]) -> Result<CubeMapLayout, RbnError> {
    small::decode("CMLY", bytes)
}

/// Checks cube maps of unknown origin, for a file with so many glossy links, emissive and reconstruction groups.
///
/// # Errors
/// [`RbnError::Invalid`].
pub(crate) fn check(maps: &CubeMaps, [links, emitters, groups]: [usize; 3]) -> Result<(), RbnError> {
    if *maps == CubeMaps::default() {
        return Ok(());
    }
    if links == 0 {
        return Err(RbnError::invalid("CMLY", "a file without glossy links has no cube maps"));
    }
    let CubeMapLayout { side, range: [near, far], places } = &maps.layout;
    if !side.is_power_of_two() || *side > MAX_SIDE {
        return Err(RbnError::invalid("CMLY", "the side is not a power of two, or too large"));
    }
    if places.is_empty() || places.len() > MAX_MAPS || !places.iter().all(|place| all_sane(place)) {
        return Err(RbnError::invalid("CMLY", "number or places of the maps"));
    }
    if !(*near > 0.0 && near <= far && sane(*far)) {
        return Err(RbnError::invalid("CMLY", "distances"));
    }
    if maps.texels.len() != places.len() * 6 * (*side as usize).pow(2) {
        return Err(RbnError::invalid("CMTX", "it does not fit the maps"));
    }
    let fits = |texel: &CubeTexel| {
        texel.emitter().is_none_or(|emitter| emitter < emitters) && (texel.group() as usize) < groups
    };
    if !maps.texels.iter().all(fits) {
        return Err(RbnError::invalid("CMTX", "a group is out of range"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn a_texel_holds_a_surface() {
        let layout = CubeMapLayout { side: 8, range: [0.02, 150.0], places: vec![[0.0; 3]] };
        let mut stream = Stream::new(6, 6);
        for i in 0..2000 {
            let surface = SeenSurface {
                distance: 0.02 * 7500f32.powf(stream.unit()),
                normal: stream.sphere(),
                reflectance: Vec3::new(stream.unit(), stream.unit(), stream.unit()),
                metal: (i % 2 == 0).then(|| stream.unit()),
                emitter: (i % 3 == 0).then_some(i),
                group: i % 5,
            };
            let texel = CubeTexel::pack(&layout, &surface);
            assert!((texel.distance(&layout) / surface.distance - 1.0).abs() < 1e-4);
            assert!(texel.normal().angle_between(surface.normal).to_degrees() < 0.9);
            assert!((texel.reflectance() - surface.reflectance).abs().max_element() < 0.005);
            assert_eq!(texel.metal().is_some(), surface.metal.is_some());
            assert!((texel.metal().unwrap_or(0.0) - surface.metal.unwrap_or(0.0)).abs() < 0.005);
            assert_eq!(texel.emitter(), surface.emitter.map(|group| group as usize));
            assert_eq!(texel.group(), surface.group);
        }
        assert_eq!(CubeTexel::default().distance(&layout), f32::INFINITY);
    }

    #[test]
    fn maps_that_do_not_fit_are_refused() {
        let layout = CubeMapLayout { side: 4, range: [0.1, 1.0], places: vec![[1.0, 2.0, 3.0]] };
        let good = CubeMaps { texels: vec![CubeTexel::default(); 96], layout };
        assert!(check(&good, [1, 0, 1]).is_ok() && check(&CubeMaps::default(), [0; 3]).is_ok());
        let changes: [fn(&mut CubeMaps); 6] = [
            |maps| maps.layout.side = 3,
            |maps| maps.layout.range = [0.0, 1.0],
            |maps| maps.layout.places[0][1] = f32::NAN,
            |maps| maps.texels.truncate(95),
            |maps| maps.texels[5].groups = 1,
            |maps| maps.texels[5].groups = 1 << 16,
        ];
        for (i, change) in changes.into_iter().enumerate() {
            let mut bad = good.clone();
            change(&mut bad);
            assert!(check(&bad, [1, 0, 1]).is_err(), "{i}");
        }
        assert!(check(&good, [0, 0, 1]).is_err());
    }
}
