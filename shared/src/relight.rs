//! One frame of relighting on the CPU: from direct irradiance at the points to the bounced
//! light's vector irradiance at every point. The viewer's compute shaders do the same steps;
//! this is what they are held against.
//!
//! The steps, all linear in the light:
//! 1. *pull* ([`pull`]): from the finest sampled level to the coarsest, a point's direct
//!    irradiance becomes the mean of its children's (paper, 2.1, pull-push);
//! 2. *later bounces* ([`add_bounced`]): to the senders' direct light comes what bounces again,
//!    `e' = (1 + P G) e`;
//! 3. *transport* ([`transport`]): `i = T e' = S e` (Eq. 15);
//! 4. *push* ([`push`]): level after level, a point's value is its coefficient plus what its
//!    parents' values interpolate to (Eq. 4). The finest level's values are the display basis.

use crate::interpolation::mean;
use crate::link::{VectorRgb, columns};
use crate::rbn::{LinkMatrix, Scene};
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

/// Adds to the senders' pulled direct irradiance what comes to them after one and more bounces:
/// `G e` at the points of the coarse levels, its interpolation at the finer senders.
pub fn add_bounced(scene: &Scene, pulled: &mut [Vec3]) {
    let coarse = scene.later_count();
    let vectors = apply(&scene.later, pulled, coarse);
    let mut bounced: Vec<Vec3> =
        vectors.iter().zip(&scene.points).map(|(v, p)| v.irradiance(p.normal())).collect();
    for i in coarse..scene.sender_count() {
        let interpolated = mean(scene.push().row(i), Vec3::ZERO, |parent| bounced[parent]);
        bounced.push(interpolated.unwrap_or(Vec3::ZERO));
    }
    for (e, bounced) in pulled.iter_mut().zip(bounced) {
        *e += bounced;
    }
}

/// `i = T e'`: the coefficients of the bounced light, one per point, zero without links.
/// `sent` has one RGB irradiance per sender, or more.
pub fn transport(scene: &Scene, sent: &[Vec3]) -> Vec<VectorRgb> {
    apply(&scene.transport, sent, scene.points.len())
}

/// A matrix of links times irradiance: vector irradiance at this many receivers.
fn apply(matrix: &LinkMatrix, pulled: &[Vec3], receivers: usize) -> Vec<VectorRgb> {
    let mut out = vec![VectorRgb::ZERO; receivers];
    for (receiver, row) in matrix.iter() {
        let sum = &mut out[receiver];
        for (column, link) in columns(row) {
            let power = link.magnitude() * pulled[column];
            let direction = link.direction();
            for c in 0..3 {
                sum.rgb[c] += direction * power[c];
            }
        }
    }
    out
}

/// Turns coefficients into values, in place: coarse to fine, each point adds what its parents'
/// values interpolate to. A parent's vectors are turned with the normals, so that a point takes
/// over its parents' irradiance, not what they say about a hemisphere that they did not see.
pub fn push(scene: &Scene, values: &mut [VectorRgb]) {
    for i in 0..scene.points.len() {
        let row = scene.push().row(i);
        let total: f32 = row.iter().map(|e| e.weight()).sum();
        let normal = scene.points[i].normal();
        let mut sum = values[i];
        for entry in row {
            let parent = entry.point();
            let turned = values[parent].turned(scene.points[parent].normal(), normal);
            sum.add_scaled(entry.weight() / total, &turned);
        }
        values[i] = sum;
    }
}

/// The irradiance of every point along its own normal, RGB, from its vector irradiance: what a
/// picture interpolates. The vector was gathered over the point's own hemisphere; along another
/// normal it leaves out what that normal sees beyond, and in a hall of columns 6% of the light.
pub fn irradiance(scene: &Scene, values: &[VectorRgb]) -> Vec<Vec3> {
    scene.points.iter().zip(values).map(|(point, value)| value.irradiance(point.normal())).collect()
}

/// All steps: from direct irradiance at the direct points (RGB, `direct_count` of them) to the
/// bounced light at every point.
pub fn relight(scene: &Scene, mut irradiance: Vec<Vec3>) -> Vec<VectorRgb> {
    pull(scene, &mut irradiance);
    add_bounced(scene, &mut irradiance);
    let mut values = transport(scene, &irradiance);
    push(scene, &mut values);
    values
}
