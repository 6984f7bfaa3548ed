//! One receiver's links from all senders: a hemispherical gather (Eq. 16), less what the coarser
//! receivers already say (Eq. 17).

use super::OperatorSettings;
use super::choose::choose;
use super::directions::Directions;
use super::hemisphere::{GatherRays, gather_rays};
use super::tally::{IrradianceRow, Tally};
use crate::basis::{Leveled, List, Relations};
use crate::points::Points;
use crate::surface::{Hit, Surfaces};
use glam::{Vec3, Vec3A};
use rebounce_shared::link::{Link, Sent};

/// What all gathers read.
pub struct GatherContext<'a, S: Surfaces + ?Sized> {
    /// The scene.
    pub surfaces: &'a S,
    /// All points.
    pub points: &'a Points,
    /// Parents and children.
    pub relations: &'a Relations,
    /// The sender levels' functions, coarsest first.
    pub senders: &'a Leveled,
    /// The functions of the levels that later bounces travel between, coarsest first.
    pub coarse: &'a Leveled,
    /// Number of points on those levels.
    pub coarse_count: usize,
    /// The [duals](super::tint::duals) of the points' tints.
    pub duals: &'a [Vec3A],
    /// Settings.
    pub settings: &'a OperatorSettings,
}

/// ε of a receiver's value as its children subtract it, over that of its links: a value's small parts are
/// carried over like a link's, which keeps values short and changes nothing but the place that they come from.
const VALUE_EPSILON: f32 = 0.5;

/// Rays that are cast before their hits are looked at.
const BATCH: usize = 64;

/// What one gather leaves besides links.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GatherCost {
    /// Rays cast.
    pub rays: u64,
    /// Cosine-weighted reflectance seen.
    pub seen: f64,
    /// The part of it that no sender covers.
    pub lost: f64,
}

/// What one gather finds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gathered {
    /// The receiver's links, senders ascending: differences to what coarser receivers say.
    pub links: Vec<Link>,
    /// The whole value that its links and its ancestors' say, on all levels but the finest.
    pub value: Vec<Link>,
    /// Of a point that later bounces travel through: its whole irradiance from every other such point.
    pub coarse: IrradianceRow,
    /// The cost.
    pub cost: GatherCost,
}

impl Gathered {
    /// Whether it can be of a scene with so many senders and points of later bounces, whoever says it: indices are
    /// under these, ascend, and have finite numbers.
    pub fn fits(&self, senders: usize, coarse: usize) -> bool {
        let row = |links: &[Link]| {
            links.windows(2).all(|pair| pair[0].sender() < pair[1].sender())
                && links.last().is_none_or(|last| last.sender() < senders)
        };
        row(&self.links)
            && row(&self.value)
            && self.coarse.windows(2).all(|pair| pair[0].0 < pair[1].0)
            && self.coarse.last().is_none_or(|last| (last.0 as usize) < coarse)
            && self.coarse.iter().all(|entry| entry.1.is_finite())
            && self.cost.rays <= u32::MAX as u64
            && self.cost.seen.is_finite()
            && self.cost.lost.is_finite()
    }
}

/// A thread's working memory, reused from receiver to receiver.
pub struct Scratch {
    senders: Tally,
    coarse: Tally,
    prediction: Tally,
    found: Found,
}

/// Rays of one gather, and what they find: [`BATCH`] at a time, so that what one step has to wait for, memory far
/// away, it waits for once.
#[derive(Default)]
struct Found {
    rays: GatherRays,
    hits: Vec<Option<Hit>>,
    /// Hits that reflect, the light that they bring, and where the functions that may cover them are listed.
    reflecting: Vec<(Hit, Vec3A, List)>,
    /// The functions that cover one hit.
    weights: Vec<(u32, f32)>,
}

impl Scratch {
    /// Working memory for this many senders and coarse points.
    pub fn new(senders: usize, coarse: usize) -> Self {
        Self {
            senders: Tally::new(senders),
            coarse: Tally::new(coarse),
            prediction: Tally::new(senders),
            found: Found::default(),
        }
    }
}

