//! Direct irradiance of the points by group of light: the begin of the Neumann series.

use crate::basis::Relations;
use crate::geometry::Surfaces;
use crate::job::watch::{Stopped, Watch};
use crate::light::direct::at_point;
use crate::sampling::Points;
use crate::transport::sources::SourceLinks;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::interpolation::mean;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::relight::from_source_rows;
use smallvec::SmallVec;

/// A group of light: what changes in strength and colour as one.
#[derive(Clone, Debug)]
pub struct GroupSource {
    /// The light at unit strength. A sky's sun is a lamp.
    pub lighting: Lighting,
    /// Whether a part of the light comes from sources with links: the bins of a sky, or emissive surfaces.
    pub has_links: bool,
}

impl GroupSource {
    /// Prepares a light at unit strength.
    pub fn new(lighting: Lighting) -> Self {
        let has_links =
            lighting.sky.is_some() || lighting.emission.iter().any(|factor| *factor != Vec3::ZERO);
        Self { lighting, has_links }
    }
}

/// A value of each point for each group, linear RGB: group after group within a point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GroupField {
    /// Number of groups.
    pub groups: usize,
    /// Values, point after point.
    pub values: Vec<Vec3>,
}

impl GroupField {
    /// Zeros.
    pub fn new(points: usize, groups: usize) -> Self {
        Self { groups, values: vec![Vec3::ZERO; points * groups] }
    }

    /// The values of a point.
    #[inline]
    pub fn at(&self, point: usize) -> &[Vec3] {
        &self.values[point * self.groups..][..self.groups]
    }

    /// The values of a point.
    pub fn at_mut(&mut self, point: usize) -> &mut [Vec3] {
        &mut self.values[point * self.groups..][..self.groups]
    }

    /// Adds the values of another field.
    pub fn add(&mut self, other: &Self) {
        self.values.iter_mut().zip(&other.values).for_each(|(value, other)| *value += *other);
    }

    /// The values of a group, by point.
    pub fn group(&self, group: usize) -> impl Iterator<Item = Vec3> + '_ {
        self.values.iter().skip(group).step_by(self.groups.max(1)).copied()
    }

    /// Mean of the parents' values at a point, by group; zeros without parents.
    pub fn predicted<'a>(
        &'a self,
        relations: &'a Relations,
        point: usize,
    ) -> impl Iterator<Item = Vec3> + 'a {
        let row = relations.push().row(point);
        (0..self.groups).map(move |group| {
            mean(row, Vec3::ZERO, |parent| self.values[parent * self.groups + group]).unwrap_or(Vec3::ZERO)
        })
    }

    /// Replaces the values of a point by the mean of its parents' values.
    pub fn predict(&mut self, relations: &Relations, point: usize) {
        let predicted: SmallVec<[Vec3; 8]> = self.predicted(relations, point).collect();
        self.at_mut(point).copy_from_slice(&predicted);
    }

    /// Replaces the values of the points from `first` on by the mean of their parents' values.
    pub fn push_from(&mut self, relations: &Relations, first: usize) {
        (first..self.values.len() / self.groups.max(1)).for_each(|point| self.predict(relations, point));
    }
}

/// Direct irradiance of the points, per unit strength of each group.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DirectIrradiance {
    /// All of it, as light leaves from the points: a point with children has the mean of theirs.
    pub sent: GroupField,
    /// The part that comes from sources with links, not averaged.
    pub linked: GroupField,
}

/// Computes direct irradiance. `links` are those of the sky and of emissive surfaces. A unit of `watch` is a point.
///
/// # Errors
/// [`Stopped`].
pub fn direct_irradiance<S: Surfaces + ?Sized>(
    surfaces: &S,
    points: &Points,
    relations: &Relations,
    groups: &[GroupSource],
    links: &SourceLinks,
    watch: &dyn Watch,
) -> Result<DirectIrradiance, Stopped> {
    let (count, groups_count) = (points.points.len(), groups.len());
    let linked = linked_irradiance(relations, groups, links, count);
    let mut sent = linked.clone();
    let has_lamps = groups.iter().any(|group| !group.lighting.lamps.is_empty());
    if has_lamps {
        let of_point = |(i, values): (usize, &mut [Vec3])| {
            if i % 64 == 0 {
                watch.step(64)?;
            }
            let point = &points.points[i];
            for (value, group) in values.iter_mut().zip(groups) {
                // The normal of the true surface lies outside; the cosine is that of the shading normal.
                *value += at_point(surfaces, &group.lighting.lamps, point.position, point.normal);
            }
            Ok(())
        };
        sent.values.par_chunks_mut(groups_count).enumerate().try_for_each(of_point)?;
    }
    // Pull: from the finest level to the coarsest, the mean over the children.
    let parents = relations.pull().len();
    for point in (0..parents.min(count)).rev() {
        let row = relations.pull().row(point);
        for group in 0..groups_count {
            let value = mean(row, Vec3::ZERO, |child| sent.values[child * groups_count + group]);
            if let Some(value) = value {
                sent.values[point * groups_count + group] = value;
            }
        }
    }
    Ok(DirectIrradiance { sent, linked })
}

/// Irradiance from the sky and from emissive surfaces, by their links.
pub fn linked_irradiance(
    relations: &Relations,
    groups: &[GroupSource],
    links: &SourceLinks,
    count: usize,
) -> GroupField {
    let mut out = GroupField::new(count, groups.len());
    if links.links.is_empty() {
        return out;
    }
    for (number, group) in groups.iter().enumerate().filter(|(_, group)| group.has_links) {
        let strengths = links.sources.strengths(group.lighting.sky.as_deref(), &group.lighting.emission);
        let rows = links.links.iter().map(Vec::as_slice);
        for (i, value) in from_source_rows(relations.push(), rows, &strengths).into_iter().enumerate() {
            out.at_mut(i)[number] = value;
        }
    }
    out
}
