//! One receiver's links from all senders: a hemispherical gather (Eq. 16), less what the coarser
//! receivers already say (Eq. 17).

use super::OperatorSettings;
use super::directions::Directions;
use crate::basis::{Leveled, Relations};
use crate::points::Points;
use crate::random::mix;
use crate::surface::{Ray, Surfaces};
use glam::{Mat3A, Vec3, Vec3A};
use rebounce_shared::link::{Link, RowWriter, VectorRgb, columns, turn};
use rebounce_shared::octahedral;

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
    /// Settings.
    pub settings: &'a OperatorSettings,
    /// Unpacked directions of links, by their 16 bits.
    pub link_directions: &'a [Vec3A],
}

/// Unpacks all 65,536 link directions, for [`GatherContext::link_directions`].
pub fn link_directions() -> Vec<Vec3A> {
    (0..=u16::MAX).map(|bits| octahedral::unpack_snorm8(bits).into()).collect()
}

/// ε of a receiver's value as its children subtract it, over that of its links: a value's small parts are
/// carried over like a link's, which keeps values short and changes nothing but the place that they come from.
const VALUE_EPSILON: f32 = 0.5;

/// What is left of a row without links is one link if it is at least this share of ε: else a few such rows,
/// one under the other, would lose a noticeable part of the light.
const LEAST_SUM: f32 = 0.125;

/// Vector irradiance per channel, aligned for the inner loops.
#[derive(Clone, Copy, Debug, Default)]
struct Sum([Vec3A; 3]);

impl Sum {
    #[inline]
    fn add_scaled(&mut self, scale: f32, other: &Self) {
        for c in 0..3 {
            self.0[c] += other.0[c] * scale;
        }
    }

    fn pack(&self) -> Link {
        Link::pack_vectors(0, &VectorRgb { rgb: self.0.map(Vec3::from) })
    }

    fn unpack(link: Link) -> Self {
        Self(link.vectors().rgb.map(Vec3A::from))
    }

    fn magnitude_squared(&self) -> f32 {
        self.0.iter().map(|v| v.length_squared()).sum::<f32>() / 3.0
    }
}

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

/// A receiver's irradiance per channel from senders, ascending.
pub type IrradianceRow = Vec<(u32, Vec3)>;

/// What one gather finds.
#[derive(Clone, Debug, Default)]
pub struct Gathered {
    /// The links, columns ascending: differences to what coarser receivers say.
    pub links: Vec<Link>,
    /// The whole value that its links and its ancestors' say, on all levels but the finest.
    pub value: Vec<Link>,
    /// Of a point that later bounces travel through: its whole irradiance from every sender.
    pub first: IrradianceRow,
    /// And from every other such point.
    pub coarse: IrradianceRow,
    /// The cost.
    pub cost: GatherCost,
}

/// Sums by sender, of which few are not zero.
struct Tally {
    sums: Vec<Sum>,
    /// One bit a sender, so that those touched come in order.
    is_touched: Vec<u64>,
}

impl Tally {
    fn new(senders: usize) -> Self {
        Self { sums: vec![Sum::default(); senders], is_touched: vec![0; senders.div_ceil(64)] }
    }

    #[inline]
    fn touch(&mut self, sender: usize) {
        self.is_touched[sender / 64] |= 1 << (sender % 64);
    }

    #[inline]
    fn add_link(&mut self, sender: usize, direction: Vec3A, magnitude: Vec3) {
        self.touch(sender);
        let sum = &mut self.sums[sender].0;
        sum[0] += direction * magnitude.x;
        sum[1] += direction * magnitude.y;
        sum[2] += direction * magnitude.z;
    }

