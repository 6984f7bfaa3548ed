//! A closed box as a second implementation of `Surfaces`: for tests of code against the trait only.

use glam::Vec3;
use rebounce::geometry::{Gloss, Hit, Ray, Surfaces};

/// The inside of an axis-aligned box from `low` to `high`, with one albedo.
pub struct BoxRoom {
    /// Least corner.
    pub low: Vec3,
    /// Greatest corner.
    pub high: Vec3,
    /// Linear RGB.
    pub albedo: Vec3,
}

impl Surfaces for BoxRoom {
    fn cast(&self, ray: &Ray, _seed: u32) -> Option<Hit> {
        let inverse = ray.direction.recip();
        let far = ((self.low - ray.origin) * inverse).max((self.high - ray.origin) * inverse);
        let (axis, distance) =
            (0..3).map(|a| (a, far[a])).filter(|e| e.1 > 0.0).min_by(|a, b| a.1.total_cmp(&b.1))?;
        if distance >= ray.max_distance {
            return None;
        }
        let mut normal = Vec3::ZERO;
        normal[axis] = -ray.direction[axis].signum();
        let mut position = ray.origin + ray.direction * distance;
        position[axis] = if normal[axis] > 0.0 { self.low[axis] } else { self.high[axis] };
        Some(Hit {
            distance,
            position,
            geometric_normal: normal,
            normal,
            albedo: self.albedo,
            emission: Vec3::ZERO,
            emitter: None,
            is_unlit: false,
            group: 0,
            lightmap: None,
            gloss: Gloss::MATT,
        })
    }

    fn see(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        // The inside has only front faces.
        self.cast(ray, seed)
    }

    fn transmittance(&self, from: Vec3, to: Vec3) -> Vec3 {
        // A box is convex: a point outside is behind a wall.
        let holds = |p: Vec3| p.cmpge(self.low).all() && p.cmple(self.high).all();
        if holds(from) && holds(to) { Vec3::ONE } else { Vec3::ZERO }
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        (self.low, self.high)
    }

    fn epsilon(&self) -> f32 {
        1e-5 * (self.high - self.low).length()
    }
}
