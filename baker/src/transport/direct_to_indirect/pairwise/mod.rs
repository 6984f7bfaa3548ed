//! Pairwise links: the one-bounce operator T by refining links one at a time (Lehtinen et al. 2007, section 6.5, after
//! Kontkanen et al. 2006), beside the [adaptive gather](super::gather) of whole rows.
//!
//! A **link** leads from a sender to a receiver and stands for a *share* of the transport between them: the hierarchy is
//! no tree, a function has several parents, and shares are their weights. Refining an end hands the link's share on to the
//! children of that end, so that all links together stand for all transport once.
//!
//! * [`quadrature`] – the ten places of each sender that links are averaged over;
//! * [`children`] – children of every function, with the shares that stand under it;
//! * [`coefficient`] – the kernel of a receiver and a sender, averaged over ten rays;
//! * [`oracle`] – which end of a link is refined;
//! * [`inspect`] – a receiver's links: the initial gather, links handed down by parents, and their refinement.

#[doc(hidden)]
pub mod children;
#[doc(hidden)]
pub mod coefficient;
#[doc(hidden)]
pub mod inspect;
#[doc(hidden)]
pub mod oracle;
#[doc(hidden)]
pub mod quadrature;

use crate::basis::{Leveled, Relations, sender_evaluator};
use crate::geometry::Surfaces;
use crate::job::watch::{Stopped, Watch};
use crate::sampling::Points;
use crate::transport::operator::OperatorSettings;
use children::Children;
use quadrature::Quadrature;

/// What pairwise refinement reads besides points and surfaces.
pub struct Pairwise {
    /// Functions that initial links leave from: at each hit those of the coarsest level that covers it.
    pub roots: Leveled,
    /// Number of functions of the coarsest level.
    pub root_count: usize,
    /// Children of every function.
    pub children: Children,
    /// Places of every sender.
    pub quadrature: Quadrature,
}

impl Pairwise {
    /// Prepares the senders of `settings`. A unit of `watch` is a sender.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn new<S: Surfaces + ?Sized>(
        surfaces: &S,
        points: &Points,
        relations: &Relations,
        settings: &OperatorSettings,
        watch: &dyn Watch,
    ) -> Result<Self, Stopped> {
        let levels = settings.sender_levels.min(points.levels.len());
        let evaluators = || (0..levels).map(|level| sender_evaluator(points, level));
        let quadrature = Quadrature::new(surfaces, points, &evaluators().collect::<Vec<_>>(), watch)?;
        Ok(Self {
            // The finest level is asked first: here the coarsest stands in its place.
            roots: Leveled::new(evaluators().rev().collect()),
            root_count: points.count_on(1),
            children: Children::new(relations, points.points.len()),
            quadrature,
        })
    }
}
