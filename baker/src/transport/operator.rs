//! The sparse operator from direct to indirect irradiance, and the settings of its computation.

use glam::Vec3;
use rebounce_shared::colour::pack_rgb9e5;
use rebounce_shared::link::{LaterLink, Link};

/// Irradiance of a receiver from other points: (sender, irradiance per unit irradiance), senders ascending.
pub type IrradianceRow = Vec<(u32, f32)>;

/// How the one-bounce operator is refined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Refinement {
    /// [Adaptive gather](super::direct_to_indirect::refine) of whole rows (Lehtinen et al. 2008, Fig. 5).
    #[default]
    Gather,
    /// [Pairwise links](super::direct_to_indirect::pairwise), one at a time (Lehtinen et al. 2007, 6.5). Feature `pairwise`.
    #[cfg(feature = "pairwise")]
    Pairwise,
}

/// Settings of the operator's computation.
#[derive(Clone, Debug, PartialEq)]
pub struct OperatorSettings {
    /// How the one-bounce operator is refined.
    pub refinement: Refinement,
    /// Number of coarsest levels whose functions are senders. Direct light leaves from the finest
    /// sender level that covers a place.
    pub sender_levels: usize,
    /// ε on the finest level, as a share of [`Self::reflected`]. A link with magnitude (irradiance
    /// per unit irradiance) below ε is merged into a neighbour's link. Coarser levels use a smaller
    /// ε: see [`Self::epsilon_on`].
    pub epsilon: f32,
    /// Share of light that the scene's surfaces reflect to other surfaces
    /// ([mean albedo](super::direct_to_indirect::mean_albedo)); 1 for an absolute ε. In a dark scene bounced light and
    /// its links are weaker.
    pub reflected: f32,
    /// Number of levels; `epsilon` applies to level `levels - 1`.
    pub levels: usize,
    /// Rays per receiver, by level; the last entry applies to all finer levels.
    pub rays: Vec<u32>,
    /// Least ratio of a link to the standard deviation of its own Monte Carlo noise; weaker links
    /// are dropped. On [pooled levels](Self::pooled_levels) the ratio is multiplied by the
    /// receiver's strictness, which is higher on bare surfaces.
    pub significance: f32,
    /// Number of finest levels whose receivers share gathered differences with their neighbours; never
    /// includes the coarsest level.
    pub pooled_levels: usize,
    /// Number of bounces of light; `None` for all bounces.
    pub bounces: Option<u32>,
    /// Number of coarsest levels whose points gather bounced light and send it on (later bounces);
    /// at most `sender_levels`.
    pub later_levels: usize,
    /// Number of coarsest levels with unconditional gathering: receivers are refined even if the
    /// parents have no links. A function as large as a house reaches through the house, and light
    /// that is hidden from a receiver on one storey may reach a receiver on the next. If not 0, the
    /// next finer level gathers unconditionally, too.
    pub far_levels: usize,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// Ratio of a level's ε to ε of the next finer level: equal squared error for an equal number of
/// links. Measured on two scenes (links, error): 0.5: 2.8 M, 0.059 and 3.8 M, 0.073; 0.65: 2.0 M,
/// 0.063 and 2.6 M, 0.082; 0.65 with ε smaller by a fifth: 2.6 M, 0.065 and 3.2 M, 0.079.
pub(super) const COARSER: f32 = 0.5;

/// Ratio of ε for later-bounce links to ε of the finest level. With 1 the errors of five scenes are
/// equal within 0.001, and files are larger by 4 to 40%.
const LATER: f32 = 3.0;

/// Receivers per chunk: on levels without pooling, and on pooled levels (more, so that few
/// receivers are at a chunk's edge).
const CHUNK: [usize; 2] = [64, 512];

impl OperatorSettings {
    /// ε on a level, irradiance per unit irradiance. Smaller on coarser levels, because their
    /// dropped links are errors over larger supports ([`COARSER`]).
    pub fn epsilon_on(&self, level: usize) -> f32 {
        let coarser = (self.levels.max(1) - 1).saturating_sub(level);
        self.epsilon * self.reflected * COARSER.powi(coarser as i32)
    }

    /// Least entry of a row of irradiance between coarse functions, from which all later bounces
    /// are computed. A smaller entry is carried over to the next sender.
    pub fn least_irradiance(&self) -> f32 {
        self.epsilon * self.reflected / 8.0
    }

    /// ε of the links for later bounces. Larger than ε of the first bounce ([`LATER`]), because a
    /// receiver averages over its hemisphere.
    pub fn epsilon_later(&self) -> f32 {
        LATER * self.epsilon * self.reflected
    }

    /// Whether receivers of a level share gathered differences with neighbours.
    pub fn is_pooled(&self, level: usize) -> bool {
        level > 0 && level + self.pooled_levels >= self.levels
    }

    /// Receivers per chunk of a level. A chunk is gathered by a single thread and stored as a unit.
    pub fn chunk_on(&self, level: usize) -> usize {
        CHUNK[self.is_pooled(level) as usize]
    }

    /// Rays per receiver on a level.
    pub fn rays_on(&self, level: usize) -> u32 {
        self.rays.get(level).or(self.rays.last()).copied().unwrap_or(512)
    }
}

/// The operator as links by receiver, with statistics of the computation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Operator {
    /// T: links of every point, senders ascending; empty for a point without links of its own.
    /// Links carry the senders' direct and bounced light.
    pub links: Vec<Vec<Link>>,
    /// Colour of the light that each point's surface reflects, rgb9e5.
    pub tints: Vec<u32>,
    /// Mean reflectance of each point's surface, in 255ths; empty where nobody needs it.
    pub reflectance: Vec<u8>,
    /// C: total irradiance of every coarse point from every other coarse point, the input of later
    /// bounces. Not stored in the file.
    pub coarse: Vec<IrradianceRow>,
    /// H: links of every coarse point for light that bounces again between coarse points.
    pub later: Vec<Vec<LaterLink>>,
    /// Share of light that the scene's surfaces reflect to other surfaces, the unit of ε; 0 without ε.
    pub reflected: f32,
    /// Number of rays cast.
    pub rays: u64,
    /// Number of receivers that were gathered for.
    pub receivers: u64,
    /// Share of the reflected light that is lost because no sender's function covers the hit.
    pub lost_share: f64,
    /// Share of the reflected light that the links lose under uniform lighting of all senders;
    /// negative for a gain. Later bounces lose this share at every bounce.
    pub link_loss: f64,
    /// Number of bounces that the operator contains; without a limit, the number computed until
    /// convergence.
    pub bounces: u32,
}

impl Operator {
    /// No bounced light between so many points, whose surfaces are grey.
    pub fn without_links(points: usize) -> Self {
        Self {
            links: vec![Vec::new(); points],
            tints: vec![pack_rgb9e5(Vec3::ONE); points],
            ..Self::default()
        }
    }

    /// Number of links of each point in T.
    pub fn link_counts(&self) -> impl Iterator<Item = usize> + '_ {
        self.links.iter().map(Vec::len)
    }

    /// Number of links for later bounces.
    pub fn later_count(&self) -> usize {
        self.later.iter().map(Vec::len).sum()
    }

    /// Number of entries of the coarse matrix [`coarse`](Self::coarse), the input of later bounces.
    pub fn coarse_count(&self) -> usize {
        self.coarse.iter().map(Vec::len).sum()
    }
}