impl<S: Surfaces + ?Sized> GatherContext<'_, S> {
    /// The links of one receiver, and more. `values` holds the [values](Gathered::value) of all
    /// coarser levels.
    pub fn links(
        &self,
        receiver: usize,
        level: usize,
        directions: &Directions,
        values: &[Vec<Link>],
        scratch: &mut Scratch,
    ) -> Gathered {
        // The variance of a mean of rays that either hit a sender or do not, per unit seen.
        let noise = self.settings.significance.powi(2) / directions.len() as f32;
        let epsilon = self.settings.epsilon_on(level);
        let is_coarse = receiver < self.coarse_count;
        let Scratch { senders, coarse, prediction, found } = scratch;
        let cost = self.integrate(receiver, directions, found, |hit, arriving, weights| {
            self.share(weights, arriving, senders);
            if is_coarse {
                self.coarse.interpolate(hit.position, hit.normal, weights);
                self.share(weights, arriving, coarse);
            }
        });
        let mut gathered = Gathered { cost, ..Gathered::default() };
        if is_coarse {
            gathered.coarse = coarse.row(self.settings.least_irradiance());
            coarse.clear();
        }
        self.predict(receiver, values, prediction);
        gathered.links = choose(senders, Some(prediction), epsilon, noise);
        if level + 1 < self.settings.levels {
            for link in &gathered.links {
                prediction.add(link.sender(), link.amount());
            }
            gathered.value = self.value(level, prediction);
        }
        senders.clear();
        prediction.clear();
        gathered
    }

    /// What is left of a receiver that is not refined: the value that its parents' say.
    pub fn inherit(
        &self,
        receiver: usize,
        level: usize,
        values: &[Vec<Link>],
        scratch: &mut Scratch,
    ) -> Gathered {
        if level + 1 == self.settings.levels {
            return Gathered::default();
        }
        self.predict(receiver, values, &mut scratch.prediction);
        let value = self.value(level, &scratch.prediction);
        scratch.prediction.clear();
        Gathered { value, ..Gathered::default() }
    }

    /// A receiver's parents and their shares, which sum to 1.
    fn parents(&self, receiver: usize) -> impl Iterator<Item = (usize, f32)> + '_ {
        let row = self.relations.push().row(receiver);
        let total: f32 = row.iter().map(|e| e.weight()).sum();
        row.iter().map(move |e| (e.point(), e.weight() / total))
    }

    /// A receiver's value as its children will subtract it.
    fn value(&self, level: usize, sums: &Tally) -> Vec<Link> {
        choose(sums, None, VALUE_EPSILON * self.settings.epsilon_on(level), 0.0)
    }

    /// Adds a ray's light to the senders that cover its hit, by their shares: as bright as it is counted in each
    /// one's tint, the best fit of the one to the other.
    #[inline]
    fn share(&self, shares: &[(u32, f32)], arriving: Vec3A, senders: &mut Tally) {
        for &(sender, share) in shares {
            senders.add(sender as usize, share * arriving.dot(self.duals[sender as usize]));
        }
    }

    /// Eq. 16: casts the rays and tells `add` of each hit that reflects, with the irradiance that it brings (RGB, per
    /// unit irradiance at the hit) and the functions that cover it (a list that it may use afterwards).
    fn integrate(
        &self,
        receiver: usize,
        directions: &Directions,
        found: &mut Found,
        mut add: impl FnMut(&Hit, Vec3A, &mut Vec<(u32, f32)>),
    ) -> GatherCost {
        let Found { rays, hits, reflecting, weights } = found;
        let (point, epsilon) = (&self.points.points[receiver], self.surfaces.epsilon());
        gather_rays(point, receiver, self.settings.seed, epsilon, directions, rays);
        let mut cost = GatherCost { rays: directions.len() as u64, ..GatherCost::default() };
        for (rays, shares) in rays.rays.chunks(BATCH).zip(rays.shares.chunks(BATCH)) {
            self.surfaces.cast_all(rays, hits);
            reflecting.clear();
            for ((hit, (ray, _)), share) in hits.iter().zip(rays).zip(shares) {
                if let Some(hit) = hit
                    && hit.albedo != Vec3::ZERO
                    && hit.faces(ray.direction)
                {
                    let arriving = Vec3A::from(hit.albedo * *share);
                    reflecting.push((*hit, arriving, self.senders.look_up(hit.position)));
                }
            }
            for (hit, arriving, list) in &*reflecting {
                let seen = (arriving.element_sum() / 3.0) as f64;
                cost.seen += seen;
                self.senders.interpolate_in(*list, hit.position, hit.normal, weights);
                if weights.is_empty() {
                    cost.lost += seen;
                } else {
                    add(hit, *arriving, weights);
                }
            }
        }
        cost
    }

    /// Eq. 17: what the parents' values say at this receiver, as the push will interpolate it.
    fn predict(&self, receiver: usize, values: &[Vec<Link>], prediction: &mut Tally) {
        for (parent, share) in self.parents(receiver) {
            for link in &values[parent] {
                prediction.add(link.sender(), share * link.amount());
            }
        }
    }
}
