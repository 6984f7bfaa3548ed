//! Pairwise links: the one-bounce operator T by refining links one at a time (Lehtinen et al. 2007, section 6.5, after
//! Kontkanen et al. 2006), beside the [adaptive gather](super::gather) of whole rows.
//!
//! A **link** leads from a sender to a receiver and stands for a *share* of the transport between them: the hierarchy is
//! no tree, a function has several parents, and shares are their weights. Refining an end hands the link's share on to the
//! children of that end, so that all links together stand for all transport once.
//!
//! * [`quadrature`] – the ten places of each sender that links are averaged over;
//! * [`children`] – children of receivers and senders, with the shares that stand under them;
//! * [`hits`] – a receiver's hemisphere: the initial gather, and the near field of links;
//! * [`coefficient`] – the kernel of a receiver and a sender, averaged over ten rays;
//! * [`oracle`] – which end of a link is refined;
//! * [`handed`] – links that a receiver hands down;
//! * [`inspect`] – a receiver's links: the initial gather, links handed down by parents, and their refinement.

#[doc(hidden)]
pub mod children;
#[doc(hidden)]
pub mod coefficient;
#[doc(hidden)]
pub mod handed;
#[doc(hidden)]
pub mod hits;
#[doc(hidden)]
pub mod inspect;
#[doc(hidden)]
pub mod oracle;
#[doc(hidden)]
pub mod quadrature;

use super::directions::Directions;
use super::tint;
use crate::basis::{Relations, sender_evaluator};
use crate::geometry::Surfaces;
use crate::job::watch::{Stopped, Watch};
use crate::sampling::Points;
use crate::transport::operator::OperatorSettings;
use children::Children;
use quadrature::Quadrature;

/// Rays of a receiver's near field: on the finest level, and at most.
const NEAR_RAYS: [u32; 2] = [128, 1024];

/// What pairwise refinement reads besides points and surfaces.
pub struct Pairwise {
    /// Number of functions of the coarsest level.
    pub root_count: usize,
    /// Directions of the near field of a receiver, by level.
    pub near_directions: Vec<Directions>,
    /// Distance of the farthest near field, scene units.
    pub farthest: f32,
    /// Children of every receiver.
    pub receiver_children: Children,
    /// Children of every sender.
    pub sender_children: Children,
    /// Places of every sender.
    pub quadrature: Quadrature,
}

impl Pairwise {
    /// Prepares the senders of `settings`; `tints` are the points'. A unit of `watch` is a sender.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn new<S: Surfaces + ?Sized>(
        surfaces: &S,
        points: &Points,
        relations: &Relations,
        settings: &OperatorSettings,
        tints: &[u32],
        watch: &dyn Watch,
    ) -> Result<Self, Stopped> {
        let levels = settings.sender_levels.min(points.levels.len());
        let evaluators: Vec<_> = (0..levels).map(|level| sender_evaluator(points, level)).collect();
        let quadrature = Quadrature::new(surfaces, points, &evaluators, &tint::duals(tints), watch)?;
        let farthest = (0..quadrature.count()).map(|sender| quadrature.near_squared(sender));
        let rays = |above: usize| (NEAR_RAYS[0] << (2 * above).min(16)).min(NEAR_RAYS[1]);
        Ok(Self {
            root_count: points.count_on(1),
            farthest: farthest.fold(0f32, f32::max).sqrt(),
            near_directions: (0..points.levels.len())
                .rev()
                .map(|above| Directions::new(rays(above)))
                .collect(),
            receiver_children: Children::of_receivers(relations, points.points.len()),
            sender_children: quadrature.children(),
            quadrature,
        })
    }
}
