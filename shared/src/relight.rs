//! One frame of relighting on the CPU: from direct irradiance at the points to the bounced
//! light at every point. The viewer's compute shaders do the same steps; this is what they are held against.
//!
//! The steps, all linear in the light:
//! 1. *pull* ([`pull`]): from the finest sampled level to the coarsest, a point's direct
//!    irradiance becomes the mean of its children's (paper, 2.1, pull-push);
//! 2. *later bounces* ([`add_bounced`]): to the senders' direct light comes what bounces again,
//!    `e' = e + P (1 + H) F e`;
//! 3. *transport* ([`vectors`]): `i = T e' = S e` (Eq. 15), on all levels but the finest as vector irradiance,
//!    *pushed* level after level: a point's value is its coefficient plus what its parents' values
//!    interpolate to (Eq. 4);
//! 4. *display* ([`display`]): the irradiance along each point's own normal, and on the finest level what its
//!    links bring and its parents say.

use crate::interpolation::mean;
use crate::link::{LaterLink, Sent, VectorRgb};
use crate::rbn::Scene;
use glam::Vec3;

/// Replaces, coarser level by coarser level, the direct irradiance of every point that has
/// children by its children's mean. `irradiance` has one RGB value per direct point.
pub fn pull(scene: &Scene, irradiance: &mut [Vec3]) {
    for l in (0..(scene.meta.direct_levels as usize).saturating_sub(1)).rev() {
        for i in scene.level(l) {
            if let Some(value) = mean(scene.pull().row(i), Vec3::ZERO, |j| irradiance[j]) {
                irradiance[i] = value;
            }
        }
    }
}

/// What the senders send: their irradiance in the colour of their surfaces.
fn sent(scene: &Scene, irradiance: &[Vec3]) -> Vec<Vec3> {
    let senders = &scene.points[..scene.sender_count()];
    senders.iter().zip(irradiance).map(|(point, e)| point.tint() * *e).collect()
}

/// Adds to the senders' pulled direct irradiance what comes to them after one and more bounces: one bounce
/// (F e) and all further ones (H F e) at the points of the coarse levels, interpolated at the finer senders.
pub fn add_bounced(scene: &Scene, pulled: &mut [Vec3]) {
    let coarse = scene.later_count();
    let first = irradiance(scene, &vectors(scene, &sent(scene, pulled), coarse));
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

/// The vector irradiance of the first `count` of the points that have vectors: their links' and their parents'.
/// `sent` has one RGB value per sender. A parent's vectors are turned with the normals, so that a point takes
/// over its parents' irradiance, not what they say about a hemisphere that they did not see.
pub fn vectors(scene: &Scene, sent: &[Vec3], count: usize) -> Vec<VectorRgb> {
    let mut values = Vec::with_capacity(count);
    for (i, row) in scene.vectors.iter().take(count).enumerate() {
        let mut sum = VectorRgb::ZERO;
        for link in row {
            let (vector, power) = (link.vector(), sent[link.sender()]);
            sum.add_scaled(1.0, &VectorRgb { rgb: power.to_array().map(|p| vector * p) });
        }
        let parents = scene.push().row(i);
        let total: f32 = parents.iter().map(|e| e.weight()).sum();
        let normal = scene.points[i].normal();
        for entry in parents.iter().filter(|_| total > 0.0) {
            let parent: &VectorRgb = &values[entry.point()];
            let turned = parent.turned(scene.points[entry.point()].normal(), normal);
            sum.add_scaled(entry.weight() / total, &turned);
        }
        values.push(sum);
    }
    values
}

/// The irradiance of points along their own normals, RGB. The vector was gathered over the point's own
/// hemisphere; along another normal it leaves out what that normal sees beyond, and in a hall of columns 6% of
/// the light.
fn irradiance(scene: &Scene, values: &[VectorRgb]) -> Vec<Vec3> {
    scene.points.iter().zip(values).map(|(point, value)| value.irradiance(point.normal())).collect()
}

/// The irradiance of every point along its own normal, RGB, which pictures interpolate: of the points that have
/// vectors from these, of the others from their links and their parents'.
pub fn display(scene: &Scene, values: &[VectorRgb], sent: &[Vec3]) -> Vec<Vec3> {
    let mut display = irradiance(scene, values);
    for (row, i) in scene.finest.iter().zip(values.len()..) {
        let sum: Vec3 = row.iter().map(|link| link.amount() * sent[link.sender()]).sum();
        let parents = mean(scene.push().row(i), Vec3::ZERO, |parent| display[parent]);
        display.push(sum + parents.unwrap_or(Vec3::ZERO));
    }
    display
}

/// All steps: from direct irradiance at the direct points (RGB, `direct_count` of them) to the
/// bounced irradiance of every point along its own normal.
pub fn relight(scene: &Scene, mut irradiance: Vec<Vec3>) -> Vec<Vec3> {
    pull(scene, &mut irradiance);
    add_bounced(scene, &mut irradiance);
    let sent = sent(scene, &irradiance);
    let values = vectors(scene, &sent, scene.vector_count());
    display(scene, &values, &sent)
}
