//! What a bake tells while it runs, and what it can be told.

use rebounce_shared::baked::BakedScene;

/// How far a bake is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// What is being done.
    pub stage: Stage,
    /// Level of points that it is about, where it is about one.
    pub level: Option<usize>,
    /// Units done of this stage on this level.
    pub done: u64,
    /// Units of this stage on this level, as far as that is known.
    pub total: u64,
    /// Rays a second of the operator's gathers; none in other stages.
    pub rays_per_second: Option<f64>,
    /// Seconds since the bake began.
    pub seconds: f64,
    /// About how many seconds all that is left takes.
    pub seconds_left: f64,
    /// Seconds that the processors have worked since the bake began, all of this process's threads together.
    pub processor_seconds: f64,
    /// About how many such seconds all that is left takes: an estimate that does not change with what else the machine
    /// does.
    pub processor_seconds_left: f64,
}

impl Progress {
    /// The share of the bake's time that is over, as far as one can tell: 0 to 1.
    pub fn fraction(&self) -> f64 {
        self.seconds / (self.seconds + self.seconds_left).max(f64::MIN_POSITIVE)
    }
}

/// A bake's stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Building the ray-casting structure, finding a viewpoint.
    Prepare,
    /// A coarse bake to show first; only where previews are wanted.
    Sketch,
    /// Placing points. Counts points.
    Points,
    /// Finding where supports end and where direct light is sampled. Counts points, twice.
    Walls,
    /// Finding parents and children. Counts points.
    Basis,
    /// Finding the colours of the points' surfaces. Counts points.
    Colours,
    /// Working out what rays will find on each small tile of the surfaces. Counts tiles.
    Tiles,
    /// Computing the one-bounce links. Counts rays.
    Links,
    /// Finding what coarse points get from each other, once they have their links: of that later bounces are made. Counts
    /// coarse points.
    Among,
    /// Adding later bounces, once the coarse levels have their links. Counts coarse points.
    Bounces,
    /// Putting the file together.
    Assemble,
}

impl Stage {
    /// What a person reads.
    pub fn label(self) -> &'static str {
        match self {
            Stage::Prepare => "preparing",
            Stage::Sketch => "sketching",
            Stage::Points => "placing points",
            Stage::Walls => "looking for walls",
            Stage::Basis => "relating points",
            Stage::Colours => "reading colours",
            Stage::Tiles => "laying tiles",
            Stage::Links => "tracing links",
            Stage::Among => "relating bounces",
            Stage::Bounces => "adding bounces",
            Stage::Assemble => "assembling",
        }
    }
}

/// A coarse file to look at while the bake goes on.
pub struct Preview {
    /// The file's contents. Light that arrives on finer levels is as smooth as on the finest that is done.
    pub file: BakedScene,
    /// Levels whose links it has; 0 for a sketch, which has points of its own.
    pub levels: usize,
}

/// Follows a bake, and may end it.
pub trait Observer: Sync {
    /// Called by any thread, at most some twenty times a second and at the start of every stage.
    fn progress(&self, _progress: &Progress) {}

    /// Whether the bake shall end; asked every few milliseconds.
    fn is_stopped(&self) -> bool {
        false
    }

    /// Whether [`Self::preview`] shall be called.
    fn wants_previews(&self) -> bool {
        false
    }

    /// A preview is there; each is finer than the one before. The bake waits until this returns.
    fn preview(&self, _preview: Preview) {}
}

/// Nobody follows.
impl Observer for () {}
