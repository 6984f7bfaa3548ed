//! Openness of a pixel from the depth buffer, after ground-truth ambient occlusion (Jiménez et al. 2016, Eq. 5 to
//! 10). A few slices through the eye are marched outwards on both sides. Where the horizon rises, the cosine over the
//! newly covered angle is integrated in closed form and weighted by the distance of the occluder. The paper
//! attenuates only the highest horizon with distance, which finds corners too open by 0.15. openness.wgsl does the
//! same; a test compares the two.

use super::open;
use glam::Vec3;

/// Slices of the hemisphere, equal in every pixel: per-pixel rotation is noise, and shimmers.
pub const SLICES: u32 = 3;
/// Number of depth samples on each side of a slice.
pub const STEPS: u32 = 3;

/// Depth of a picture: input of [`horizon`].
pub struct View<'a> {
    /// The eye, local space.
    pub eye: Vec3,
    /// Unit vectors to the right, to the top and into the picture.
    pub axes: [Vec3; 3],
    /// Pixels across a unit of length at distance 1.
    pub pixels_per_unit: f32,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Local position seen at a pixel; `None` for the background.
    pub position: &'a dyn Fn(u32, u32) -> Option<Vec3>,
}

/// Returns the openness of a pixel, from its position, unit normal and a reach in scene units.
pub fn horizon(view: &View<'_>, pixel: [u32; 2], position: Vec3, normal: Vec3, reach: f32) -> f32 {
    let [right, up, forward] = view.axes;
    let to_eye = (view.eye - position).normalize();
    let ahead = (position - view.eye).dot(forward);
    let across = reach * view.pixels_per_unit / ahead;
    let mut sum = 0.0;
    for slice in 0..SLICES {
        let angle = std::f32::consts::PI * slice as f32 / SLICES as f32;
        let (sin, cos) = angle.sin_cos();
        // Rows run down.
        let along = right * cos - up * sin;
        let axis = along.cross(to_eye).normalize();
        let tangent = to_eye.cross(axis);
        let projected = normal - axis * normal.dot(axis);
        let length = projected.length().max(1e-6);
        let tilt = projected.dot(tangent).atan2(projected.dot(to_eye));
        for side in [-1.0f32, 1.0] {
            // Cosine integral from the eye direction to the angle `horizon`: the part of the slice that is still
            // free.
            let part = |horizon: f32| {
                let angle = side * horizon;
                0.25 * (tilt.cos() + 2.0 * angle * tilt.sin() - (2.0 * angle - tilt).cos())
            };
            let mut highest = (tilt + side * std::f32::consts::FRAC_PI_2).cos();
            let mut free = part(highest.acos());
            let mut before = 0.0;
            sum += length * free;
            for step in 1..=STEPS {
                let offset = side * across * step as f32 / STEPS as f32;
                let at = [pixel[0] as f32 + 0.5 + cos * offset, pixel[1] as f32 + 0.5 + sin * offset];
                let [x, y] = at.map(|x| x.floor());
                if x < 0.0 || y < 0.0 || x >= view.size[0] as f32 || y >= view.size[1] as f32 {
                    continue;
                }
                let Some(other) = (view.position)(x as u32, y as u32) else { continue };
                let offset = other - position;
                let distance = offset.length().max(1e-6 * reach);
                let height = offset.dot(to_eye) / distance;
                if height > highest {
                    highest = height;
                    let left = part(height.min(1.0).acos());
                    // The occluder lies between the previous sample and the current sample.
                    sum -= length * (free - left) * (1.0 - open(0.5 * (before + distance) / reach));
                    free = left;
                }
                before = distance;
            }
        }
    }
    (sum / SLICES as f32).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::mix;
    use glam::Vec2;

    const SIZE: [u32; 2] = [160, 120];

    /// A floor at y = 0 and a wall at x = 0 that goes up from it, seen from above.
    struct Corner {
        eye: Vec3,
        axes: [Vec3; 3],
    }

    impl Corner {
        fn new() -> Self {
            let eye = Vec3::new(1.2, 1.5, 1.0);
            let forward = (Vec3::new(0.2, 0.0, -0.2) - eye).normalize();
            let right = forward.cross(Vec3::Y).normalize();
            Self { eye, axes: [right, right.cross(forward), forward] }
        }

        /// Distance to the first surface from a place, along a direction.
        fn distance(from: Vec3, direction: Vec3) -> f32 {
            let [wall, floor] = [0, 1].map(|axis| -from[axis] / direction[axis]);
            let wall = if wall > 1e-4 && from.y + wall * direction.y >= 0.0 { wall } else { f32::INFINITY };
            if floor > 1e-4 && from.x + floor * direction.x >= 0.0 { wall.min(floor) } else { wall }
        }

        fn position(&self, x: u32, y: u32) -> Option<Vec3> {
            let at = (Vec2::new(x as f32, y as f32) + 0.5 - 0.5 * Vec2::new(SIZE[0] as f32, SIZE[1] as f32))
                / 100.0;
            let [right, up, forward] = self.axes;
            let direction = (forward + right * at.x - up * at.y).normalize();
            let distance = Self::distance(self.eye, direction);
            distance.is_finite().then(|| self.eye + direction * distance)
        }
    }

    /// Openness by rays.
    fn by_rays(position: Vec3, normal: Vec3, reach: f32) -> f32 {
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let number = |i: u64| (mix(i) >> 40) as f32 / (1u64 << 24) as f32;
        let rays = (0..4096u64).map(|i| {
            let (radius, angle) = (number(2 * i).sqrt(), number(2 * i + 1) * std::f32::consts::TAU);
            let flat = (tangent * angle.cos() + bitangent * angle.sin()) * radius;
            let direction = flat + normal * (1.0 - radius * radius).sqrt();
            open(Corner::distance(position + normal * 1e-3, direction) / reach)
        });
        rays.sum::<f32>() / 4096.0
    }

    #[test]
    fn horizons_find_about_the_openness_that_rays_find() {
        let corner = Corner::new();
        let position = |x, y| corner.position(x, y);
        let view = View {
            eye: corner.eye,
            axes: corner.axes,
            pixels_per_unit: 100.0,
            size: SIZE,
            position: &position,
        };
        let (mut square, mut sum, mut count, mut least) = (0.0, 0.0, 0, 1f32);
        for y in (10..SIZE[1] - 10).step_by(5) {
            for x in (10..SIZE[0] - 10).step_by(5) {
                // With a reach of only a few pixels the horizons miss more occluders.
                let near = |place: &Vec3| place.distance(corner.eye) < 2.5;
                let Some(place) = corner.position(x, y).filter(near) else { continue };
                let normal = if place.x < place.y { Vec3::X } else { Vec3::Y };
                let found = horizon(&view, [x, y], place, normal, 0.5);
                let expected = by_rays(place, normal, 0.5);
                assert!((found - expected).abs() < 0.2, "{place}: {found}, {expected} by rays");
                sum += found - expected;
                square += (found - expected).powi(2);
                (count, least) = (count + 1, least.min(found));
            }
        }
        let (error, bias) = ((square / count as f32).sqrt(), sum / count as f32);
        println!("{count} places: {error}, bias {bias}, least {least}");
        assert!(count > 300 && error < 0.02 && bias.abs() < 0.01 && least < 0.75);
    }
}
