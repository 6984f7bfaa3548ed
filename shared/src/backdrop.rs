//! Backdrop of an object: an even studio grey, lighter below, with the object's shadow on the ground. The viewer's
//! backdrop.wgsl does the same. Linear display values, independent of light and exposure.

use crate::rbn::shown::{Ground, SIDE};
use glam::{Vec2, Vec3};

/// Grey below and above the horizon.
pub const BELOW: f32 = 0.42;
/// Grey far above the horizon.
pub const ABOVE: f32 = 0.16;
/// Range of the sine of elevation for the transition from [`BELOW`] to [`ABOVE`].
pub const TURN: [f32; 2] = [-0.5, 0.5];
/// Darkening of a place on the ground with a fully occluded sky.
pub const DARK: f32 = 0.75;

/// Returns the grey seen from `eye` along a direction of any length, local space.
pub fn tone(ground: &Ground, eye: Vec3, way: Vec3) -> f32 {
    let rise = ((way.normalize().y - TURN[0]) / (TURN[1] - TURN[0])).clamp(0.0, 1.0);
    let grey = BELOW + (ABOVE - BELOW) * rise * rise * (3.0 - 2.0 * rise);
    let distance = (ground.height - eye.y) / way.y;
    // The ground is visible only from above.
    if way.y >= 0.0 || distance <= 0.0 {
        return grey;
    }
    let place = eye + distance * way;
    grey * (1.0 - DARK * shade(ground, Vec2::new(place.x, place.z)))
}

/// Returns the occluded share of the sky at x, z, interpolated bilinearly between the centres of the squares.
fn shade(ground: &Ground, place: Vec2) -> f32 {
    let (low, high) = (Vec2::from(ground.low), Vec2::from(ground.high));
    let at = (place - low) / (high - low) * SIDE as f32 - 0.5;
    let first = at.floor();
    let share = at - first;
    let square = |dx: f32, dz: f32| {
        let (x, z) = (first.x + dx, first.y + dz);
        let inside = |i: f32| (0.0..SIDE as f32).contains(&i);
        let number = z as usize * SIDE + x as usize;
        if inside(x) && inside(z) { f32::from(ground.shade[number]) / 255.0 } else { 0.0 }
    };
    let row = |dz: f32| square(0.0, dz) * (1.0 - share.x) + square(1.0, dz) * share.x;
    row(0.0) * (1.0 - share.y) + row(1.0) * share.y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shadow_lies_on_the_ground_under_what_casts_it_and_nowhere_else() {
        let mut shade = vec![0; SIDE * SIDE];
        shade[16 * SIDE + 8] = 255;
        let ground = Ground { height: -1.0, low: [-16.0, 0.0], high: [16.0, 32.0], shade };
        let eye = Vec3::new(3.0, 9.0, -20.0);
        let seen = |x: f32, z: f32| tone(&ground, eye, 0.1 * (Vec3::new(x, -1.0, z) - eye));
        let without = |x: f32, z: f32| {
            let none = Ground { shade: vec![0; SIDE * SIDE], ..ground.clone() };
            tone(&none, eye, Vec3::new(x, -1.0, z) - eye)
        };
        let share = |x: f32, z: f32| 1.0 - seen(x, z) / without(x, z);
        // The square's centre, half way to the neighbours, and outside.
        assert!((share(-7.5, 16.5) - DARK).abs() < 1e-4, "{}", share(-7.5, 16.5));
        assert!((share(-7.0, 16.5) - 0.5 * DARK).abs() < 1e-4);
        assert!((share(-7.5, 17.0) - 0.5 * DARK).abs() < 1e-4);
        for (x, z) in [(-9.0, 16.5), (-7.5, 18.0), (100.0, 16.5), (-7.5, -1e4)] {
            assert!(share(x, z).abs() < 1e-5, "{x} {z}");
        }
        // No shadow above the horizon or from below the ground.
        let sky = tone(&ground, eye, Vec3::new(0.0, 0.9, 0.1));
        assert!((sky - ABOVE).abs() < 1e-6);
        let below = Vec3::new(-7.5, -5.0, 16.5);
        assert!(tone(&ground, below, Vec3::NEG_Y) == BELOW);
    }
}
