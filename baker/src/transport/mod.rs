//! Light transport: converts direct light at points to bounced light at points.
//!
//! A [`Solver`] takes a [`Problem`] (surfaces, points, hierarchy) and computes a solution, for example the sparse
//! [`operator`] that relights a scene.
//!
//! * [`direct_to_indirect`] – the operator S for moving lights and a still scene (Lehtinen et al. 2008);
//! * [`radiosity`] – bounced light of given lights that stay in place (Lehtinen et al. 2007);
//! * [`wavelet`] – bounced light of given lights on exact surfaces (Alonso et al. 2001);
//! * `antiradiance` – bounced light of given lights without visibility between surfaces (Dachsbacher et al. 2007);
//! * [`Unlinked`] – no transport: radiosity of moving things is computed when a file is shown (Schäfer et al. 2011);
//! * [`sources`] – links from the sky and from emissive surfaces, which stay in place;
//! * [`environment`] – transfer from the sky in place of links, for objects (Sloan et al. 2002);
//! * `gloss` – what arrives at glossy surfaces from each direction of the sky (Lehtinen et al. 2007).
//!
//! A solver outside of the crate is as good: `examples/one_bounce.rs`.

#[cfg(feature = "antiradiance")]
pub mod antiradiance;
pub mod direct_to_indirect;
pub mod environment;
#[cfg(feature = "gloss")]
pub mod gloss;
#[cfg(not(feature = "gloss"))]
#[path = "no_gloss.rs"]
pub mod gloss;
mod gloss_settings;
pub mod operator;
pub mod radiosity;
pub mod sources;
mod unlinked;
#[cfg(feature = "exact-faces")]
pub mod wavelet;

pub use operator::{Operator, OperatorSettings, Refinement};
pub use unlinked::Unlinked;

use crate::basis::Relations;
use crate::job::Job;
use crate::job::communicator::CommunicatorError;
use crate::job::watch::Stopped;
use crate::sampling::Points;

/// The input of a solver.
pub struct Problem<'a, S: ?Sized> {
    /// Surfaces of the scene.
    pub surfaces: &'a S,
    /// All points, coarsest level first, with cuts and samples.
    pub points: &'a Points,
    /// Parents and children of the points.
    pub relations: &'a Relations,
    /// Levels of senders, number of rays, ε, seed.
    pub settings: &'a OperatorSettings,
}

/// Receives an unfinished solution, and the number of its finished levels.
pub type Partial<'p, T> = dyn FnMut(&T, usize) -> Result<(), Stopped> + 'p;

/// Computes light transport between the points of a problem.
pub trait Solver<S: ?Sized> {
    /// What is computed: an [`Operator`] for moving lights, or the light of fixed lights.
    type Solution;

    /// Solves the problem. Calls `partial` with solutions that are coarse but fit to be shown. Only a solver that
    /// shares its work with other processes awaits something.
    ///
    /// # Errors
    /// [`CommunicatorError`] if the job is stopped, or another process fails.
    fn solve(
        &self,
        problem: &Problem<S>,
        job: &Job,
        partial: &mut Partial<Self::Solution>,
    ) -> impl Future<Output = Result<Self::Solution, CommunicatorError>>;
}
