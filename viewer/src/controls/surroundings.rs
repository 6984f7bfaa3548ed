//! Whether a camera is inside or outside: inside, the camera looks around and walks; outside, the camera orbits.

use super::Stage;
use glam::Vec3;

/// Number of horizontal test directions.
const DIRECTIONS: u16 = 12;
/// Minimum number of directions with a hit for a camera from outside, and for a camera from inside (hysteresis).
const INSIDE: [usize; 2] = [8, 6];

/// Whether surfaces surround the camera: rays in at least 8 of 12 horizontal directions, 30° apart, hit a surface.
/// Up and down do not count: a court has no ceiling, and an object stands on a floor. A camera from inside stays
/// inside down to 6 hits, so that the state does not flicker in a door.
pub fn is_inside(stage: &Stage, was_inside: bool) -> bool {
    let eye = stage.local(stage.camera.position);
    let meets = |i: &u16| {
        let (sin, cos) = (f32::from(*i) * std::f32::consts::TAU / f32::from(DIRECTIONS)).sin_cos();
        stage.triangles.cast(eye, Vec3::new(sin, 0.0, cos), f32::INFINITY).is_some()
    };
    (0..DIRECTIONS).filter(meets).count() >= INSIDE[usize::from(was_inside)]
}

#[cfg(test)]
mod tests {
    use super::super::tests::stage;
    use super::*;
    use crate::scene::triangles::tests::two_sided;

    /// Walls of a court from x, z = -2 to 2, without the one at z = 2 unless `closed`; a floor.
    fn court(closed: bool) -> Vec<[Vec3; 3]> {
        let square = |a: Vec3, b: Vec3, c: Vec3| [[a, b, c], [b, b + c - a, c]];
        let corner = |x: f32, z: f32| Vec3::new(x, -1.0, z);
        let wall = |a: Vec3, b: Vec3| square(a, b, a + Vec3::Y * 3.0);
        let [a, b, c, d] = [corner(-2.0, -2.0), corner(2.0, -2.0), corner(2.0, 2.0), corner(-2.0, 2.0)];
        let mut all = [square(a, b, d), wall(a, b), wall(b, c), wall(d, a)].concat();
        if closed {
            all.extend(wall(c, d));
        }
        all
    }

    fn is_inside_at(triangles: &[[Vec3; 3]], position: [f64; 3], was: bool) -> bool {
        let mut s = Stage { triangles: two_sided(triangles).into(), ..stage() };
        s.camera.position = position;
        is_inside(&s, was)
    }

    #[test]
    fn courts_without_a_ceiling_are_inside_and_what_is_before_them_or_above_is_not() {
        assert!(is_inside_at(&court(true), [0.5, 0.0, 1.0], false));
        assert!(is_inside_at(&court(false), [0.5, 0.0, 0.0], false), "a room with an open side");
        assert!(!is_inside_at(&court(false), [0.0, 0.0, 6.0], false), "before the open side");
        assert!(!is_inside_at(&court(true), [0.0, 5.0, 0.0], true), "above");
        assert!(!is_inside_at(&[], [0.0; 3], true), "no scene");
    }

    #[test]
    fn in_a_door_it_stays_as_it_was() {
        let at = [0.0, 0.0, 1.99];
        assert!(is_inside_at(&court(false), at, true) && !is_inside_at(&court(false), at, false));
    }
}
