//! Rays and thresholds of a solution.

/// Settings of [`ProgressiveRadiosity`](super::ProgressiveRadiosity).
#[derive(Clone, Debug, PartialEq)]
pub struct RadiositySettings {
    /// Rays per receiver by level, coarsest first; the last entry applies to all finer levels.
    pub rays: Vec<u32>,
    /// ε_E: variation of a group's irradiance that refines a receiver, as a share of the group's mean bounced irradiance on
    /// the coarsest level.
    pub epsilon_e: f32,
    /// ε_Ω: greatest solid angle of the bounding sphere of a function at which light leaves from it, steradian; light that
    /// meets larger functions is taken from finer ones.
    pub epsilon_omega: f32,
    /// Standard deviations of its noise that a coefficient must stand out of: of one that does not, that much is left out.
    pub significance: f32,
}

impl RadiositySettings {
    /// Rays per receiver of a level.
    pub fn rays_on(&self, level: usize) -> u32 {
        self.rays.get(level).or(self.rays.last()).copied().unwrap_or(256).max(1)
    }
}

impl Default for RadiositySettings {
    fn default() -> Self {
        Self {
            rays: vec![512, 384, 256, 128, 96, 64],
            epsilon_e: 0.25,
            epsilon_omega: 0.02,
            significance: 0.5,
        }
    }
}
