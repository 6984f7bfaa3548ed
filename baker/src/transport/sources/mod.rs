//! Sources of light that stay in place and change in strength and colour: the bins of the sky, and groups of emissive
//! surfaces.
//!
//! Sources are further senders of the operator (paper, Eq. 16): a link holds the irradiance of a point per unit strength
//! of a source, as difference from the prediction by the point's parents. What the sources give to a point directly is
//! also what the point sends on, so that the operator between points carries all later bounces of it unchanged.
//!
//! * [`sky`] – irradiance from the bins of the sky; [`emission`] – from emissive surfaces, by samples of an
//!   [`emitter_tree`] and of [triangles](triangle_sampling), from closed forms (`unoccluded`) and visibility
//!   (`group_seen`);
//! * [`refine`] – the links, level by level; `quantize` – from differences to links; `level` and `messages` –
//!   receivers as parts, and their results as bytes, for processes and workers that share a bake.

pub mod emission;
pub mod emitter_tree;
mod group_seen;
mod level;
mod messages;
mod quantize;
pub mod refine;
pub mod sky;
pub mod triangle_sampling;
mod unoccluded;

pub use refine::{SourceGather, SourceLinks};

use crate::geometry::Emitters;
use glam::Vec3;
use rebounce_shared::rbn::sources::EmissiveGroup;

/// Settings of the sources' links.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceSettings {
    /// Whether links from the sky are computed, where it is seen.
    pub sky: bool,
    /// ε on the finest level, as a share of the mean irradiance from the source; coarser levels use a smaller ε.
    pub epsilon: f32,
    /// Visibility rays to emitters per receiver, on the coarsest and on the finest level.
    pub emitter_rays: [u32; 2],
    /// Least ratio of a difference to the standard deviation of its own noise.
    pub significance: f32,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Default for SourceSettings {
    fn default() -> Self {
        Self { sky: true, epsilon: 0.02, emitter_rays: [256, 32], significance: 1.0, seed: 1 }
    }
}

/// Greatest difference of a group's colour from its mean, as a share of the mean, for links of one amount for all
/// channels.
const EVEN: f32 = 0.02;

/// Places of a triangle at which its colour is read: barycentric weights.
const SAMPLES: [[f32; 3]; 4] = [[0.34, 0.33, 0.33], [0.8, 0.1, 0.1], [0.1, 0.8, 0.1], [0.1, 0.1, 0.8]];

/// Returns the greatest radiance of each group by channel, and whether the group is of one colour, from samples of the
/// emissive triangles.
pub fn describe_groups(
    emitters: &dyn Emitters,
    group_of: &[Option<u32>],
    groups: &mut [EmissiveGroup],
) -> Vec<Vec3> {
    let mut most = vec![Vec3::ZERO; groups.len()];
    let samples = |visit: &mut dyn FnMut(usize, Vec3)| {
        for number in 0..emitters.emitter_count() {
            let emitter = emitters.emitter(number as u32);
            let Some(Some(group)) = group_of.get(emitter.material as usize) else { continue };
            visit(*group as usize, emitter.mean);
            let inwards = -emitter.front().normalize_or_zero();
            for weights in SAMPLES {
                visit(*group as usize, emitters.radiance(number as u32, weights, inwards));
            }
        }
    };
    samples(&mut |group, radiance| most[group] = most[group].max(radiance));
    let mut is_even = vec![true; groups.len()];
    samples(&mut |group, radiance| {
        // A shade of one colour is a multiple of the greatest radiance.
        let most = most[group];
        let share = radiance.max_element() / most.max_element().max(f32::MIN_POSITIVE);
        is_even[group] &= (radiance - share * most).abs().max_element() <= EVEN * most.max_element();
    });
    groups.iter_mut().zip(is_even).for_each(|(group, is_even)| group.is_coloured = !is_even);
    most
}
