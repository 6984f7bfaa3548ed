//! One receiver's links from all senders: a hemispherical gather (Eq. 16), less what the coarser
//! receivers already say (Eq. 17).

use super::OperatorSettings;
use super::choose::choose;
use super::directions::Directions;
use super::tally::{Amount, Irradiance, IrradianceRow, Tally, Vector};
use crate::basis::{Leveled, Relations};
use crate::points::Points;
use crate::random::mix;
use crate::surface::{Hit, Ray, Surfaces};
use glam::{Mat3A, Vec3, Vec3A};
use rebounce_shared::link::{Link, Sent, VectorLink, turn, unpack_direction};

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
    /// The colour that each point's surface gives to light; the channels' mean is 1.
    pub tints: &'a [Vec3],
    /// Settings.
    pub settings: &'a OperatorSettings,
    /// Unpacked directions of links, by their 16 bits.
    pub link_directions: &'a [Vec3A],
}

/// Unpacks all 65,536 link directions, for [`GatherContext::link_directions`].
pub fn link_directions() -> Vec<Vec3A> {
    (0..=u16::MAX).map(|bits| unpack_direction(bits).into()).collect()
}

/// ε of a receiver's value as its children subtract it, over that of its links: a value's small parts are
/// carried over like a link's, which keeps values short and changes nothing but the place that they come from.
const VALUE_EPSILON: f32 = 0.5;

/// What one gather leaves besides links.
#[derive(Clone, Copy, Debug, Default)]
pub struct GatherCost {
    /// Rays cast.
    pub rays: u64,
    /// Cosine-weighted reflectance seen.
    pub seen: f64,
    /// The part of it that no sender covers.
    pub lost: f64,
}

/// What one gather finds.
#[derive(Clone, Debug, Default)]
pub struct Gathered {
    /// The links of a receiver on all levels but the finest, senders ascending: differences to what coarser
    /// receivers say.
    pub vectors: Vec<VectorLink>,
    /// The links of one on the finest level.
    pub finest: Vec<Link>,
    /// The whole value that its links and its ancestors' say, on all levels but the finest.
    pub value: Vec<VectorLink>,
    /// Of a point that later bounces travel through: its whole irradiance from every other such point.
    pub coarse: IrradianceRow,
    /// The cost.
    pub cost: GatherCost,
}

/// A thread's working memory, reused from receiver to receiver.
pub struct Scratch {
    senders: Tally<Vector>,
    coarse: Tally<Irradiance>,
    prediction: Tally<Vector>,
    finest: [Tally<Irradiance>; 2],
    weights: Vec<(u32, f32)>,
}

