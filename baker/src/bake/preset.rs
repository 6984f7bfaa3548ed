//! Presets: named sets of parameters.

use crate::geometry::Surfaces;
use crate::job::Job;
use crate::job::communicator::CommunicatorError;
use crate::sampling::PlaceSettings;
use crate::transport::direct_to_indirect::DirectToIndirect;
use crate::transport::environment::TransferSettings;
use crate::transport::gloss::{GlossSettings, Transfer};
use crate::transport::sources::SourceSettings;
use crate::transport::{Operator, OperatorSettings, Partial, Problem, Refinement, Solver, Unlinked};
use rebounce_shared::camera::Camera;

/// Quality and cost of a bake.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// For arranging a scene; takes seconds.
    Draft,
    /// For publishing; takes half a minute for a room on two cores.
    #[default]
    Standard,
    /// For stills and close looks.
    Fine,
}

impl Preset {
    /// Returns the promised error against a path tracer ([`crate::verify::compare`]), an upper bound over rooms and
    /// halls that were not used for tuning.
    pub fn promised_error(self) -> f64 {
        match self {
            Preset::Draft => 0.15,
            Preset::Standard => 0.08,
            Preset::Fine => 0.06,
        }
    }

    /// Returns the preset's name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Preset::Draft => "draft",
            Preset::Standard => "standard",
            Preset::Fine => "fine",
        }
    }
}

/// What a file's bounced light is computed from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BakeSolver {
    /// Links: [`DirectToIndirect`].
    #[default]
    Operator,
    /// Points alone: [`Unlinked`].
    Radiosity,
}

/// What a file is shown in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Purpose {
    /// A room or a landscape: lamps move.
    #[default]
    Room,
    /// An object under any environment: a small file without links, whose light is that of the sky
    /// ([`keep_for_environment`](crate::transport::environment::keep_for_environment)).
    Environment,
}

impl<S: Surfaces + ?Sized> Solver<S> for BakeSolver {
    type Solution = Operator;

    async fn solve(
        &self,
        problem: &Problem<'_, S>,
        job: &Job<'_>,
        partial: &mut Partial<'_, Operator>,
    ) -> Result<Operator, CommunicatorError> {
        match self {
            Self::Operator => DirectToIndirect.solve(problem, job, partial).await,
            Self::Radiosity => Unlinked.solve(problem, job, partial).await,
        }
    }
}

/// All inputs of a bake besides the scene.
#[derive(Clone, Debug)]
pub struct BakeSettings {
    /// Preset of the initial values.
    pub preset: Preset,
    /// Start positions of importance particles, and of views in all directions, world space. Empty: the cameras, or a
    /// search of the scene.
    pub viewpoints: Vec<[f64; 3]>,
    /// Additional camera to place points for, besides the scene's cameras.
    pub camera: Option<Camera>,
    /// What bounced light is computed from.
    pub solver: BakeSolver,
    /// What the file is shown in.
    pub purpose: Purpose,
    /// How transfer from the environment is kept, where that is the purpose.
    pub transfer: TransferSettings,
    /// How points are placed.
    pub place: PlaceSettings,
    /// How the operator is computed.
    pub operator: OperatorSettings,
    /// How links from the sky and from emissive surfaces are computed.
    pub sources: SourceSettings,
    /// How glossy transfer is computed; `None` for none.
    pub gloss: Option<GlossSettings>,
    /// Number of levels, starting with the coarsest, whose points sample direct light; minimum: the sender levels. With
    /// more levels, the edge of a moving shadow sweeps more smoothly.
    pub direct_levels: usize,
}

impl BakeSettings {
    /// Returns the values of a preset.
    pub fn new(preset: Preset) -> Self {
        let (levels, functions, rays, epsilon, pooled_levels) = match preset {
            Preset::Draft => (5, 25_000, vec![2048, 2048, 1024, 1024, 512], 0.013, 3),
            Preset::Standard => (6, 120_000, vec![4096, 4096, 2048, 1024, 512, 512], 0.014, 4),
            Preset::Fine => (6, 250_000, vec![8192, 8192, 4096, 2048, 1024, 768], 0.008, 4),
        };
        Self {
            preset,
            viewpoints: Vec::new(),
            camera: None,
            solver: BakeSolver::default(),
            purpose: Purpose::default(),
            transfer: TransferSettings::default(),
            place: PlaceSettings { levels, functions, ..PlaceSettings::default() },
            operator: OperatorSettings {
                refinement: Refinement::default(),
                sender_levels: levels,
                epsilon,
                reflected: 1.0,
                rays,
                significance: 0.2,
                pooled_levels,
                bounces: None,
                later_levels: 3,
                far_levels: 0,
                levels,
                seed: 1,
            },
            sources: SourceSettings::default(),
            gloss: Some(GlossSettings::default()),
            direct_levels: levels,
        }
    }

    /// For an object under any environment: half of the functions, matrices of at most 12,000 glossy points a level.
    pub fn for_environment(mut self) -> Self {
        self.purpose = Purpose::Environment;
        self.place.functions /= 2;
        if let Some(gloss) = &mut self.gloss {
            gloss.transfer = Transfer::Matrices;
            gloss.most = 12_000;
        }
        self
    }

    /// Adapts the values to `levels` levels, or the current number if greater. The added coarse levels use the coarsest
    /// level's rays and take part in later bounces.
    pub(super) fn deepened(mut self, levels: usize) -> Self {
        let more = levels.saturating_sub(self.place.levels);
        let coarsest = self.operator.rays_on(0);
        self.operator.rays.splice(0..0, std::iter::repeat_n(coarsest, more));
        self.place.levels += more;
        self.operator.sender_levels += more;
        self.operator.later_levels += more;
        self.operator.far_levels += more;
        self.direct_levels += more;
        self.normalised()
    }

    /// Makes the values consistent: clamps sender, later and direct levels to the number of levels.
    pub fn normalised(mut self) -> Self {
        let levels = self.place.levels.max(1);
        if self.solver == BakeSolver::Radiosity {
            self.operator.rays = vec![0];
        }
        self.place.levels = levels;
        self.operator.levels = levels;
        self.operator.sender_levels = self.operator.sender_levels.clamp(1, levels);
        self.operator.later_levels = self.operator.later_levels.min(self.operator.sender_levels);
        self.direct_levels = self.direct_levels.clamp(self.operator.sender_levels, levels);
        self
    }
}
