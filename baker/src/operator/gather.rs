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
    /// Index of the first point of each sender level, and one past the last sender.
    pub sender_levels: &'a [usize],
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

/// What one gather finds.
#[derive(Clone, Debug, Default)]
pub struct Gathered {
    /// The links, columns ascending: differences to what coarser receivers say.
    pub links: Vec<Link>,
    /// Of a point that is a sender itself: its whole irradiance per channel from each sender,
    /// for later bounces. Empty for other points.
    pub irradiance: Vec<(u32, Vec3)>,
    /// The cost.
    pub cost: GatherCost,
}

/// A thread's working memory, reused from receiver to receiver.
pub struct Scratch {
    sums: Vec<Sum>,
    /// Magnitude before differences.
    whole: Vec<f32>,
    is_touched: Vec<bool>,
    /// Touched senders by level.
    touched: Vec<Vec<u32>>,
    weights: Vec<(u32, f32)>,
    ancestor_weight: Vec<f32>,
    ancestors: Vec<Vec<u32>>,
    order: Vec<u32>,
}

impl Scratch {
    /// Working memory for this many senders on this many sender levels, and points on all levels.
    pub fn new(senders: usize, sender_levels: usize, points: usize, levels: usize) -> Self {
        Self {
            sums: vec![Sum::default(); senders],
            whole: vec![0.0; senders],
            is_touched: vec![false; senders],
            touched: vec![Vec::new(); sender_levels],
            weights: Vec::new(),
            ancestor_weight: vec![0.0; points],
            ancestors: vec![Vec::new(); levels],
            order: Vec::new(),
        }
    }

    /// Fills `order` with the touched senders, ascending.
    fn sort_touched(&mut self) {
        self.order.clear();
        for touched in &self.touched {
            self.order.extend_from_slice(touched);
        }
        self.order.sort_unstable();
    }

    #[inline]
    fn touch(&mut self, sender: u32, level: usize) {
        if !self.is_touched[sender as usize] {
            self.is_touched[sender as usize] = true;
            self.touched[level].push(sender);
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
        let irradiance = if receiver < self.sender_count() {
            self.irradiance_row(self.points.points[receiver].normal, scratch)
        } else {
            Vec::new()
        };
        self.subtract_coarser(receiver, level, rows, scratch);
        let links = self.choose(self.settings.epsilon_on(level), directions.len(), scratch);
        for touched in &mut scratch.touched {
            for sender in touched.drain(..) {
                scratch.sums[sender as usize] = Sum::default();
                scratch.is_touched[sender as usize] = false;
            }
        }
        Gathered { links, irradiance, cost }
    }

    fn sender_count(&self) -> usize {
        self.sender_levels.last().copied().unwrap_or(0)
    }

    fn level_of(&self, sender: u32) -> usize {
        self.sender_levels.partition_point(|&first| first <= sender as usize) - 1
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
            let level = self.level_of(weights[0].0);
            for &(sender, share) in &weights {
                scratch.touch(sender, level);
                scratch.sums[sender as usize].add_scaled(share, &arriving);
            }
        }
        scratch.weights = weights;
        for touched in &scratch.touched {
            for &sender in touched {
                scratch.whole[sender as usize] = scratch.sums[sender as usize].magnitude_squared().sqrt();
            }
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
                    let sender_level = self.level_of(column as u32);
                    if !scratch.is_touched[column] {
                        scratch.whole[column] = 0.0;
                        scratch.touch(column as u32, sender_level);
                    }
                    let direction = turn * self.link_directions[(link.column_direction >> 16) as usize];
                    let magnitude = link.magnitude() * weight;
                    let sum = &mut scratch.sums[column].0;
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

    /// The whole irradiance from each sender, small shares carried over as in [`Self::choose`].
    fn irradiance_row(&self, normal: Vec3, scratch: &mut Scratch) -> Vec<(u32, Vec3)> {
        let least = 2.0 * self.settings.epsilon_on(0);
        let normal = Vec3A::from(normal);
        scratch.sort_touched();
        let mut carried = Vec3::ZERO;
        let mut row = Vec::new();
        for &sender in &scratch.order {
            let sum = &scratch.sums[sender as usize].0;
            carried += Vec3::new(sum[0].dot(normal), sum[1].dot(normal), sum[2].dot(normal));
            if carried.max_element() > least {
                row.push((sender, std::mem::take(&mut carried)));
            }
        }
        row
    }

    /// The criterion of Fig. 5, ε, and two changes to it: a link must stand out of its own noise,
    /// and what is dropped is carried over to the next sender along the space-filling curve until
    /// it adds up to a link. So a row keeps its sum, and what a dropped link would have said is
    /// said by a neighbour: senders that are too small to matter one by one act as one.
    fn choose(&self, epsilon: f32, rays: usize, scratch: &mut Scratch) -> Vec<Link> {
        scratch.sort_touched();
        let mut row = Vec::new();
        let mut writer = RowWriter::default();
        // The variance of a mean of rays that either hit the sender or do not, per unit seen.
        let noise = self.settings.significance.powi(2) / rays as f32;
        let (mut carried, mut seen) = (Sum::default(), 0.0);
        for &sender in &scratch.order {
            carried.add_scaled(1.0, &scratch.sums[sender as usize]);
            seen += scratch.whole[sender as usize];
            if carried.magnitude_squared() > (noise * seen).max(epsilon * epsilon) {
                let link = Link::pack_vectors(0, &VectorRgb { rgb: carried.0.map(Vec3::from) });
                writer.push(&mut row, sender, link);
                // What packing lost is carried over too.
                carried.add_scaled(-1.0, &Sum(link.vectors().rgb.map(Vec3A::from)));
                seen = 0.0;
            }
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
