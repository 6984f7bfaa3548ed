//! Glossy transfer: what arrives at points of glossy surfaces from each direction. Optional sections;
//! readers without support show metals as they show other surfaces.
//!
//! | section | contents |
//! |---|---|
//! | `GLSY` | [`GlossLayout`], bincode 2 standard configuration |
//! | `GLPT` | indices of the points, ascending |
//! | `GLCL` | by point, the cluster of its matrix, or [`NO_MATRIX`] |
//! | `GLWT` | by point with a matrix, its weights: a signed byte a component |
//! | `GLBS` | by cluster the mean and the components, signed bytes |
//! | `GLLK` | [links](super::gloss_links), in files with links |
//! | `GLLO` | offsets of the rows of links, and their end: a row for each of the first points |
//!
//! A matrix takes the [coefficients](crate::harmonics) of distant radiance to those of the radiance that arrives at a point,
//! as the difference from what the point's parents say (Lehtinen et al. 2007, 6.4). A point without a matrix has what its
//! parents say. Matrices are compressed by clustered principal component analysis (Sloan, Hall, Hart and Snyder, *Clustered
//! Principal Components for Precomputed Radiance Transfer*, 2003): the mean of a cluster plus weighted components. An entry
//! is its byte times the scale of its vector.
//!
//! A vector has, by channel, the matrix's rows one after the other, and then the coefficients of visibility: 1 where the
//! distant environment is seen.
//!
//! Where there are links, all light that bounced or comes from emissive surfaces arrives by them, and vectors have visibility
//! alone. A point with links has what they say; one without has the mean of its parents.

use super::clustered::{ClusterScales, Clustered, stored};
use super::gloss_links::{self, GlossLinks};
use super::limits::sane;
use super::{RbnError, small};
use crate::harmonics::COUNT;
use bincode::{Decode, Encode};

pub use super::clustered::{MAX_COMPONENTS, NO_CLUSTER as NO_MATRIX};

/// Sizes and scales.
#[derive(Clone, Debug, Default, PartialEq, Encode, Decode)]
pub struct GlossLayout {
    /// Whether matrices hold light that comes from the environment without a bounce, besides what bounced.
    pub has_direct: bool,
    /// Roughness from which metals, and what is not metal, have no reflections.
    pub roughness: [f32; 2],
    /// Matrices of a point: 1 for all channels, or 3, for red, green and blue; 0 for visibility alone.
    pub channels: u32,
    /// Components of clusters, and scales.
    pub scales: ClusterScales,
    /// By group of emissive surfaces, its mean radiance, linear RGB; empty without links.
    pub emission: Vec<[f32; 3]>,
}

impl GlossLayout {
    /// Entries of a vector.
    pub fn dimensions(&self) -> usize {
        self.channels as usize * COUNT * COUNT + COUNT
    }
}

/// Glossy transfer of a file; empty if it has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gloss {
    /// Sizes and scales.
    pub layout: GlossLayout,
    /// Indices of the points, ascending.
    pub points: Vec<u32>,
    /// By point, its cluster.
    pub clusters: Vec<u8>,
    /// By point with a matrix, its weights.
    pub weights: Vec<u8>,
    /// By cluster, its vectors.
    pub vectors: Vec<u8>,
    /// Links of the first points; no rows without.
    pub links: GlossLinks,
}

impl Gloss {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Number of matrices.
    pub fn matrices(&self) -> usize {
        stored(&self.clusters)
    }

    /// The compressed matrices.
    pub(crate) fn packed(&self) -> Clustered<'_> {
        Clustered { scales: &self.layout.scales, weights: &self.weights, vectors: &self.vectors }
    }
}

/// Encodes section `GLSY`.
///
/// # Errors
/// [`RbnError::TooLarge`] past [`MAX_BYTES`](super::limits::MAX_BYTES).
pub fn encode(layout: &GlossLayout) -> Result<Vec<u8>, RbnError> {
    small::encode(layout, || "glossy transfer has too many clusters".to_owned())
}

/// Decodes section `GLSY`; the caller checks it.
///
/// # Errors
/// [`RbnError::Invalid`].
pub fn decode(bytes: &[u8]) -> Result<GlossLayout, RbnError> {
    small::decode("GLSY", bytes)
}

/// Checks glossy transfer of unknown origin, for a file with so many points, senders and emissive groups.
///
/// # Errors
/// [`RbnError::Invalid`].
pub(crate) fn check(gloss: &Gloss, [points, senders, groups]: [usize; 3]) -> Result<(), RbnError> {
    if *gloss == Gloss::default() {
        return Ok(());
    }
    let layout = &gloss.layout;
    if !matches!(layout.channels, 0 | 1 | 3) || !layout.roughness.iter().all(|x| sane(*x)) {
        return Err(RbnError::invalid("GLSY", "channels or roughness"));
    }
    let sections = ["GLSY", "GLCL", "GLWT", "GLBS"];
    gloss.packed().check(layout.dimensions(), &gloss.clusters, sections)?;
    let ascending = gloss.points.windows(2).all(|pair| pair[0] < pair[1]);
    if !ascending || gloss.points.last().is_none_or(|last| *last as usize >= points) {
        return Err(RbnError::invalid("GLPT", "a point is out of order or out of range"));
    }
    if gloss.clusters.len() != gloss.points.len() {
        return Err(RbnError::invalid("GLCL", "it does not fit the points"));
    }
    gloss_links::check(&gloss.links, &layout.emission, gloss.points.len(), [points, senders, groups])
}
