//! Clustered principal component analysis (Sloan, Hall, Hart and Snyder 2003): vectors as the mean of a cluster plus weighted
//! components, all in signed bytes.
//!
//! Clusters are those of k-means over the vectors, seeded evenly along the points' order, which is a space-filling
//! curve a level. Components are the leading eigenvectors of a cluster's covariance, by subspace iteration.

use rayon::prelude::*;
use rebounce_shared::rbn::clustered::ClusterScales;

/// A vector, of any meaning.
pub(in crate::transport) type Vector = Box<[f32]>;

/// Vectors of a cluster, about.
const PER_CLUSTER: usize = 256;
/// Largest number of clusters.
const MOST_CLUSTERS: usize = 64;
/// Rounds of k-means.
const ROUNDS: usize = 8;
/// Rounds of subspace iteration.
const ITERATIONS: usize = 12;

fn dot(a: &[f32], b: &[f32]) -> f32 {
    // Eight sums, so that the compiler may use lanes.
    let mut sums = [0.0f32; 8];
    let (a, rest_a) = a.as_chunks::<8>();
    let (b, rest_b) = b.as_chunks::<8>();
    for (a, b) in a.iter().zip(b) {
        for lane in 0..8 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f32 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f32>() + rest
}

fn distance_squared(a: &[f32], b: &[f32]) -> f32 {
    dot(a, a) - 2.0 * dot(a, b) + dot(b, b)
}

fn mean_of<'v>(mut vectors: impl Iterator<Item = &'v [f32]>) -> Option<Vector> {
    let mut sum = Vector::from(vectors.next()?);
    let mut count = 1.0f32;
    for vector in vectors {
        sum.iter_mut().zip(vector).for_each(|(sum, x)| *sum += x);
        count += 1.0;
    }
    sum.iter_mut().for_each(|x| *x /= count);
    Some(sum)
}

/// Returns the cluster of each vector.
fn clusters(vectors: &[&[f32]], count: usize) -> Vec<usize> {
    let seed = |k: usize| Vector::from(vectors[(2 * k + 1) * vectors.len() / (2 * count)]);
    let mut means: Vec<Vector> = (0..count).map(seed).collect();
    let mut out = vec![0; vectors.len()];
    for _ in 0..ROUNDS {
        let nearest = |vector: &&[f32]| {
            let distances = means.iter().map(|mean| distance_squared(vector, mean));
            let least = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
            least.map_or(0, |(cluster, _)| cluster)
        };
        out = vectors.par_iter().map(nearest).collect();
        let of = |k: usize| {
            let own = vectors.iter().zip(&out).filter(|(_, cluster)| **cluster == k);
            mean_of(own.map(|(vector, _)| *vector))
        };
        let fresh: Vec<_> = (0..count).into_par_iter().map(of).collect();
        for (mean, fresh) in means.iter_mut().zip(fresh) {
            *mean = fresh.unwrap_or_else(|| mean.clone());
        }
    }
    out
}

/// Makes vectors orthonormal (Gram and Schmidt, twice); what is left of dependent ones becomes zero.
fn orthonormalise(vectors: &mut [Vector]) {
    for i in 0..vectors.len() {
        let (before, rest) = vectors.split_at_mut(i);
        let own = &mut rest[0];
        for _ in 0..2 {
            for other in before.iter() {
                let along = dot(&own[..], &other[..]);
                own.iter_mut().zip(other.iter()).for_each(|(x, o)| *x -= along * o);
            }
        }
        let length = dot(&own[..], &own[..]).sqrt();
        let scale = if length > 1e-9 { 1.0 / length } else { 0.0 };
        own.iter_mut().for_each(|x| *x *= scale);
    }
}

/// The leading components of vectors without their mean.
fn components(centred: &[Vector], count: usize, dimensions: usize) -> Vec<Vector> {
    let zero = || Vector::from(vec![0.0; dimensions]);
    let start = |k: usize| match centred.len() {
        0 => zero(),
        len => centred[(2 * k + 1) * len / (2 * count)].clone(),
    };
    let mut basis: Vec<Vector> = (0..count).map(start).collect();
    orthonormalise(&mut basis);
    for _ in 0..ITERATIONS {
        let mut next = vec![zero(); count];
        for vector in centred {
            for (next, own) in next.iter_mut().zip(&basis) {
                let along = dot(&vector[..], &own[..]);
                next.iter_mut().zip(vector.iter()).for_each(|(sum, x)| *sum += along * x);
            }
        }
        basis = next;
        orthonormalise(&mut basis);
    }
    basis
}

