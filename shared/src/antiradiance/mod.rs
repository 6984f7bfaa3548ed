//! Antiradiance: bounced light without visibility (Dachsbacher, Stamminger, Drettakis, Durand: *Implicit Visibility and
//! Antiradiance for Interactive Global Illumination*, 2007; "the antiradiance paper" in this module).
//!
//! Light goes through all surfaces (the operator U). Each surface sends on what has come to it from the front as
//! antiradiance, negative light, which takes it away from what is behind. Radiance and antiradiance are tables of intensity
//! by element and direction; flat arrays, as a GPU has them:
//!
//! | stage | here |
//! |---|---|
//! | directions: equal-area bins | [`bins`] |
//! | patches, clusters above them, breadth first | [`patches`], [`hierarchy`] |
//! | where the light of an element leaves from | [`samples`] |
//! | refinement oracle: which elements exchange light | [`links`] |
//! | form factors: bins and factors of a link | [`transfers`], [`transfer`], [`spread`] |
//! | global pass U, push and pull | [`transport`] |
//! | local pass K and J | [`local`], [`cosines`] |
//! | K of metals; radiance that leaves | [`lobe`], [`leaving`] |
//! | the same transfers by receiver and bin, for a GPU | [`cells`] |
//! | symmetric and asymmetric iteration | [`solve`](mod@solve) |
//! | patches of a file's points | [`point_patches`] |
//! | links again where things have moved | [`moving`] |
//! | ordered iteration; the same for many threads | [`sweep`], [`waves`] |
//!
//! Nothing here starts threads: [`workers`] is what a caller brings.

pub mod beside;
pub mod bins;
pub mod cells;
pub mod cosines;
pub mod hierarchy;
pub mod leaving;
pub mod links;
pub mod lobe;
pub mod local;
pub mod moving;
pub mod patches;
pub mod point_patches;
pub mod samples;
pub mod solve;
pub mod spread;
pub mod sweep;
#[cfg(test)]
mod tests;
pub mod transfer;
pub mod transfers;
pub mod transport;
pub mod waves;
pub mod workers;

pub use bins::Bins;
pub use cells::Cells;
pub use hierarchy::Hierarchy;
pub use leaving::DirectLight;
pub use links::Links;
pub use lobe::Lobes;
pub use moving::{Linking, MovingElements, PartTables};
pub use patches::Patch;
pub use point_patches::{PointPatches, SceneTriangle};
pub use solve::{AntiradianceFigures, AntiradianceSolver, Iteration, Observer, Pass, SolverSettings};
pub use sweep::SweepScene;
pub use transfer::Transfer;
pub use transfers::{Exchange, SenderTables, Spreading, Transfers};
pub use waves::Waves;
pub use workers::{Serial, Workers};