    /// The senders touched, ascending.
    fn touched(&self) -> impl Iterator<Item = u32> + '_ {
        self.touched_with(None)
    }

    /// The senders touched here or there, ascending.
    fn touched_with<'a>(&'a self, other: Option<&'a Self>) -> impl Iterator<Item = u32> + 'a {
        self.is_touched.iter().enumerate().flat_map(move |(i, &word)| {
            let mut rest = word | other.map_or(0, |other| other.is_touched[i]);
            let first = 64 * i as u32;
            std::iter::from_fn(move || {
                let bit = (rest != 0).then(|| rest.trailing_zeros())?;
                rest &= rest - 1;
                Some(first + bit)
            })
        })
    }

    #[inline]
    fn add(&mut self, shares: &[(u32, f32)], light: &Sum) {
        for &(sender, share) in shares {
            self.touch(sender as usize);
            self.sums[sender as usize].add_scaled(share, light);
        }
    }

    fn clear(&mut self) {
        for (word, sums) in self.is_touched.iter_mut().zip(self.sums.chunks_mut(64)) {
            if std::mem::take(word) != 0 {
                sums.fill(Sum::default());
            }
        }
    }

    /// The irradiance from each sender on a surface with this unit normal. What is not over
    /// `least` is carried over to the next sender, as in [`choose`].
    fn irradiance_row(&self, normal: Vec3, least: f32) -> IrradianceRow {
        let normal = Vec3A::from(normal);
        let mut carried = Vec3::ZERO;
        let mut row = Vec::new();
        for sender in self.touched() {
            let sum = &self.sums[sender as usize].0;
            carried += Vec3::new(sum[0].dot(normal), sum[1].dot(normal), sum[2].dot(normal));
            if carried.max_element() > least {
                row.push((sender, std::mem::take(&mut carried)));
            }
        }
        match (row.last_mut(), self.touched().next()) {
            (Some((_, last)), _) => *last += carried,
            (None, Some(sender)) => row.push((sender, carried)),
            (None, None) => {}
        }
        row
    }
}

/// A thread's working memory, reused from receiver to receiver.
pub struct Scratch {
    senders: Tally,
    coarse: Tally,
    prediction: Tally,
    weights: Vec<(u32, f32)>,
}

