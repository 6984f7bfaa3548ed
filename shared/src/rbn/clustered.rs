//! Vectors compressed by clustered principal component analysis (Sloan, Hall, Hart and Snyder 2003): the mean of a cluster
//! plus weighted components. Numbers are signed bytes times the scale of their vector.

use super::RbnError;
use super::limits::sane;
use bincode::{Decode, Encode};

/// Cluster of a point without a vector of its own.
pub const NO_CLUSTER: u8 = 255;
/// Maximum number of components of a cluster.
pub const MAX_COMPONENTS: usize = 64;

/// Sizes and scales, in the small section of a transfer.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct ClusterScales {
    /// Components of each cluster.
    pub components: u32,
    /// By cluster, the scale of its mean and of each component.
    pub vectors: Vec<f32>,
    /// By cluster, the scale of the weights of each component.
    pub weights: Vec<f32>,
}

impl ClusterScales {
    /// Vectors of a cluster: its mean and its components.
    pub fn per_cluster(&self) -> usize {
        1 + self.components as usize
    }

    /// Number of clusters.
    pub fn clusters(&self) -> usize {
        self.vectors.len() / self.per_cluster()
    }
}

/// Compressed vectors as they are in a file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clustered<'a> {
    /// Of means, components and weights.
    pub scales: &'a ClusterScales,
    /// By vector, its weights: a byte a component.
    pub weights: &'a [u8],
    /// By cluster the mean and the components.
    pub vectors: &'a [u8],
}

impl<'a> Clustered<'a> {
    /// Applies `applied` to every cluster's mean and components, cluster after cluster: what a vector stands for is the sum of
    /// [`Self::terms`].
    pub fn map<T>(&self, applied: impl Fn(&[f32]) -> T) -> Vec<T> {
        let size = self.vectors.len() / self.scales.vectors.len().max(1);
        let mut numbers = Vec::with_capacity(size);
        let of = |(bytes, scale): (&[u8], &f32)| {
            numbers.clear();
            numbers.extend(bytes.iter().map(|byte| f32::from(*byte as i8) * scale));
            applied(&numbers)
        };
        self.vectors.chunks_exact(size.max(1)).zip(&self.scales.vectors).map(of).collect()
    }

    /// Terms of the vector with this number, of a cluster: the mean with a weight of 1, then the weighted components. `applied`
    /// is what [`Self::map`] returned.
    pub fn terms<'t, T>(
        &self,
        vector: usize,
        cluster: usize,
        applied: &'t [T],
    ) -> impl Iterator<Item = (&'t T, f32)> + use<'a, 't, T> {
        let count = self.scales.components as usize;
        let scales = &self.scales.weights[cluster * count..][..count];
        let bytes = &self.weights[vector * count..][..count];
        let weights = bytes.iter().zip(scales).map(|(byte, scale)| f32::from(*byte as i8) * scale);
        applied[cluster * self.scales.per_cluster()..].iter().zip(std::iter::once(1.0).chain(weights))
    }

    /// Checks data of unknown origin, for vectors of `dimensions` numbers of points with these `clusters`. `sections` has the
    /// names of the sections with the scales, clusters, weights and vectors.
    ///
    /// # Errors
    /// [`RbnError::Invalid`].
    pub fn check(&self, dimensions: usize, of_points: &[u8], sections: [&str; 4]) -> Result<(), RbnError> {
        let [layout, clusters, weights, vectors] = sections;
        let scales = self.scales;
        let components = scales.components as usize;
        if components > MAX_COMPONENTS {
            return Err(RbnError::invalid(layout, "components"));
        }
        let count = scales.clusters();
        let fits = scales.vectors.len() == count * scales.per_cluster()
            && scales.weights.len() == count * components
            && count < usize::from(NO_CLUSTER);
        if !fits || !scales.vectors.iter().chain(&scales.weights).all(|x| sane(*x)) {
            return Err(RbnError::invalid(layout, "scales"));
        }
        if self.vectors.len() != scales.vectors.len() * dimensions {
            return Err(RbnError::invalid(vectors, "it does not fit the clusters"));
        }
        if !of_points.iter().all(|cluster| *cluster == NO_CLUSTER || usize::from(*cluster) < count) {
            return Err(RbnError::invalid(clusters, "it does not fit the points"));
        }
        if self.weights.len() != stored(of_points) * components {
            return Err(RbnError::invalid(weights, "it does not fit the vectors"));
        }
        Ok(())
    }
}

/// Number of points with a vector of their own.
pub(crate) fn stored(clusters: &[u8]) -> usize {
    clusters.iter().filter(|cluster| **cluster != NO_CLUSTER).count()
}
