//! Light from infinitely far, as the reference samples it.

use glam::{Vec2, Vec3};
use rebounce_shared::elementary::Elementary;
use std::f32::consts::FRAC_1_PI;

/// Light from infinitely far, by direction.
pub trait Environment: Send + Sync {
    /// Returns the linear RGB radiance that arrives against a unit `direction`: of a ray that leaves the scene in it.
    fn radiance(&self, direction: Vec3) -> Vec3;

    /// Samples a direction with a random `square`, 0 to 1 each; also returns its [`Self::density`], above 0.
    fn sample(&self, square: Vec2) -> (Vec3, f32);

    /// Returns the density of samples at a unit direction, per steradian.
    fn density(&self, direction: Vec3) -> f32;
}

/// Environment of one radiance, linear RGB.
#[derive(Clone, Copy, Debug)]
pub struct UniformEnvironment(pub Vec3);

impl Environment for UniformEnvironment {
    fn radiance(&self, _direction: Vec3) -> Vec3 {
        self.0
    }

    fn sample(&self, square: Vec2) -> (Vec3, f32) {
        let z = 1.0 - 2.0 * square.x;
        let (sin, cos) = (std::f32::consts::TAU * square.y).sine_cosine();
        let across = (1.0 - z * z).max(0.0).sqrt();
        (Vec3::new(across * cos, across * sin, z), self.density(Vec3::Z))
    }

    fn density(&self, _direction: Vec3) -> f32 {
        0.25 * FRAC_1_PI
    }
}