impl Scratch {
    /// Working memory for this many senders and coarse points.
    pub fn new(senders: usize, coarse: usize) -> Self {
        Self {
            senders: Tally::new(senders),
            coarse: Tally::new(coarse),
            prediction: Tally::new(senders),
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
        values: &[Vec<Link>],
        scratch: &mut Scratch,
    ) -> Gathered {
        let epsilon = self.settings.epsilon_on(level);
        let mut gathered =
            Gathered { cost: self.integrate(receiver, directions, scratch), ..Gathered::default() };
        let Scratch { senders, coarse, prediction, .. } = scratch;
        if receiver < self.coarse_count {
            let normal = self.points.points[receiver].normal;
            let least = self.settings.least_irradiance();
            gathered.first = senders.irradiance_row(normal, least);
            gathered.coarse = coarse.irradiance_row(normal, least);
            coarse.clear();
        }
        self.predict(receiver, values, prediction);
        // The variance of a mean of rays that either hit a sender or do not, per unit seen.
        let noise = self.settings.significance.powi(2) / directions.len() as f32;
        gathered.links = choose(senders, Some(prediction), epsilon, noise);
        if level + 1 < self.settings.levels {
            for (column, link) in columns(&gathered.links) {
                prediction.add_link(column, self.direction(link), link.magnitude());
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
        self.predict(receiver, values, &mut scratch.prediction);
        let value = self.value(level, &scratch.prediction);
        scratch.prediction.clear();
        Gathered { value, ..Gathered::default() }
    }

    /// A receiver's value as its children will subtract it.
    fn value(&self, level: usize, sums: &Tally) -> Vec<Link> {
        choose(sums, None, VALUE_EPSILON * self.settings.epsilon_on(level), 0.0)
    }

    #[inline]
    fn direction(&self, link: Link) -> Vec3A {
        self.link_directions[(link.column_direction >> 16) as usize]
    }

    /// Eq. 16: casts the rays and gives what each hit reflects to the functions that cover it.
    fn integrate(&self, receiver: usize, directions: &Directions, scratch: &mut Scratch) -> GatherCost {
        let point = &self.points.points[receiver];
        let epsilon = self.surfaces.epsilon();
        let origin = point.position + point.geometric_normal * epsilon;
        let name = mix(self.settings.seed) ^ (receiver as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut cost = GatherCost { rays: directions.len() as u64, ..GatherCost::default() };
        // Dividing by this sum instead of the number of rays makes a closed white room exact.
        let normalisation: f32 = directions.around(point.normal, name).map(|d| d.cosine * d.weight).sum();
        let mut weights = std::mem::take(&mut scratch.weights);
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
            self.senders.interpolate(hit.position, hit.normal, &mut weights);
            if weights.is_empty() {
                cost.lost += seen;
                continue;
            }
            let arriving =
                Sum([hit.albedo.x, hit.albedo.y, hit.albedo.z].map(|rho| d.direction * (rho * weight)));
            scratch.senders.add(&weights, &arriving);
            if receiver < self.coarse_count {
                self.coarse.interpolate(hit.position, hit.normal, &mut weights);
                scratch.coarse.add(&weights, &arriving);
            }
        }
        scratch.weights = weights;
        cost
    }

    /// Eq. 17: what the parents' values say at this receiver, turned with the normals as the push
    /// will turn it.
    fn predict(&self, receiver: usize, values: &[Vec<Link>], prediction: &mut Tally) {
        let normal = self.points.points[receiver].normal;
        let row = self.relations.push().row(receiver);
        let total: f32 = row.iter().map(|e| e.weight()).sum();
        for parent in row {
            let turn = turning(self.points.points[parent.point()].normal, normal);
            for (column, link) in columns(&values[parent.point()]) {
                let direction = turn * self.direction(link);
                prediction.add_link(column, direction, link.magnitude() * (parent.weight() / total));
            }
        }
    }
}

/// The criterion of Fig. 5, ε, and two changes to it: a link must stand out of its own noise,
/// and what is dropped is carried over to the next sender along the space-filling curve until
/// it adds up to a link. So a row keeps its sum, and what a dropped link would have said is
/// said by a neighbour: senders that are too small to matter one by one act as one.
///
/// Gives the links for `gathered` less `prediction`; `noise` is the variance of a gathered sum per
/// unit of it.
fn choose(gathered: &Tally, prediction: Option<&Tally>, epsilon: f32, noise: f32) -> Vec<Link> {
    let mut row = Vec::new();
    let mut writer = RowWriter::default();
    let (mut carried, mut seen) = (Sum::default(), 0.0);
    let mut strongest = (0, 0.0);
    for sender in gathered.touched_with(prediction) {
        let sum = &gathered.sums[sender as usize];
        carried.add_scaled(1.0, sum);
        let strength = sum.magnitude_squared();
        if strength > strongest.1 {
            strongest = (sender, strength);
        }
        // Rays that by chance all miss a small sender say as little as those that by chance hit it often:
        // what coarser receivers expect counts, too.
        let mut expected = strength;
        if let Some(prediction) = prediction {
            let sum = &prediction.sums[sender as usize];
            carried.add_scaled(-1.0, sum);
            expected = expected.max(sum.magnitude_squared());
        }
        if noise > 0.0 {
            seen += expected.sqrt();
        }
        if carried.magnitude_squared() > (noise * seen).max(epsilon * epsilon) {
            let link = carried.pack();
            writer.push(&mut row, sender, link);
            // What packing lost is carried over too.
            carried.add_scaled(-1.0, &Sum::unpack(link));
            seen = 0.0;
        }
    }
    if let Some(last) = row.last_mut() {
        carried.add_scaled(1.0, &Sum::unpack(*last));
        *last = carried.pack().at(last.column());
    } else if carried.magnitude_squared() > (LEAST_SUM * epsilon).powi(2) {
        writer.push(&mut row, strongest.0, carried.pack());
    }
    row
}

/// The rotation of `rebounce_shared::link::turn`.
fn turning(from: Vec3, to: Vec3) -> Mat3A {
    Mat3A::from_cols(
        turn(Vec3::X, from, to).into(),
        turn(Vec3::Y, from, to).into(),
        turn(Vec3::Z, from, to).into(),
    )
}
