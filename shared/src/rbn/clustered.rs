//! Vectors compressed by clustered principal component analysis (Sloan, Hall, Hart and Snyder 2003): the mean of a cluster
//! plus weighted components. Numbers are signed bytes times the scale of their vector.

use super::RbnError;
use super::limits::sane;

/// Cluster of a point without a vector of its own.
pub const NO_CLUSTER: u8 = 255;
/// Maximum number of components of a cluster.
pub const MAX_COMPONENTS: usize = 64;

/// Compressed vectors as they are in a file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clustered<'a> {
    /// Components of each cluster.
    pub components: u32,
    /// By cluster, the scale of its mean and of each component.
    pub vector_scales: &'a [f32],
    /// By cluster, the scale of the weights of each component.
    pub weight_scales: &'a [f32],
    /// By vector, its weights: a byte a component.
    pub weights: &'a [u8],
    /// By cluster the mean and the components.
    pub vectors: &'a [u8],
}

impl<'a> Clustered<'a> {
    /// Number of clusters.
    pub fn clusters(&self) -> usize {
        self.vector_scales.len() / (1 + self.components as usize)
    }

    /// A vector of a cluster: 0 the mean, then the components.
    pub fn vector(&self, cluster: usize, number: usize) -> impl Iterator<Item = f32> + use<'a> {
        let place = cluster * (1 + self.components as usize) + number;
        let size = self.vectors.len() / self.vector_scales.len();
        numbers(&self.vectors[place * size..][..size], self.vector_scales[place])
    }

    /// Weights of the vector with this number, of a cluster.
    pub fn weights_of(&self, vector: usize, cluster: usize) -> impl Iterator<Item = f32> + use<'a> {
        let count = self.components as usize;
        let scales = &self.weight_scales[cluster * count..][..count];
        let bytes = &self.weights[vector * count..][..count];
        bytes.iter().zip(scales).map(|(byte, scale)| f32::from(*byte as i8) * scale)
    }

    /// Checks data of unknown origin, for vectors of `dimensions` numbers of points with these `clusters`. `sections` has the
    /// names of the sections with the scales, clusters, weights and vectors.
    ///
    /// # Errors
    /// [`RbnError::Invalid`].
    pub fn check(&self, dimensions: usize, of_points: &[u8], sections: [&str; 4]) -> Result<(), RbnError> {
        let [layout, clusters, weights, vectors] = sections;
        let components = self.components as usize;
        if components > MAX_COMPONENTS {
            return Err(RbnError::invalid(layout, "components"));
        }
        let count = self.clusters();
        let fits = self.vector_scales.len() == count * (1 + components)
            && self.weight_scales.len() == count * components
            && count < usize::from(NO_CLUSTER);
        if !fits || !self.vector_scales.iter().chain(self.weight_scales).all(|x| sane(*x)) {
            return Err(RbnError::invalid(layout, "scales"));
        }
        if self.vectors.len() != self.vector_scales.len() * dimensions {
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

fn numbers(bytes: &[u8], scale: f32) -> impl Iterator<Item = f32> {
    bytes.iter().map(move |byte| f32::from(*byte as i8) * scale)
}
