//! [Links](rebounce_shared::rbn::gloss_links) to points of glossy surfaces: from the functions where their rays end, and from
//! the emissive surfaces that they hit.
//!
//! A hit is shared among the functions of one level: the coarsest that are narrow enough as seen from the point. Bounced light is
//! smooth; lobes are of five bands.

use super::GlossSettings;
use super::glossy_points::GlossyPoints;
use super::merge::{LinkSum, by_sender, merged, packed};
use super::rays::{PointRay, PointRays};
use crate::basis::{Evaluator, SENDER_OVERLAP, sender_evaluator};
use crate::geometry::{Hit, HitEmitter, Surfaces};
use crate::job::watch::{Stopped, Watch};
use crate::sampling::Points;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::colour::luminance;
use rebounce_shared::kernel::LEAST_WEIGHT;
use rebounce_shared::rbn::LinkMatrix;
use rebounce_shared::rbn::gloss_links::{GlossLink, GlossLinks};
use std::f32::consts::FRAC_1_PI;

/// Greatest ratio of a sender's support radius to its distance, where there are finer levels.
const NARROW: f32 = 0.25;
/// Cosine of the angle between a hit on an emissive surface and the mean direction of a link that it is added to.
const TOGETHER: f32 = 0.98;
/// Greatest mean resultant length of a link from an emissive surface. What is far brighter than its surroundings rings in five
/// bands, and pictures have no radiance below 0; a lobe of this length is at no angle under −1.5% of its peak.
const SMOOTH: f32 = 0.8;
/// Points a task.
const CHUNK: usize = 32;

/// Links by point.
pub(super) struct LinkRows {
    /// A row for each of the first points of the transfer.
    pub links: GlossLinks,
    /// Rays cast.
    pub rays: u64,
}

/// Computes links.
pub(super) struct LinkGather<'a, S: ?Sized> {
    rays: &'a PointRays<'a, S>,
    /// Functions of the sender levels, coarsest first, with their support radii.
    senders: Vec<(Evaluator, f32)>,
    /// By point.
    tints: Vec<Vec3>,
    /// By material.
    group_of: Vec<Option<u32>>,
    /// Mean radiance by group.
    emission: Vec<Vec3>,
    row_links: usize,
}

/// Mean radiance of groups of emissive surfaces over their area, linear RGB.
fn mean_emission<S: Surfaces + ?Sized>(surfaces: &S, group_of: &[Option<u32>], groups: usize) -> Vec<Vec3> {
    let mut sums = vec![(Vec3::ZERO, 0.0f32); groups];
    if let Some(emitters) = surfaces.emitters() {
        for number in 0..emitters.emitter_count() as u32 {
            let emitter = emitters.emitter(number);
            let group = group_of.get(emitter.material as usize).copied().flatten();
            if let Some(sum) = group.and_then(|group| sums.get_mut(group as usize)) {
                let area = emitter.front().length();
                sum.0 += emitter.mean * area;
                sum.1 += area;
            }
        }
    }
    sums.into_iter().map(|(sum, area)| if area > 0.0 { sum / area } else { Vec3::ZERO }).collect()
}

/// Place of the first point, among those of the transfer, beyond the level that has links.
fn linked_end(glossy: &GlossyPoints, most: usize) -> usize {
    let levels = glossy.levels.windows(2).filter(|pair| pair[0] < pair[1]);
    let mut end = 0;
    for pair in levels {
        if end > 0 && pair[1] - pair[0] > most {
            break;
        }
        end = pair[1];
    }
    end
}

impl<'a, S: Surfaces + ?Sized> LinkGather<'a, S> {
    /// Prepares the senders of a file.
    pub fn new(rays: &'a PointRays<'a, S>, file: &BakedScene, settings: &GlossSettings) -> Self {
        let points = rays.points();
        let level = |l: usize| (sender_evaluator(points, l), SENDER_OVERLAP * points.levels[l].disk_radius);
        let group_of = file.sources.group_of_materials();
        let emission = mean_emission(rays.surfaces(), &group_of, file.sources.groups.len());
        Self {
            rays,
            senders: (0..file.meta.sender_levels as usize).map(level).collect(),
            tints: file.points.iter().map(|point| point.tint()).collect(),
            group_of,
            emission,
            row_links: settings.row_links,
        }
    }

    /// Mean radiance by group of emissive surfaces.
    pub fn emission(&self) -> Vec<[f32; 3]> {
        self.emission.iter().map(|radiance| radiance.to_array()).collect()
    }

