//! Diffuse transfer: from the environment to the irradiance of every point (Sloan, Kautz and Snyder 2002), in place of links.
//! Optional sections of files that are [for an environment](crate::diffuse_transfer).
//!
//! | section | contents |
//! |---|---|
//! | `DTLY` | [`TransferLayout`], bincode 2 standard configuration |
//! | `DTCL` | by point of all levels, the cluster of its vector, or [`NO_CLUSTER`] |
//! | `DTWT` | by point with a vector, its weights: a signed byte a component |
//! | `DTBS` | by cluster the mean and the components, signed bytes |
//!
//! A vector has, one after the other,
//! - the [`COUNT`] coefficients of light that comes without a bounce, less those of an open point with the same normal;
//! - by channel, the coefficients of light that bounced;
//! - by group of emissive surfaces, the irradiance by it at unit strength, RGB: without a bounce, then bounced.
//!
//! It is the difference from the mean of the point's parents; a point without a vector has that mean. Vectors are
//! [compressed](super::clustered).

use super::clustered::{ClusterScales, Clustered, NO_CLUSTER, stored};
use super::{RbnError, small};
use crate::harmonics::COUNT;
use bincode::{Decode, Encode};

/// Numbers of a vector without emissive groups: one set of coefficients without a bounce, three of light that bounced.
pub const FROM_SKY: usize = 4 * COUNT;
/// Numbers of a vector for each emissive group.
pub const FROM_GROUP: usize = 6;

/// Sizes and scales.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct TransferLayout {
    /// Number of groups of emissive surfaces.
    pub groups: u32,
    /// Components of clusters, and scales.
    pub scales: ClusterScales,
}

impl TransferLayout {
    /// Numbers of a vector.
    pub fn dimensions(&self) -> usize {
        FROM_SKY + FROM_GROUP * self.groups as usize
    }
}

/// Diffuse transfer of a file; empty where light comes by links.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DiffuseTransfer {
    /// Sizes and scales.
    pub layout: TransferLayout,
    /// By point, its cluster.
    pub clusters: Vec<u8>,
    /// By point with a vector, its weights.
    pub weights: Vec<u8>,
    /// By cluster, its vectors.
    pub vectors: Vec<u8>,
}

impl DiffuseTransfer {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.clusters.is_empty()
    }

    /// Number of points with a vector of their own.
    pub fn stored(&self) -> usize {
        stored(&self.clusters)
    }

    /// The compressed vectors.
    pub(crate) fn packed(&self) -> Clustered<'_> {
        Clustered { scales: &self.layout.scales, weights: &self.weights, vectors: &self.vectors }
    }
}

/// Encodes section `DTLY`.
///
/// # Errors
/// [`RbnError::TooLarge`] past [`MAX_BYTES`](super::limits::MAX_BYTES).
pub fn encode(layout: &TransferLayout) -> Result<Vec<u8>, RbnError> {
    small::encode(layout, || "diffuse transfer has too many clusters".to_owned())
}

/// Decodes section `DTLY`; the caller checks it.
///
/// # Errors
/// [`RbnError::Invalid`].
pub fn decode(bytes: &[u8]) -> Result<TransferLayout, RbnError> {
    small::decode("DTLY", bytes)
}

/// Checks diffuse transfer of unknown origin, for a file with so many points, emissive groups, and links of all kinds.
///
/// # Errors
/// [`RbnError::Invalid`].
pub(crate) fn check(transfer: &DiffuseTransfer, [points, groups, links]: [usize; 3]) -> Result<(), RbnError> {
    if *transfer == DiffuseTransfer::default() {
        return Ok(());
    }
    if transfer.layout.groups as usize != groups {
        return Err(RbnError::invalid("DTLY", "it does not fit the groups of emissive surfaces"));
    }
    if links > 0 {
        return Err(RbnError::invalid("DTLY", "a file with diffuse transfer has no links"));
    }
    if transfer.clusters.len() != points || points == 0 {
        return Err(RbnError::invalid("DTCL", "it does not fit the points"));
    }
    let sections = ["DTLY", "DTCL", "DTWT", "DTBS"];
    transfer.packed().check(transfer.layout.dimensions(), &transfer.clusters, sections)
}

/// Whether a point has a vector of its own.
#[inline]
pub(crate) fn has_own(cluster: u8) -> bool {
    cluster != NO_CLUSTER
}