/// Bytes of numbers, and their scale.
fn to_bytes(numbers: &[f32]) -> (Vec<u8>, f32) {
    let largest = numbers.iter().fold(0.0f32, |most, x| most.max(x.abs()));
    let scale = if largest > 0.0 { largest / 127.0 } else { 1.0 };
    (numbers.iter().map(|x| (x / scale).round() as i8 as u8).collect(), scale)
}

fn from_bytes(bytes: &[u8], scale: f32) -> Vector {
    bytes.iter().map(|byte| f32::from(*byte as i8) * scale).collect()
}

/// A compressed cluster.
struct Compressed {
    vectors: Vec<u8>,
    vector_scales: Vec<f32>,
    weight_scales: Vec<f32>,
    /// By member.
    weights: Vec<Vec<u8>>,
    /// Sum of squares of what is lost.
    lost: f64,
}

fn compress(members: &[&[f32]], count: usize, dimensions: usize) -> Compressed {
    let mean = mean_of(members.iter().copied()).unwrap_or_else(|| vec![0.0; dimensions].into());
    let (bytes, scale) = to_bytes(&mean[..]);
    let mean = from_bytes(&bytes, scale);
    let centre = |member: &&[f32]| {
        let mut own = Vector::from(*member);
        own.iter_mut().zip(mean.iter()).for_each(|(x, mean)| *x -= mean);
        own
    };
    let centred: Vec<Vector> = members.iter().map(centre).collect();
    let (mut vectors, mut vector_scales) = (bytes, vec![scale]);
    let mut stored = Vec::new();
    for component in components(&centred, count, dimensions) {
        let (bytes, scale) = to_bytes(&component[..]);
        stored.push(from_bytes(&bytes, scale));
        vectors.extend(bytes);
        vector_scales.push(scale);
    }
    // Weights on what is stored, one after the other, so that each also mends the rounding of those before.
    let mut left = centred;
    let mut weights = vec![Vec::with_capacity(count); members.len()];
    let mut weight_scales = Vec::with_capacity(count);
    for component in &stored {
        let size = dot(&component[..], &component[..]).max(1e-20);
        let along: Vec<f32> = left.iter().map(|own| dot(&own[..], &component[..]) / size).collect();
        let (bytes, scale) = to_bytes(&along);
        weight_scales.push(scale);
        for ((own, weights), byte) in left.iter_mut().zip(&mut weights).zip(bytes) {
            let weight = f32::from(byte as i8) * scale;
            own.iter_mut().zip(component.iter()).for_each(|(x, c)| *x -= weight * c);
            weights.push(byte);
        }
    }
    let lost = left.iter().map(|own| f64::from(dot(&own[..], &own[..]))).sum();
    Compressed { vectors, vector_scales, weight_scales, weights, lost }
}

/// Compressed vectors.
#[derive(Default)]
pub(in crate::transport) struct Clustered {
    /// By vector.
    pub clusters: Vec<u8>,
    /// Of means, components and weights.
    pub scales: ClusterScales,
    /// By vector, a byte a component.
    pub weights: Vec<u8>,
    /// By cluster the mean and the components.
    pub vectors: Vec<u8>,
    /// Root mean square of what is lost relative to that of the vectors.
    pub error: f64,
}

/// Compresses vectors of equal length, in the order of their points; empty without any.
pub(in crate::transport) fn compressed(all: &[&[f32]], components: u32) -> Clustered {
    let Some(dimensions) = all.first().map(|first| first.len()) else { return Clustered::default() };
    let count = all.len().div_ceil(PER_CLUSTER).min(MOST_CLUSTERS);
    let cluster_of = clusters(all, count);
    let members = |k: usize| -> Vec<&[f32]> {
        all.iter().zip(&cluster_of).filter(|(_, cluster)| **cluster == k).map(|(vector, _)| *vector).collect()
    };
    let packed: Vec<Compressed> =
        (0..count).into_par_iter().map(|k| compress(&members(k), components as usize, dimensions)).collect();
    let power: f64 = all.iter().map(|own| f64::from(dot(own, own))).sum();
    let lost: f64 = packed.iter().map(|cluster| cluster.lost).sum();
    let mut next = vec![0; count];
    let mut weights = Vec::new();
    for cluster in &cluster_of {
        weights.extend(&packed[*cluster].weights[next[*cluster]]);
        next[*cluster] += 1;
    }
    Clustered {
        // There are fewer clusters than a byte can tell apart.
        clusters: cluster_of.iter().map(|cluster| *cluster as u8).collect(),
        scales: ClusterScales {
            components,
            vectors: packed.iter().flat_map(|cluster| cluster.vector_scales.clone()).collect(),
            weights: packed.iter().flat_map(|cluster| cluster.weight_scales.clone()).collect(),
        },
        weights,
        vectors: packed.into_iter().flat_map(|cluster| cluster.vectors).collect(),
        error: (lost / power.max(1e-30)).sqrt(),
    }
}
