//! One frame of relighting on the CPU: from direct irradiance at the points to bounced irradiance at every point.
//! Reference for the compute shaders of the viewer.
//!
//! Steps, linear in the light:
//! 1. *pull* ([`pull`]): from the finest sampled level to the coarsest, the direct irradiance of a point becomes the
//!    mean over its children (paper, 2.1, pull-push);
//! 2. *later bounces* ([`add_bounced`]): light of further bounces is added to the senders' direct irradiance,
//!    `e' = e + P (1 + H) F e`;
//! 3. *transport* ([`transport`]): `i = T e' = S e` (Eq. 15) along each point's own normal, *pushed* level by level:
//!    a point's value is its coefficient plus the interpolation of its parents' values (Eq. 4).

use crate::baked::BakedScene;
use crate::interpolation::{Rows, mean};
use crate::link::{LaterLink, Link, Sent, SourceLink};
use glam::Vec3;

/// Replaces the direct irradiance of every point with children by the mean over the children, from fine levels to
/// coarse. `irradiance` has one RGB value per direct point.
pub fn pull(scene: &BakedScene, irradiance: &mut [Vec3]) {
    for l in (0..(scene.meta.direct_levels as usize).saturating_sub(1)).rev() {
        for i in scene.level(l) {
            if let Some(value) = mean(scene.pull().row(i), Vec3::ZERO, |j| irradiance[j]) {
                irradiance[i] = value;
            }
        }
    }
}

/// Returns the light sent by the senders: irradiance times tint.
pub fn sent(scene: &BakedScene, irradiance: &[Vec3]) -> Vec<Vec3> {
    let senders = &scene.points[..scene.sender_count()];
    senders.iter().zip(irradiance).map(|(point, e)| point.tint() * *e).collect()
}

/// Adds bounced light to the senders' pulled direct irradiance: the first bounce (F e) and further bounces (H F e) at
/// the points of the coarse levels, interpolated at the finer senders.
pub fn add_bounced(scene: &BakedScene, pulled: &mut [Vec3]) {
    let coarse = scene.later_count();
    let first = transport(scene, &sent(scene, pulled), coarse);
    let further =
        |row: &[LaterLink]| row.iter().map(|link| link.colour() * first[link.sender()]).sum::<Vec3>();
    let mut bounced: Vec<Vec3> =
        scene.later.iter().zip(&first).map(|(row, first)| *first + further(row)).collect();
    for i in coarse..scene.sender_count() {
        let interpolated = mean(scene.push().row(i), Vec3::ZERO, |parent| bounced[parent]);
        bounced.push(interpolated.unwrap_or(Vec3::ZERO));
    }
    for (e, bounced) in pulled.iter_mut().zip(bounced) {
        *e += bounced;
    }
}

/// Returns the irradiance of the first `count` points along their own normals, RGB: sum over links plus interpolation
/// of the parents. `sent` has one RGB value per sender. A parent's irradiance is along the parent's normal and was
/// gathered over the parent's hemisphere; along another normal it would miss light from outside the parent's
/// hemisphere (6% of the light in a hall of columns).
pub fn transport(scene: &BakedScene, sent: &[Vec3], count: usize) -> Vec<Vec3> {
    let rows = scene.links.iter().take(count);
    pushed(scene.push(), rows, |link: &Link| link.amount() * sent[link.sender()])
}

/// Returns the irradiance of every point along its own normal from the [sources](crate::rbn::sources), RGB, without a
/// bounce; `strengths` has one RGB value per source ([`Sources::strengths`](crate::rbn::sources::Sources::strengths)).
/// Empty without sources. Points pass it on: it is added to the direct irradiance before [`relight`].
pub fn from_sources(scene: &BakedScene, strengths: &[Vec3]) -> Vec<Vec3> {
    if scene.source_links.is_empty() {
        return Vec::new();
    }
    from_source_rows(scene.push(), scene.source_links.iter(), strengths)
}

/// As [`from_sources`], of a row of links per point; `push` has the parents of the points.
pub fn from_source_rows<'l>(
    push: Rows<'_>,
    rows: impl Iterator<Item = &'l [SourceLink]>,
    strengths: &[Vec3],
) -> Vec<Vec3> {
    pushed(push, rows, |link: &SourceLink| link.steps() as f32 * strengths[link.sender()])
}

/// Irradiance of points from groups of light that stay in place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GroupIrradiance {
    /// Of light that bounced at least once; a value for each point, linear RGB.
    pub bounced: Vec<Vec3>,
    /// Straight from the sky and emissive surfaces, likewise.
    pub direct: Vec<Vec3>,
}

/// Returns the irradiance of every point along its own normal from the [groups of light](crate::rbn::light_groups) of a
/// fixed solution; `strengths` has one RGB value per group ([`group_strengths`](crate::light_group::group_strengths)). Linear in
/// each strength. Zeros without groups.
pub fn from_groups(scene: &BakedScene, strengths: &[Vec3]) -> GroupIrradiance {
    let (all, zeros) = (&scene.light_groups, vec![Vec3::ZERO; scene.points.len()]);
    let mut out = GroupIrradiance { bounced: zeros.clone(), direct: zeros };
    let add = |sums: &mut [Vec3], group: usize, column: usize, strength: Vec3| {
        let irradiance = all.irradiance(group, column, scene.push());
        sums.iter_mut().zip(irradiance).for_each(|(sum, irradiance)| *sum += strength * irradiance);
    };
    let strengths = (0..all.groups.len()).zip(strengths);
    for (group, strength) in strengths.filter(|(_, strength)| **strength != Vec3::ZERO) {
        add(&mut out.bounced, group, group, *strength);
        if let Some(column) = all.direct_column(group) {
            add(&mut out.direct, group, column, *strength);
        }
    }
    out
}

/// Values of points, coarsest first: the sum of `amount` over a point's row, plus the mean of its parents' values.
fn pushed<'l, L: 'l>(
    push: Rows<'_>,
    rows: impl Iterator<Item = &'l [L]>,
    amount: impl Fn(&L) -> Vec3,
) -> Vec<Vec3> {
    let mut values: Vec<Vec3> = Vec::with_capacity(push.len());
    for (i, row) in rows.enumerate() {
        let own: Vec3 = row.iter().map(&amount).sum();
        let parents = mean(push.row(i), Vec3::ZERO, |parent| values[parent]);
        values.push(own + parents.unwrap_or(Vec3::ZERO));
    }
    values
}

/// Runs the steps: from direct irradiance at the direct points (RGB, `direct_count` values) to the bounced irradiance
/// of every point along its own normal.
pub fn relight(scene: &BakedScene, irradiance: Vec<Vec3>) -> Vec<Vec3> {
    transport(scene, &sent_after_bounces(scene, irradiance), scene.points.len())
}

/// Runs the steps before the last: from direct irradiance at the direct points to the light that the senders send, of all
/// bounces. [`transport`] takes it on.
pub fn sent_after_bounces(scene: &BakedScene, mut irradiance: Vec<Vec3>) -> Vec<Vec3> {
    pull(scene, &mut irradiance);
    add_bounced(scene, &mut irradiance);
    sent(scene, &irradiance)
}
