//! One receiver's links from all senders: a hemispherical gather (Eq. 16), less what the coarser
//! receivers already say (Eq. 17).

use super::OperatorSettings;
use super::directions::Directions;
use crate::basis::{Leveled, Relations};
use crate::points::Points;
use crate::random::mix;
use crate::surface::{Ray, Surfaces};
use glam::{Mat3A, Vec3, Vec3A};
use rebounce_shared::interpolation::Entry;
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

    /// True if this sender was not touched before.
    #[inline]
    fn touch(&mut self, sender: u32) -> bool {
        let (word, bit) = (&mut self.is_touched[sender as usize / 64], 1 << (sender % 64));
        let is_new = *word & bit == 0;
        *word |= bit;
        is_new
    }

    /// The senders touched, ascending.
    fn touched(&self) -> impl Iterator<Item = u32> + '_ {
        self.is_touched.iter().zip((0..).step_by(64)).flat_map(|(&word, first)| {
            let mut rest = word;
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
            self.touch(sender);
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
    /// `least` is carried over to the next sender, as in [`GatherContext::choose`].
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
    /// Magnitude before differences, by sender.
    whole: Vec<f32>,
    weights: Vec<(u32, f32)>,
    ancestor_weight: Vec<f32>,
    ancestors: Vec<Vec<u32>>,
}

impl Scratch {
    /// Working memory for this many senders and coarse points, and points on all levels.
    pub fn new(senders: usize, coarse: usize, points: usize, levels: usize) -> Self {
        Self {
            senders: Tally::new(senders),
            coarse: Tally::new(coarse),
            whole: vec![0.0; senders],
            weights: Vec::new(),
            ancestor_weight: vec![0.0; points],
            ancestors: vec![Vec::new(); levels],
        }
    }
}

impl<S: Surfaces + ?Sized> GatherContext<'_, S> {
    /// The links of one receiver, and more. `rows` holds the links of all coarser levels.
    pub fn links(
        &self,
        receiver: usize,
        level: usize,
        directions: &Directions,
        rows: &[Vec<Link>],
        scratch: &mut Scratch,
    ) -> Gathered {
        let cost = self.integrate(receiver, directions, scratch);
        let (mut first, mut coarse) = (Vec::new(), Vec::new());
        if receiver < self.coarse_count {
            let normal = self.points.points[receiver].normal;
            let least = self.settings.least_irradiance();
            first = scratch.senders.irradiance_row(normal, least);
            coarse = scratch.coarse.irradiance_row(normal, least);
            scratch.coarse.clear();
        }
        self.subtract_coarser(receiver, level, rows, scratch);
        let links = self.choose(self.settings.epsilon_on(level), directions.len(), scratch);
        scratch.senders.clear();
        Gathered { links, first, coarse, cost }
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
        for sender in scratch.senders.touched() {
            scratch.whole[sender as usize] = scratch.senders.sums[sender as usize].magnitude_squared().sqrt();
        }
        cost
    }

    /// Eq. 17: takes off what the kept links of the parents, their parents and so on say.
    fn subtract_coarser(&self, receiver: usize, level: usize, rows: &[Vec<Link>], scratch: &mut Scratch) {
        let normal = self.points.points[receiver].normal;
        let push = self.relations.push();
        let spread = |scratch: &mut Scratch, child: usize, weight: f32| {
            let row = push.row(child);
            if row.is_empty() {
                return;
            }
            let scale = weight / total(row);
            for entry in row {
                let parent = entry.point();
                if scratch.ancestor_weight[parent] == 0.0 {
                    let l = self.points.levels.partition_point(|level| level.first <= parent) - 1;
                    scratch.ancestors[l].push(parent as u32);
                }
                scratch.ancestor_weight[parent] += entry.weight() * scale;
            }
        };
        spread(scratch, receiver, 1.0);
        for l in (0..level).rev() {
            let ancestors = std::mem::take(&mut scratch.ancestors[l]);
            for &ancestor in &ancestors {
                let weight = std::mem::take(&mut scratch.ancestor_weight[ancestor as usize]);
                let turn = turning(self.points.points[ancestor as usize].normal, normal);
                for (column, link) in columns(&rows[ancestor as usize]) {
                    if scratch.senders.touch(column as u32) {
                        scratch.whole[column] = 0.0;
                    }
                    let direction = turn * self.link_directions[(link.column_direction >> 16) as usize];
                    let magnitude = link.magnitude() * weight;
                    let sum = &mut scratch.senders.sums[column].0;
                    sum[0] -= direction * magnitude.x;
                    sum[1] -= direction * magnitude.y;
                    sum[2] -= direction * magnitude.z;
                }
                spread(scratch, ancestor as usize, weight);
            }
            scratch.ancestors[l] = ancestors;
            scratch.ancestors[l].clear();
        }
    }

    /// The criterion of Fig. 5, ε, and two changes to it: a link must stand out of its own noise,
    /// and what is dropped is carried over to the next sender along the space-filling curve until
    /// it adds up to a link. So a row keeps its sum, and what a dropped link would have said is
    /// said by a neighbour: senders that are too small to matter one by one act as one.
    fn choose(&self, epsilon: f32, rays: usize, scratch: &mut Scratch) -> Vec<Link> {
        let mut row = Vec::new();
        let mut writer = RowWriter::default();
        // The variance of a mean of rays that either hit the sender or do not, per unit seen.
        let noise = self.settings.significance.powi(2) / rays as f32;
        let (mut carried, mut seen) = (Sum::default(), 0.0);
        for sender in scratch.senders.touched() {
            carried.add_scaled(1.0, &scratch.senders.sums[sender as usize]);
            seen += scratch.whole[sender as usize];
            if carried.magnitude_squared() > (noise * seen).max(epsilon * epsilon) {
                let link = Link::pack_vectors(0, &VectorRgb { rgb: carried.0.map(Vec3::from) });
                writer.push(&mut row, sender, link);
                // What packing lost is carried over too.
                carried.add_scaled(-1.0, &Sum(link.vectors().rgb.map(Vec3A::from)));
                seen = 0.0;
            }
        }
        if let Some(last) = row.last_mut() {
            carried.add_scaled(1.0, &Sum(last.vectors().rgb.map(Vec3A::from)));
            *last = Link::pack_vectors(last.column(), &VectorRgb { rgb: carried.0.map(Vec3::from) });
        }
        row
    }
}

/// The rotation of `rebounce_shared::link::turn`.
fn turning(from: Vec3, to: Vec3) -> Mat3A {
    Mat3A::from_cols(
        turn(Vec3::X, from, to).into(),
        turn(Vec3::Y, from, to).into(),
        turn(Vec3::Z, from, to).into(),
    )
}

fn total(row: &[Entry]) -> f32 {
    row.iter().map(|e| e.weight()).sum()
}
