//! Camera moves by pointers and wheel: orbit, look, pan, dolly. All functions are pure.

use glam::{DQuat, DVec3};
use rebounce_shared::camera::Camera;

/// Smallest angle between the view and straight up or down, radians.
const POLE: f64 = 0.02;

/// The camera's axes and its distance from its target: right, up, forward, distance.
fn axes(camera: &Camera) -> (DVec3, DVec3, DVec3, f64) {
    let to_target = DVec3::from(camera.target) - DVec3::from(camera.position);
    let distance = to_target.length().max(1e-12);
    let forward = to_target / distance;
    let mut right = forward.cross(DVec3::from(camera.up));
    if right.length_squared() < 1e-12 {
        right = forward.cross(if forward.y.abs() < 0.9 { DVec3::Y } else { DVec3::X });
    }
    let right = right.normalize();
    (right, right.cross(forward), forward, distance)
}

/// World units per pixel in the plane of the target, for a picture `height` pixels high.
pub fn pixel_at_target(camera: &Camera, tan_half_yfov: f32, height: f64) -> f64 {
    let (.., distance) = axes(camera);
    2.0 * distance * f64::from(tan_half_yfov) / height.max(1.0)
}

/// The forward direction turned by `yaw` around the up axis and `pitch` around the right axis,
/// radians, kept off the poles.
fn turned(camera: &Camera, yaw: f64, pitch: f64) -> DVec3 {
    let (right, _, forward, _) = axes(camera);
    let up = DVec3::from(camera.up).try_normalize().unwrap_or(DVec3::Y);
    let elevation = forward.dot(up).clamp(-1.0, 1.0).asin();
    let limit = std::f64::consts::FRAC_PI_2 - POLE;
    let pitch = (elevation + pitch).min(limit.max(elevation)).max(-limit.max(-elevation)) - elevation;
    (DQuat::from_axis_angle(up, yaw) * DQuat::from_axis_angle(right, pitch) * forward).normalize()
}

/// Turns the camera around its target, radians.
pub fn orbit(camera: &mut Camera, yaw: f64, pitch: f64) {
    let (.., distance) = axes(camera);
    let forward = turned(camera, yaw, pitch);
    camera.position = (DVec3::from(camera.target) - forward * distance).to_array();
}

/// Turns the camera around itself, radians.
pub fn look(camera: &mut Camera, yaw: f64, pitch: f64) {
    let (.., distance) = axes(camera);
    let forward = turned(camera, yaw, pitch);
    camera.target = (DVec3::from(camera.position) + forward * distance).to_array();
}

/// Moves camera and target to the right, up and ahead, world units; `level`: over the ground, along the view from
/// above.
pub fn travel(camera: &mut Camera, [right, up, ahead]: [f64; 3], level: bool) {
    let (mut r, mut u, mut f, _) = axes(camera);
    if level {
        f = DVec3::Y.cross(r).try_normalize().unwrap_or(f);
        (r, u) = (f.cross(DVec3::Y), DVec3::Y);
    }
    let move_by = r * right + u * up + f * ahead;
    camera.position = (DVec3::from(camera.position) + move_by).to_array();
    camera.target = (DVec3::from(camera.target) + move_by).to_array();
}

/// Moves to `factor` times the distance from the target; at distances below `least`, the target moves along.
pub fn dolly(camera: &mut Camera, factor: f64, least: f64) {
    let (_, _, forward, distance) = axes(camera);
    let wanted = distance * factor;
    let position = DVec3::from(camera.target) - forward * wanted;
    camera.position = position.to_array();
    if wanted < least {
        camera.target = (position + forward * least).to_array();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera { position: [3.0, 2.0, 5.0], target: [0.0, 1.0, 0.0], up: [0.0, 1.0, 0.0], yfov_deg: 60.0 }
    }

    fn distance(c: &Camera) -> f64 {
        DVec3::from(c.position).distance(DVec3::from(c.target))
    }

    #[test]
    fn orbit_keeps_target_and_distance() {
        let mut c = camera();
        for _ in 0..100 {
            orbit(&mut c, 0.3, -0.2);
        }
        assert_eq!(c.target, camera().target);
        assert!((distance(&c) - distance(&camera())).abs() < 1e-9);
    }

    #[test]
    fn a_full_turn_comes_back() {
        let mut c = camera();
        for _ in 0..8 {
            orbit(&mut c, std::f64::consts::TAU / 8.0, 0.0);
        }
        assert!(DVec3::from(c.position).distance(DVec3::from(camera().position)) < 1e-9);
        for _ in 0..8 {
            look(&mut c, std::f64::consts::TAU / 8.0, 0.0);
        }
        assert!(DVec3::from(c.target).distance(DVec3::from(camera().target)) < 1e-9);
    }

    #[test]
    fn the_poles_are_never_reached() {
        for pitch in [10.0, -10.0] {
            let mut c = camera();
            orbit(&mut c, 0.0, pitch);
            let (.., forward, _) = axes(&c);
            assert!(forward.y.abs() < 1.0 - 1e-5 && forward.y.abs() > 0.99);
            assert!(forward.y * pitch > 0.0);
        }
    }

    #[test]
    fn dolly_never_passes_its_target() {
        let mut c = camera();
        let before = DVec3::from(c.position);
        for _ in 0..200 {
            dolly(&mut c, 0.8, 0.1);
            assert!(distance(&c) > 0.07);
        }
        assert!(DVec3::from(c.position).distance(before) > 6.0, "the camera can go on through its target");
        let mut d = camera();
        dolly(&mut d, 2.0, 0.1);
        assert!((distance(&d) - 2.0 * distance(&camera())).abs() < 1e-9);
    }

    #[test]
    fn travel_moves_along_the_view() {
        let mut c = camera();
        let (right, _, forward, _) = axes(&c);
        travel(&mut c, [1.0, 0.0, 2.0], false);
        let moved = DVec3::from(c.position) - DVec3::from(camera().position);
        assert!(moved.distance(right + forward * 2.0) < 1e-12);
        assert!((distance(&c) - distance(&camera())).abs() < 1e-12);
    }
}