impl Scratch {
    /// Working memory for this many senders and coarse points.
    pub fn new(senders: usize, coarse: usize) -> Self {
        Self {
            senders: Tally::new(senders),
            coarse: Tally::new(coarse),
            prediction: Tally::new(senders),
            finest: [(); 2].map(|()| Tally::new(senders)),
            weights: Vec::new(),
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
        values: &[Vec<VectorLink>],
        scratch: &mut Scratch,
    ) -> Gathered {
        // The variance of a mean of rays that either hit a sender or do not, per unit seen.
        let noise = self.settings.significance.powi(2) / directions.len() as f32;
        let epsilon = self.settings.epsilon_on(level);
        let is_coarse = receiver < self.coarse_count;
        if level > 0 && level + 1 == self.settings.levels {
            return self.finest_links(receiver, directions, values, scratch, epsilon, noise);
        }
        let Scratch { senders, coarse, prediction, weights, .. } = scratch;
        let cost = self.integrate(receiver, directions, weights, |hit, arriving, weights| {
            self.share(weights, arriving.light, &Vector(arriving.direction), senders);
            if is_coarse {
                self.coarse.interpolate(hit.position, hit.normal, weights);
                self.share(weights, arriving.light, &Irradiance(arriving.cosine), coarse);
            }
        });
        let mut gathered = Gathered { cost, ..Gathered::default() };
        if is_coarse {
            gathered.coarse = coarse.row(self.settings.least_irradiance());
            coarse.clear();
        }
        self.predict(receiver, values, prediction);
        gathered.vectors = choose(senders, Some(prediction), epsilon, noise);
        if level + 1 < self.settings.levels {
            for link in &gathered.vectors {
                prediction.add(link.sender(), link.link.amount(), &Vector(self.direction(*link)));
            }
            gathered.value = self.value(level, prediction);
        }
        senders.clear();
        prediction.clear();
        gathered
    }

    /// The links of a receiver on the finest level. Nothing but the picture reads its value, and of that the
    /// irradiance along its normal: that is all they hold.
    fn finest_links(
        &self,
        receiver: usize,
        directions: &Directions,
        values: &[Vec<VectorLink>],
        scratch: &mut Scratch,
        epsilon: f32,
        noise: f32,
    ) -> Gathered {
        let Scratch { finest: [senders, prediction], weights, .. } = scratch;
        let cost = self.integrate(receiver, directions, weights, |_, arriving, weights| {
            self.share(weights, arriving.light, &Irradiance(arriving.cosine), senders);
        });
        // What turns the parent's normal into the receiver's turns its light alike: the part along the normal
        // stays the same.
        for (parent, share) in self.parents(receiver) {
            let normal = Vec3A::from(self.points.points[parent].normal);
            for link in &values[parent] {
                let along = self.direction(*link).dot(normal) * share;
                prediction.add(link.sender(), along, &Irradiance(link.link.amount()));
            }
        }
        let finest = choose(senders, Some(prediction), epsilon, noise);
        senders.clear();
        prediction.clear();
        Gathered { finest, cost, ..Gathered::default() }
    }

    /// What is left of a receiver that is not refined: the value that its parents' say.
    pub fn inherit(
        &self,
        receiver: usize,
        level: usize,
        values: &[Vec<VectorLink>],
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
    fn value(&self, level: usize, sums: &Tally<Vector>) -> Vec<VectorLink> {
        choose(sums, None, VALUE_EPSILON * self.settings.epsilon_on(level), 0.0)
    }

    /// Adds a ray's light to the senders that cover its hit, by their shares: as bright as it is counted in each
    /// one's tint, the best fit of the one to the other. `amount` is what unit brightness brings.
    #[inline]
    fn share<A: Amount>(&self, shares: &[(u32, f32)], light: Vec3, amount: &A, senders: &mut Tally<A>) {
        for &(sender, share) in shares {
            let tint = self.tints[sender as usize];
            senders.add(sender as usize, share * (light.dot(tint) / tint.length_squared()), amount);
        }
    }

    #[inline]
    fn direction(&self, link: VectorLink) -> Vec3A {
        self.link_directions[link.direction as u16 as usize]
    }

    /// Eq. 16: casts the rays and tells `add` of each hit that reflects, with the functions that cover it
    /// (a list that it may use afterwards).
    fn integrate(
        &self,
        receiver: usize,
        directions: &Directions,
        weights: &mut Vec<(u32, f32)>,
        mut add: impl FnMut(&Hit, Arriving, &mut Vec<(u32, f32)>),
    ) -> GatherCost {
        let point = &self.points.points[receiver];
        let epsilon = self.surfaces.epsilon();
        let origin = point.position + point.geometric_normal * epsilon;
        let name = mix(self.settings.seed) ^ (receiver as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut cost = GatherCost { rays: directions.len() as u64, ..GatherCost::default() };
        // Dividing by this sum instead of the number of rays makes a closed white room exact.
        let normalisation: f32 = directions.around(point.normal, name).map(|d| d.cosine * d.weight).sum();
        for (i, d) in directions.around(point.normal, name).enumerate() {
            let direction = Vec3::from(d.direction);
            if direction.dot(point.geometric_normal) <= 0.0 {
                continue;
            }
            let ray = Ray { origin, direction, max_distance: f32::INFINITY };
            let Some(hit) = self.surfaces.cast(&ray, mix(name ^ i as u64) as u32) else { continue };
            if hit.albedo == Vec3::ZERO || !hit.faces(direction) {
                continue;
            }
            let weight = d.weight / normalisation;
            let seen = (hit.albedo.element_sum() / 3.0 * weight * d.cosine) as f64;
            cost.seen += seen;
            self.senders.interpolate(hit.position, hit.normal, weights);
            if weights.is_empty() {
                cost.lost += seen;
                continue;
            }
            let arriving = Arriving { direction: d.direction, cosine: d.cosine, light: hit.albedo * weight };
            add(&hit, arriving, weights);
        }
        cost
    }

    /// Eq. 17: what the parents' values say at this receiver, turned with the normals as the push
    /// will turn it.
    fn predict(&self, receiver: usize, values: &[Vec<VectorLink>], prediction: &mut Tally<Vector>) {
        let normal = self.points.points[receiver].normal;
        for (parent, share) in self.parents(receiver) {
            let turn = turning(self.points.points[parent].normal, normal);
            for link in &values[parent] {
                let direction = turn * self.direction(*link);
                prediction.add(link.sender(), share * link.link.amount(), &Vector(direction));
            }
        }
    }
}

/// What one ray brings, per unit irradiance where it hit.
#[derive(Clone, Copy)]
struct Arriving {
    /// Unit, from the receiver.
    direction: Vec3A,
    /// Its cosine to the receiver's normal.
    cosine: f32,
    /// Radiance times the ray's share of the hemisphere.
    light: Vec3,
}

/// The rotation of `rebounce_shared::link::turn`.
fn turning(from: Vec3, to: Vec3) -> Mat3A {
    Mat3A::from_cols(
        turn(Vec3::X, from, to).into(),
        turn(Vec3::Y, from, to).into(),
        turn(Vec3::Z, from, to).into(),
    )
}
