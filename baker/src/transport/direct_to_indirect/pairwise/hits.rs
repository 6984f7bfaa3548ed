//! Hits of a receiver's hemisphere, by sender and distance: the initial links, and the near field of all others.
//!
//! Places on a sender resolve the kernel from afar. Nearer than the spacing of the places the kernel has its weight between
//! them (at a receiver beside a wall, half of the hemisphere is a strip of wall as high as the receiver's distance), and
//! rays that are even over the receiver's hemisphere take over.

use super::super::directions::Directions;
use super::super::gather_context::{GatherContext, GatherCost};
use super::super::hemisphere::{GatherRays, gather_rays};
use crate::geometry::Surfaces;
use glam::Vec3A;

/// Light of a hit in the tint of a function that covers it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CoveredHit {
    sender: u32,
    /// Irradiance per unit irradiance at the sender.
    amount: f32,
    /// Squared distance from the receiver, square scene units.
    squared: f32,
    /// Whether the sender is of the coarsest level that covers the hit.
    is_coarsest: bool,
    /// Whether no finer sender covers the hit.
    is_finest: bool,
}

/// Hits of a hemisphere of rays, evaluated on all sender levels.
#[derive(Default)]
pub struct HemisphereHits {
    rays: GatherRays,
    /// By sender, ascending.
    hits: Vec<CoveredHit>,
}

/// Part of a link that hits within a distance make up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NearField {
    /// Irradiance per unit irradiance at the sender.
    pub amount: f32,
    /// The part that no finer sender covers.
    pub kept: f32,
}

impl HemisphereHits {
    /// Casts rays in `directions` from a receiver, up to `farthest` scene units.
    pub fn cast<S: Surfaces + ?Sized>(
        &mut self,
        context: &GatherContext<S>,
        receiver: usize,
        directions: &Directions,
        farthest: f32,
    ) -> GatherCost {
        self.hits.clear();
        self.rays.clear();
        let point = &context.points.points[receiver];
        let epsilon = context.surfaces.epsilon_at(point.position);
        gather_rays(point, receiver, context.settings.seed, epsilon, directions, &mut self.rays);
        let mut cost = GatherCost { rays: directions.len() as u64, ..GatherCost::default() };
        for ((ray, seed), share) in self.rays.rays.iter().zip(&self.rays.shares) {
            let mut ray = *ray;
            ray.max_distance = farthest;
            let Some(hit) = context.surfaces.cast(&ray, *seed).filter(|hit| hit.faces(ray.direction)) else {
                continue;
            };
            let arriving = Vec3A::from(hit.albedo * *share);
            let first = self.hits.len();
            context.senders.each_level(hit.position, hit.normal, hit.group, |level, function, weight| {
                let (sender, squared) = (function, hit.distance * hit.distance);
                let amount = weight * arriving.dot(context.duals[function as usize]);
                let is_coarsest = level.is_coarsest;
                self.hits.push(CoveredHit {
                    sender,
                    amount,
                    squared,
                    is_coarsest,
                    is_finest: level.is_finest,
                });
            });
            let brought = arriving.element_sum() as f64 / 3.0;
            cost.seen += brought;
            if self.hits.len() == first {
                cost.lost += brought;
            }
        }
        // Stable: sums are taken in the order of the rays.
        self.hits.sort_by_key(|hit| hit.sender);
        cost
    }

    /// Visits the amount of each sender at hits that no coarser sender covers, senders ascending.
    pub fn initial(&self, mut visit: impl FnMut(u32, f32)) {
        for of_sender in self.hits.chunk_by(|a, b| a.sender == b.sender) {
            let amount: f32 = of_sender.iter().filter(|hit| hit.is_coarsest).map(|hit| hit.amount).sum();
            if amount != 0.0 {
                visit(of_sender[0].sender, amount);
            }
        }
    }

    /// Part of the link from a sender that hits nearer than the root of `squared` make up.
    pub fn near(&self, sender: usize, squared: f32) -> NearField {
        let first = self.hits.partition_point(|hit| (hit.sender as usize) < sender);
        let mut out = NearField::default();
        for hit in self.hits[first..].iter().take_while(|hit| hit.sender as usize == sender) {
            if hit.squared < squared {
                out.amount += hit.amount;
                out.kept += if hit.is_finest { hit.amount } else { 0.0 };
            }
        }
        out
    }
}
