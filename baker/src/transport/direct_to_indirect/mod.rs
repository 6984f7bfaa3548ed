//! The direct-to-indirect operator S (paper, section 3).
//!
//! * [`reflected`] – how bright the scene is, which ε is a share of;
//! * [`tint`] – the senders' colours;
//! * [`directions`] – the rays of one hemispherical gather;
//! * [`hemisphere`] – a receiver's rays;
//! * [`tiles`] – what rays find, worked out beforehand;
//! * [`order`] – the order in which they are cast;
//! * [`found`] – what those of some receivers find;
//! * [`gather`] – Eq. 16 for one receiver and all senders, and Eq. 17's differences;
//! * [`tally`] – what a gather sums up, by sender;
//! * [`pool`] – what neighbours share;
//! * [`sparsify`] – which of it becomes a link;
//! * [`bytes`] – what is done, as bytes;
//! * [`journal`] – where what is done is kept, to go on from;
//! * [`refine`] – the adaptive queue of Fig. 5: the one-bounce operator T;
//! * [`among`] – what the coarse points get from each other;
//! * [`bounces`] – later bounces: S, by the [`series`] of bounces between coarse points.

pub mod accumulator;
pub mod bounces;
pub mod bytes;
mod coarse_matrix;
pub mod directions;
pub mod gather;
pub mod gather_batch;
pub mod gather_context;
pub mod hemisphere;
pub mod hit_cache;
pub mod journal;
pub mod mean_albedo;
pub mod neighbourhood;
pub mod ray_sort;
pub mod refine;
pub mod series;
mod sparsify;
pub mod tint;

use accumulator::IrradianceRow;
use coarse_matrix::among;
use rebounce_shared::link::{LaterLink, Link};

/// How the operator is computed.
#[derive(Clone, Debug, PartialEq)]
pub struct OperatorSettings {
    /// Senders are the functions of this many coarsest levels; direct light is sent by the finest
    /// of them that covers a place.
    pub sender_levels: usize,
    /// ε on the finest level, as a share of [`Self::reflected`]: links whose magnitude (irradiance per
    /// unit irradiance) is under it are given to a neighbour. Smaller on coarser levels: see
    /// [`Self::epsilon_on`].
    pub epsilon: f32,
    /// The share of light that the scene's surfaces pass on to each other
    /// ([`mean_albedo::reflected_share`]); 1 for an absolute ε. Bounced light is weaker in a dark scene,
    /// and so are the links that make it up.
    pub reflected: f32,
    /// Levels that `epsilon` counts from.
    pub levels: usize,
    /// Rays per receiver, by level; the last entry holds for all finer levels.
    pub rays: Vec<u32>,
    /// Links under this many standard deviations of their own Monte Carlo noise are dropped; of as many more as a receiver of the
    /// [pooled levels](Self::pooled_levels) is [bare](neighbourhood::Row::strictness).
    pub significance: f32,
    /// Finest levels whose receivers [share](pool) what their rays find; never the coarsest level.
    pub pooled_levels: usize,
    /// Bounces of light; `None`: all.
    pub bounces: Option<u32>,
    /// Light that bounced is gathered and sent on by the functions of this many coarsest levels,
    /// at most the sender levels.
    pub later_levels: usize,
    /// Coarsest levels whose receivers all gather, whether their parents receive anything: functions that are as large as a house
    /// reach through it, and what one storey does not see another may.
    pub far_levels: usize,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// ε of a level over that of the next finer one: the same squared error for the same number of links. Measured on two
/// scenes (links, error): 0.5 gives 2.8 M, 0.059 and 3.8 M, 0.073; 0.65 gives 2.0 M, 0.063 and 2.6 M, 0.082, and with ε
/// smaller by a fifth 2.6 M, 0.065 and 3.2 M, 0.079.
const COARSER: f32 = 0.5;

/// ε of the links for later bounces over that of the finest level's. With 1 the errors of five scenes are the same within 0.001,
/// and files are larger by 4 to 40%.
const LATER: f32 = 3.0;

/// Receivers of a chunk; more where they share what they find, so that few of them lie at an edge.
const CHUNK: [usize; 2] = [64, 512];

impl OperatorSettings {
    /// ε on a level, irradiance per unit irradiance: smaller on coarser levels, whose dropped links are errors over
    /// larger supports ([`COARSER`]).
    pub fn epsilon_on(&self, level: usize) -> f32 {
        let coarser = (self.levels.max(1) - 1).saturating_sub(level);
        self.epsilon * self.reflected * COARSER.powi(coarser as i32)
    }

    /// The least entry of a row of irradiance between coarse functions, which all of a scene's later
    /// bounces go through: a smaller one is given to a neighbour.
    pub fn least_irradiance(&self) -> f32 {
        self.epsilon * self.reflected / 8.0
    }

    /// ε of the links for later bounces, larger than the first bounce's: a receiver averages over its whole hemisphere ([`LATER`]).
    pub fn epsilon_later(&self) -> f32 {
        LATER * self.epsilon * self.reflected
    }

    /// Whether receivers of a level share what their rays find.
    pub fn is_pooled(&self, level: usize) -> bool {
        level > 0 && level + self.pooled_levels >= self.levels
    }

    /// Receivers of a level that one thread gathers for one after another, and that are kept together.
    pub fn chunk_on(&self, level: usize) -> usize {
        CHUNK[self.is_pooled(level) as usize]
    }

    /// Rays per receiver on a level.
    pub fn rays_on(&self, level: usize) -> u32 {
        self.rays.get(level).or(self.rays.last()).copied().unwrap_or(512)
    }
}

/// The operator: links by receiver, and what it took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Operator {
    /// For every point its links, senders ascending; empty where it receives nothing of its own. They carry what the
    /// senders hold, direct light and bounced light alike: T.
    pub links: Vec<Vec<Link>>,
    /// The colour that each point's surface gives to light, rgb9e5.
    pub tints: Vec<u32>,
    /// For every point of the coarse levels its whole irradiance from every other, what later bounces are made
    /// of; not part of the file.
    pub coarse: Vec<IrradianceRow>,
    /// For every point of the coarse levels its links for light that bounces again, between such points: H.
    pub later: Vec<Vec<LaterLink>>,
    /// Rays cast.
    pub rays: u64,
    /// Receivers whose links were computed.
    pub receivers: u64,
    /// Share of the reflected light that no sender's function covers, and that is lost.
    pub lost_share: f64,
    /// Share of the reflected light that links leave out where all senders are lit alike; negative where they add to it.
    /// Later bounces lose it once a bounce.
    pub link_loss: f64,
    /// Bounces that the operator holds; where all are wanted, those followed until the light settled.
    pub bounces: u32,
}

impl Operator {
    /// Number of links of each point of T.
    pub fn link_counts(&self) -> impl Iterator<Item = usize> + '_ {
        self.links.iter().map(Vec::len)
    }

    /// Number of links for later bounces.
    pub fn later_count(&self) -> usize {
        self.later.iter().map(Vec::len).sum()
    }

    /// Number of entries that later bounces are made of: those of [`coarse`](Self::coarse).
    pub fn coarse_count(&self) -> usize {
        self.coarse.iter().map(Vec::len).sum()
    }
}
