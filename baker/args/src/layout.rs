//! Arguments that `bake` and `solve` share: preset and layout of the functions.

use crate::number;
use clap::builder::RangedU64ValueParser;
use clap::{Args, ValueEnum};
use rebounce::bake::{BakeSettings, BakeSolver, Preset};
use rebounce::transport::Refinement;
use rebounce::transport::gloss::Transfer;
use rebounce_shared::rbn::MAX_LEVELS;
use std::ops::RangeInclusive;

/// Heading of the help.
pub const ADVANCED: &str = "Advanced: how functions are laid out";

/// Range of support radius over disk radius: under 1, functions leave gaps; beyond 4, hundreds of functions overlap.
const OVERLAPS: RangeInclusive<f32> = 1.0..=4.0;

/// Name of a preset.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum PresetName {
    /// To look at while arranging a scene: error under 0.15 against a path tracer in most scenes, in seconds
    Draft,
    /// To ship: error under 0.08 in most scenes (more where a lamp is close to a surface), in half a minute for a room on two cores
    Standard,
    /// For stills and close looks: error under 0.06 in most scenes, in some minutes
    Fine,
}

impl From<PresetName> for Preset {
    fn from(name: PresetName) -> Self {
        match name {
            PresetName::Draft => Preset::Draft,
            PresetName::Standard => Preset::Standard,
            PresetName::Fine => Preset::Fine,
        }
    }
}

/// Name of a solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SolverName {
    /// Links between all parts of the scene: lights move at once, things stand still
    Operator,
    /// Points alone, in a small file baked in seconds: things move, and light finds its way anew within seconds
    #[value(alias = "antiradiance")]
    Radiosity,
}

impl From<SolverName> for BakeSolver {
    fn from(name: SolverName) -> Self {
        match name {
            SolverName::Operator => BakeSolver::Operator,
            SolverName::Radiosity => BakeSolver::Radiosity,
        }
    }
}

/// What a file is shown in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PurposeName {
    /// A room or a landscape, whose lamps move
    Room,
    /// An object under any environment, turned and replaced at will: a small file, lit from all around
    Environment,
}

/// Name of a way in which bounced light comes to metals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TransferName {
    /// Links from the scene's surfaces: metals reflect a room that any lamp lights
    Links,
    /// Matrices from the environment: metals reflect what the environment lights
    Matrices,
}

impl From<TransferName> for Transfer {
    fn from(name: TransferName) -> Self {
        match name {
            TransferName::Links => Transfer::Links,
            TransferName::Matrices => Transfer::Matrices,
        }
    }
}

/// Name of a way to refine the operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RefinementName {
    /// Rows of links, each from one hemisphere of rays: the better picture for the same bytes or seconds
    Gather,
    /// Links one at a time, from coarse to fine at both ends
    Pairwise,
}

impl From<RefinementName> for Refinement {
    fn from(name: RefinementName) -> Self {
        match name {
            RefinementName::Gather => Refinement::Gather,
            RefinementName::Pairwise => Refinement::Pairwise,
        }
    }
}

/// Layout of the functions.
#[derive(Args, Debug)]
pub struct LayoutArgs {
    /// Levels of receivers
    #[arg(long, help_heading = ADVANCED, hide_short_help = true, value_parser = RangedU64ValueParser::<usize>::new().range(1..=MAX_LEVELS as u64))]
    levels: Option<usize>,
    /// Poisson-disk radius of the coarsest level, scene units; overrides --functions
    #[arg(long, help_heading = ADVANCED, hide_short_help = true, value_parser = number::over_zero_single)]
    coarse_radius: Option<f32>,
    /// Support over disk radius, coarsest level
    #[arg(long, help_heading = ADVANCED, hide_short_help = true, value_parser = |text: &str| number::within(text, OVERLAPS))]
    coarse_overlap: Option<f32>,
    /// Support over disk radius, finest level
    #[arg(long, help_heading = ADVANCED, hide_short_help = true, value_parser = |text: &str| number::within(text, OVERLAPS))]
    fine_overlap: Option<f32>,
    /// Seed of all random numbers
    #[arg(long, help_heading = ADVANCED, hide_short_help = true, default_value_t = 1)]
    seed: u64,
}

impl LayoutArgs {
    /// Puts the arguments in the place of a preset's values.
    pub fn apply(&self, settings: &mut BakeSettings) {
        let place = &mut settings.place;
        place.coarse_radius = self.coarse_radius;
        place.levels = self.levels.unwrap_or(place.levels);
        place.coarse_overlap = self.coarse_overlap.unwrap_or(place.coarse_overlap);
        place.fine_overlap = self.fine_overlap.unwrap_or(place.fine_overlap);
        place.seed = self.seed;
        settings.operator.seed = self.seed;
        settings.sources.seed = self.seed;
    }
}
