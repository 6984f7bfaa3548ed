//! Diffuse transfer of all points: from the environment's coefficients to irradiance, without a bounce and after all bounces,
//! as differences from the mean of a point's parents (Lehtinen et al. 2007, 5.2 and 6.4). The operator gives them: the file is
//! relit by each spherical harmonic, and by each group of emissive surfaces.
//!
//! Light without a bounce is kept as its difference from an open point with the same normal, which follows from the normal
//! alone: over a smooth body it varies far less, and a convex one needs no vector at all.

use super::principal_components::{Clustered, Vector, compressed};
use super::sky_functions::{PointIrradiance, by_sky_functions};
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::diffuse_transfer::open;
use rebounce_shared::harmonics::COUNT;
use rebounce_shared::rbn::clustered::NO_CLUSTER;
use rebounce_shared::rbn::diffuse_transfer::{DiffuseTransfer, FROM_GROUP, FROM_SKY, TransferLayout};

/// Settings of diffuse transfer.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferSettings {
    /// A point has a vector of its own if it differs from its parents' mean by more than this, in the norm ‖·‖₂: light of an
    /// even white environment is √π / 2 of it.
    pub epsilon: f32,
    /// Components of a cluster.
    pub components: u32,
}

impl Default for TransferSettings {
    fn default() -> Self {
        Self { epsilon: 0.08, components: 24 }
    }
}

/// Figures of diffuse transfer.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct TransferReport {
    /// Points.
    pub points: u64,
    /// Points with a vector of their own.
    pub vectors: u64,
    /// Root mean square of what compression changes in the vectors, relative to their own.
    pub compression_error: f64,
}

/// Computes the transfer of a file with links from the sky.
pub(super) fn of_file(file: &BakedScene, settings: &TransferSettings) -> (DiffuseTransfer, TransferReport) {
    let skies = by_sky_functions(file);
    let emitters = by_emissive_groups(file);
    let dimensions = FROM_SKY + FROM_GROUP * emitters.len();
    let whole = |i: usize| whole_vector(file, i, &skies, &emitters);
    let push = file.push();
    // Vectors as they come back, without compression.
    let mut known: Vec<Vector> = Vec::with_capacity(file.points.len());
    let (mut clusters, mut stored) = (vec![NO_CLUSTER; file.points.len()], Vec::new());
    for level in 0..file.meta.levels.len() {
        let own = |i: usize| -> (Vector, Option<Vector>) {
            let mut mean: Vector = vec![0.0; dimensions].into();
            let row = push.row(i);
            let total: f32 = row.iter().map(|entry| entry.weight()).sum();
            for entry in row {
                let weight = entry.weight() / total;
                mean.iter_mut().zip(&known[entry.point()]).for_each(|(sum, x)| *sum += x * weight);
            }
            let whole = whole(i);
            let difference: Vector = whole.iter().zip(&mean).map(|(a, b)| a - b).collect();
            match norm(&difference) > settings.epsilon {
                true => (whole, Some(difference)),
                false => (mean, None),
            }
        };
        let found: Vec<(Vector, Option<Vector>)> = file.level(level).into_par_iter().map(own).collect();
        for (i, (whole, own)) in file.level(level).zip(found) {
            known.push(whole);
            stored.extend(own.map(|own| (i, own)));
        }
    }
    drop(known);
    let all: Vec<&[f32]> = stored.iter().map(|(_, own)| &**own).collect();
    let packed = compressed(&all, settings.components);
    for ((i, _), cluster) in stored.iter().zip(&packed.clusters) {
        clusters[*i] = *cluster;
    }
    let Clustered { scales, weights, vectors, error, .. } = packed;
    let report = TransferReport {
        points: file.points.len() as u64,
        vectors: stored.len() as u64,
        compression_error: error,
    };
    let layout = TransferLayout { groups: emitters.len() as u32, scales };
    (DiffuseTransfer { layout, clusters, weights, vectors }, report)
}

/// Relights a file by each group of emissive surfaces at unit strength.
fn by_emissive_groups(file: &BakedScene) -> Vec<PointIrradiance> {
    let count = file.sources.groups.len();
    let of = |group: usize| {
        let mut strengths = vec![Vec3::ZERO; count];
        strengths[group] = Vec3::ONE;
        PointIrradiance::relit(file, &file.sources.strengths(None, &strengths))
    };
    (0..count).into_par_iter().map(of).collect()
}

/// The vector of a point, as [`rebounce_shared::rbn::diffuse_transfer`] has it, before the parents' mean is taken off.
fn whole_vector(
    file: &BakedScene,
    i: usize,
    skies: &[PointIrradiance],
    emitters: &[PointIrradiance],
) -> Vector {
    let open: [f32; COUNT] = open(file.points[i].normal());
    let hidden = skies.iter().zip(open).map(|(sky, open)| sky.direct[i].x - open);
    let bounced = (0..3).flat_map(|channel| skies.iter().map(move |sky| sky.bounced[i][channel]));
    let emitted = emitters.iter().flat_map(|group| [group.direct[i].to_array(), group.bounced[i].to_array()]);
    hidden.chain(bounced).chain(emitted.flatten()).collect()
}

/// ‖·‖₂, with the mean over the channels of coloured light.
fn norm(vector: &[f32]) -> f32 {
    let squares = |part: &[f32]| part.iter().map(|x| x * x).sum::<f32>();
    let (direct, coloured) = vector.split_at(COUNT);
    (squares(direct) + squares(coloured) / 3.0).sqrt()
}
