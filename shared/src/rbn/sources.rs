//! Sources of light with links of their own: section `SRCS`, bincode 2 standard configuration, and section `SRCL`, rows
//! of links from the sources to all points. Optional: readers without support show the scene without their light.
//!
//! Senders of the rows, in order: the [bins](crate::environment::bins) of the sky, if any; then the groups, a sender for
//! a group of one colour, and a sender for each channel of a coloured group.

use super::limits::MAX_BYTES;
use super::{RbnError, small};
use crate::environment::bins::BINS;
use bincode::{Decode, Encode};
use glam::Vec3;

/// Greatest number of groups.
pub const MAX_GROUPS: usize = 1 << 11;
/// Greatest size of the default environment, bytes.
pub const MAX_ENVIRONMENT: usize = 64 << 10;

/// Sources of a file.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct Sources {
    /// Whether the points have links from the sky.
    pub has_sky: bool,
    /// Irradiance of one [step](crate::link::SourceLink) per unit radiance of a bin of the sky.
    pub sky_step: f32,
    /// Groups of emissive surfaces.
    pub groups: Vec<EmissiveGroup>,
    /// Default environment, [packed](crate::environment::packed); empty for none.
    pub environment: Vec<u8>,
}

/// Group of emissive surfaces: one light, which changes in strength and colour.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct EmissiveGroup {
    /// Name.
    pub name: String,
    /// Indices of the materials, ascending.
    pub materials: Vec<u32>,
    /// Irradiance of one [step](crate::link::SourceLink) by channel, linear RGB, W/m².
    pub step: [f32; 3],
    /// Whether parts of the group differ in colour: links by channel.
    pub is_coloured: bool,
}

impl EmissiveGroup {
    /// Number of senders.
    pub fn senders(&self) -> usize {
        if self.is_coloured { 3 } else { 1 }
    }
}

impl Sources {
    /// Number of senders.
    pub fn count(&self) -> usize {
        self.sky_bins() + self.groups.iter().map(EmissiveGroup::senders).sum::<usize>()
    }

    /// Number of senders that are bins of the sky.
    pub fn sky_bins(&self) -> usize {
        if self.has_sky { BINS } else { 0 }
    }

    /// Returns the group of each material; `None` without emission. Materials beyond the end have none.
    pub fn group_of_materials(&self) -> Vec<Option<u32>> {
        let materials = self.groups.iter().flat_map(|group| &group.materials).max();
        let mut out = vec![None; materials.map_or(0, |most| *most as usize + 1)];
        for (number, group) in (0u32..).zip(&self.groups) {
            group.materials.iter().for_each(|material| out[*material as usize] = Some(number));
        }
        out
    }

    /// Returns the strength of each sender, linear RGB: irradiance of a point is the sum of its links' steps times
    /// strengths. `sky` is the radiance of the bins, `emission` the factor of each group.
    pub fn strengths(&self, sky: Option<&[Vec3; BINS]>, emission: &[Vec3]) -> Vec<Vec3> {
        let mut out = Vec::with_capacity(self.count());
        out.extend(sky.into_iter().flatten().take(self.sky_bins()).map(|radiance| *radiance * self.sky_step));
        out.resize(self.sky_bins(), Vec3::ZERO);
        for (number, group) in self.groups.iter().enumerate() {
            let strength = Vec3::from(group.step) * emission.get(number).copied().unwrap_or(Vec3::ONE);
            if group.is_coloured {
                out.extend(Vec3::AXES.map(|axis| axis * strength));
            } else {
                out.push(strength);
            }
        }
        out
    }
}

/// Encodes section `SRCS`; `None` without sources.
///
/// # Errors
/// [`RbnError::TooLarge`] past [`MAX_BYTES`].
pub fn encode(sources: &Sources) -> Result<Option<Vec<u8>>, RbnError> {
    if *sources == Sources::default() {
        return Ok(None);
    }
    let too_large = || format!("groups of shining surfaces need over {MAX_BYTES} bytes: merge some");
    small::encode(sources, too_large).map(Some)
}

/// Decodes section `SRCS`; the caller checks it.
///
/// # Errors
/// [`RbnError::Invalid`].
pub fn decode(bytes: &[u8]) -> Result<Sources, RbnError> {
    small::decode("SRCS", bytes)
}

/// Checks sources of unknown origin.
///
/// # Errors
/// [`RbnError::Invalid`].
pub(crate) fn check(sources: &Sources, materials: usize) -> Result<(), RbnError> {
    let mut used = vec![false; materials];
    let mut is_free =
        |material: &u32| used.get_mut(*material as usize).is_some_and(|used| !std::mem::replace(used, true));
    let is_sound = sources.groups.len() <= MAX_GROUPS
        && sources.environment.len() <= MAX_ENVIRONMENT
        && sources.groups.iter().all(|group| {
            group.materials.iter().all(&mut is_free)
                && group.step.iter().chain([&sources.sky_step]).all(|x| super::limits::sane(*x) && *x >= 0.0)
        });
    if is_sound {
        Ok(())
    } else {
        Err(RbnError::invalid("SRCS", "a group of shining surfaces, or the environment"))
    }
}
