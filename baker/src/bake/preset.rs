//! Presets: one word for a whole set of parameters.

use crate::sampling::PlaceSettings;
use crate::transport::direct_to_indirect::OperatorSettings;
use rebounce_shared::camera::Camera;

/// How good and how costly a bake is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// To look at while arranging a scene, in seconds.
    Draft,
    /// To ship, in a minute or two for a room on two cores.
    #[default]
    Standard,
    /// For stills and close looks.
    Fine,
}

impl Preset {
    /// The error against a path tracer that it is made for ([`crate::picture::compare`]): what rooms and
    /// halls stay under that were not chosen for it.
    pub fn promised_error(self) -> f64 {
        match self {
            Preset::Draft => 0.15,
            Preset::Standard => 0.08,
            Preset::Fine => 0.06,
        }
    }

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Preset::Draft => "draft",
            Preset::Standard => "standard",
            Preset::Fine => "fine",
        }
    }
}

/// Everything that a bake is told besides the scene.
#[derive(Clone, Debug)]
pub struct BakeSettings {
    /// The preset that the other values started from.
    pub preset: Preset,
    /// Where importance particles start and what is looked at from there, all around, world space; empty: the
    /// cameras, or found.
    pub viewpoints: Vec<[f64; 3]>,
    /// A camera that points are placed for besides the scene's.
    pub camera: Option<Camera>,
    /// How points are placed.
    pub place: PlaceSettings,
    /// How the operator is computed.
    pub operator: OperatorSettings,
    /// Direct light is sampled at the points of this many levels, at least the sender levels.
    /// More levels: a moving shadow's edge sweeps more smoothly.
    pub direct_levels: usize,
}

impl BakeSettings {
    /// A preset's values.
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
            place: PlaceSettings { levels, functions, ..PlaceSettings::default() },
            operator: OperatorSettings {
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
            direct_levels: levels,
        }
    }

    /// Values for so many levels, at least those there are: further coarse ones that light bounces between like the coarsest.
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

    /// Makes the values fit each other: sender and direct levels within the levels there are.
    pub fn normalised(mut self) -> Self {
        let levels = self.place.levels.max(1);
        self.place.levels = levels;
        self.operator.levels = levels;
        self.operator.sender_levels = self.operator.sender_levels.clamp(1, levels);
        self.operator.later_levels = self.operator.later_levels.min(self.operator.sender_levels);
        self.direct_levels = self.direct_levels.clamp(self.operator.sender_levels, levels);
        self
    }
}
