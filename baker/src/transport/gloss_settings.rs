//! Settings and figures of glossy transfer.

use crate::sampling::cube_maps::CubeMapSettings;

/// How bounced light comes to glossy surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Transfer {
    /// By links from the scene's surfaces: light of all lamps, of emissive surfaces and of the environment.
    #[default]
    Links,
    /// By matrices from the environment: light of the environment alone.
    Matrices,
}

/// Settings of glossy transfer.
#[derive(Clone, Debug, PartialEq)]
pub struct GlossSettings {
    /// Roughness from which metals are left Lambertian.
    pub metals: f32,
    /// Roughness from which what is not metal is left without reflections.
    pub dielectrics: f32,
    /// How bounced light comes to glossy surfaces.
    pub transfer: Transfer,
    /// Links are those of the finest level with at most so many points.
    pub link_points: usize,
    /// Maximum number of links from points in a row.
    pub row_links: usize,
    /// Rays of a point, over a sphere of directions that is the same for all.
    pub directions: u32,
    /// ε_T: a matrix is refined where it differs from what its parents say by more than this, in the norm ‖·‖₁.
    pub epsilon: f32,
    /// Levels with more points than this get no matrices of their own.
    pub most: usize,
    /// Components of a cluster.
    pub components: u32,
    /// Whether matrices hold the environment's light that did not bounce, as the report has it; otherwise pictures read it
    /// from the environment, where it is seen.
    pub has_direct: bool,
    /// Cube maps beside links; they are made where no node may move.
    pub cube_maps: CubeMapSettings,
}

impl Default for GlossSettings {
    fn default() -> Self {
        Self {
            metals: 0.9,
            dielectrics: 0.35,
            transfer: Transfer::Links,
            link_points: 2000,
            row_links: 128,
            directions: 2048,
            epsilon: 0.5,
            most: 24_000,
            components: 24,
            has_direct: false,
            cube_maps: CubeMapSettings::default(),
        }
    }
}

/// Figures of glossy transfer.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct GlossReport {
    /// Points of glossy surfaces, with those that they interpolate.
    pub points: u64,
    /// Matrices computed, or vectors of visibility.
    pub matrices: u64,
    /// Points with links.
    pub linked_points: u64,
    /// Links of all of them.
    pub links: u64,
    /// Cube maps of the surroundings of metals.
    pub cube_maps: u64,
    /// Texels of all of them.
    pub cube_map_texels: u64,
    /// Rays cast.
    pub rays: u64,
    /// Root mean square of what compression changes in the matrices, relative to their own.
    pub compression_error: f64,
}
