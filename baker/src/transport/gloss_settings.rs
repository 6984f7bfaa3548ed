//! Settings and figures of glossy transfer.

/// Settings of glossy transfer.
#[derive(Clone, Debug, PartialEq)]
pub struct GlossSettings {
    /// Roughness from which metals are left Lambertian.
    pub metals: f32,
    /// Roughness from which what is not metal is left without reflections.
    pub dielectrics: f32,
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
}

impl Default for GlossSettings {
    fn default() -> Self {
        Self {
            metals: 0.9,
            dielectrics: 0.35,
            directions: 2048,
            epsilon: 0.5,
            most: 24_000,
            components: 24,
            has_direct: false,
        }
    }
}

/// Figures of glossy transfer.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct GlossReport {
    /// Points of glossy surfaces, with those that they interpolate.
    pub points: u64,
    /// Matrices computed.
    pub matrices: u64,
    /// Rays cast.
    pub rays: u64,
    /// Root mean square of what compression changes in the matrices, relative to their own.
    pub compression_error: f64,
}