    /// Computes the rows of the points of one level, and of coarser ones that finer points interpolate.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn rows(
        &self,
        file: &BakedScene,
        glossy: &GlossyPoints,
        settings: &GlossSettings,
        watch: &dyn Watch,
    ) -> Result<LinkRows, Stopped> {
        let end = linked_end(glossy, settings.link_points);
        let first = glossy.levels.iter().rfind(|first| **first < end).copied().unwrap_or(0);
        let mut is_linked = vec![false; end];
        is_linked[first..].fill(true);
        for point in &glossy.points[end..] {
            for parent in file.push().row(*point as usize) {
                let place = glossy.points[..end].binary_search(&(parent.point() as u32));
                place.into_iter().for_each(|place| is_linked[place] = true);
            }
        }
        let linked: Vec<usize> = (0..end).filter(|place| is_linked[*place]).collect();
        let (mut rows, mut rays) = (vec![Vec::new(); end], 0);
        for part in linked.chunks(CHUNK * rayon::current_num_threads()) {
            let row = |place: &usize| self.row(glossy.points[*place] as usize);
            let computed: Vec<(Vec<GlossLink>, u64)> = part.par_iter().map(row).collect();
            watch.step(part.len() as u64)?;
            for (place, (row, cast)) in part.iter().zip(computed) {
                rows[*place] = row;
                rays += cast;
            }
        }
        Ok(LinkRows { links: LinkMatrix::from_rows(&rows), rays })
    }

    /// The links of a point, and the number of rays.
    fn row(&self, point: usize) -> (Vec<GlossLink>, u64) {
        let solid_angle = self.rays.solid_angle();
        let (mut found, mut shining): (_, Vec<LinkSum>) = (Vec::new(), Vec::new());
        let mut weights = Vec::new();
        let rays = self.rays.cast(point, |PointRay { direction, .. }, hit| {
            let Some(hit) = hit else { return };
            if let Some((group, share)) = self.emitted(&hit) {
                add_near(&mut shining, group, solid_angle * share, direction);
            }
            if hit.albedo == Vec3::ZERO {
                return;
            }
            self.weigh(&hit, &mut weights);
            for (sender, weight) in &weights {
                // The amount of the tint that fits the reflectance best.
                let tint = self.tints[*sender as usize];
                let reflectance = hit.albedo.dot(tint) / tint.length_squared();
                let amount = solid_angle * weight * reflectance * FRAC_1_PI;
                found.push(LinkSum { sender: *sender, amount, directions: amount * direction });
            }
        });
        let distance = |a: u32, b: u32| self.unlikeness(self.rays.points(), a as usize, b as usize);
        let mut row = merged(by_sender(found), self.row_links, distance);
        shining.sort_by_key(|link| link.sender);
        for link in &mut shining {
            link.directions = link.directions.clamp_length_max(SMOOTH * link.amount);
        }
        row.extend(shining);
        (packed(&row), rays)
    }

    /// Fills `out` with the senders of a hit and their weights, of sum 1: functions of the coarsest level that is narrow
    /// enough, or of a finer one, or else of a coarser one. None where no function is.
    fn weigh(&self, hit: &Hit, out: &mut Vec<(u32, f32)>) {
        let scale = self.rays.points().scale(hit.group);
        let is_narrow = |(_, radius): &(Evaluator, f32)| radius * scale < NARROW * hit.distance;
        let last = self.senders.len().saturating_sub(1);
        let level = self.senders.iter().position(is_narrow).unwrap_or(last);
        let (coarser, finer) = self.senders.split_at(level);
        for (evaluator, _) in finer.iter().chain(coarser.iter().rev()) {
            out.clear();
            let total =
                evaluator.gather(hit.position, hit.normal, hit.group, |sender, w| out.push((sender, w)));
            if total > LEAST_WEIGHT {
                out.iter_mut().for_each(|(_, weight)| *weight /= total);
                return;
            }
        }
        out.clear();
    }

    /// The sender of what a hit emits, and its radiance relative to the group's mean.
    fn emitted(&self, hit: &Hit) -> Option<(u32, f32)> {
        let Some(HitEmitter::Surface(number)) = hit.emitter else { return None };
        let material = self.rays.surfaces().emitters()?.emitter(number).material;
        let group = self.group_of.get(material as usize).copied().flatten()?;
        let share = luminance(hit.emission) / luminance(*self.emission.get(group as usize)?);
        (share.is_finite() && share > 0.0).then_some((self.tints.len() as u32 + group, share))
    }

    /// How little the light of two senders is alike: distance squared, and more for other normals and other colours.
    fn unlikeness(&self, points: &Points, a: usize, b: usize) -> f32 {
        let (from, to) = (&points.points[a], &points.points[b]);
        let turned = 2.0 - from.normal.dot(to.normal);
        from.position.distance_squared(to.position)
            * turned
            * (1.0 + self.tints[a].distance_squared(self.tints[b]))
    }
}

/// Adds light of an emissive group to the link of that group whose direction is near, or as a link of its own: parts of a
/// group that lie apart stay apart.
fn add_near(links: &mut Vec<LinkSum>, sender: u32, amount: f32, direction: Vec3) {
    let is_near = |link: &&mut LinkSum| {
        link.sender == sender && link.directions.dot(direction) > TOGETHER * link.directions.length()
    };
    match links.iter_mut().find(is_near) {
        Some(link) => {
            link.amount += amount;
            link.directions += amount * direction;
        }
        None => links.push(LinkSum { sender, amount, directions: amount * direction }),
    }
}
