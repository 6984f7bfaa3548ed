//! Collision of the camera: the camera keeps a clearance from surfaces and slides along surfaces. Pure functions.

use super::Stage;
use crate::scene::triangles::Triangles;
use glam::{DVec3, Vec3};
use rebounce_shared::camera::Camera;

/// The kind of a camera's move, and its response to surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// On the ground: slides along walls and keeps the height. The target moves along.
    Walk,
    /// In any direction: slides along surfaces. The target moves along.
    Fly,
    /// Around the fixed target: slides along surfaces.
    Orbit,
    /// Towards the fixed target: stops at surfaces.
    Dolly,
}

/// Moves the camera to `wanted`, or as far as surfaces allow.
pub fn advance(stage: &mut Stage, mut wanted: Camera, motion: Motion) {
    let [from, to] = [stage.camera.position, wanted.position].map(|place| stage.local(place));
    let reached = reach(&stage.triangles, from, to, stage.clearance, motion);
    if reached != to {
        let missed = (reached - to).as_dvec3();
        let moved = |place: [f64; 3]| (DVec3::from(place) + missed).to_array();
        wanted.position = moved(wanted.position);
        if matches!(motion, Motion::Walk | Motion::Fly) {
            wanted.target = moved(wanted.target);
        }
    }
    stage.camera = wanted;
}

/// Returns the end of a move in local space, at least `clearance` from surfaces. A camera that begins closer to a
/// surface may leave the surface, or pass at the same distance.
fn reach(triangles: &Triangles, from: Vec3, to: Vec3, clearance: f32, motion: Motion) -> Vec3 {
    let level = |v: Vec3| if motion == Motion::Walk { v.with_y(0.0) } else { v };
    let room = |place: Vec3| triangles.nearest(place, clearance).map_or(clearance, |p| p.distance(place));
    let before = room(from);
    let is_open = |place: Vec3, share: f32| {
        let way = place - from;
        let length = way.length();
        let blocked = length > 0.0 && triangles.cast(from, way / length, length).is_some();
        !blocked && room(place) >= share * before
    };
    if is_open(to, 0.9999) {
        return to;
    }
    // A camera too close to a surface moves away gradually.
    let radius = clearance.min(1.05 * before);
    let (mut at, mut wanted) = (from, to);
    for _ in 0..3 {
        let length = at.distance(wanted);
        if length <= 1e-3 * radius {
            break;
        }
        let direction = (wanted - at) / length;
        let hit = triangles.cast(at, direction, length + radius);
        let back = |normal: Vec3| radius / normal.dot(direction).abs().max(0.05);
        at += direction * hit.map_or(length, |hit| (hit.distance - back(hit.normal)).min(length).max(0.0));
        for _ in 0..4 {
            let Some(place) = triangles.nearest(at, radius) else { break };
            let away = level(at - place);
            let height = at.distance_squared(place) - away.length_squared();
            let far = (radius * radius - height).max(0.0).sqrt();
            at += away.normalize_or_zero() * (far - away.length());
        }
        let Some(hit) = hit.filter(|_| motion != Motion::Dolly) else { break };
        wanted = at + level(wanted - at).reject_from(level(hit.normal).normalize_or(Vec3::Y));
    }
    // A camera pressed against a wall stops.
    if at.distance(from) > 1e-3 * radius && is_open(at, 0.99) { at } else { from }
}

#[cfg(test)]
mod tests {
    use super::super::tests::stage;
    use super::*;
    use crate::scene::triangles::tests::two_sided;

    /// A wall at this z, 3 high, between two x.
    fn wall(x: [f32; 2], z: f32) -> [[Vec3; 3]; 2] {
        let [a, b] = x.map(|x| Vec3::new(x, -1.0, z));
        let [c, d] = [a, b].map(|p| p + Vec3::Y * 3.0);
        [[a, b, c], [b, d, c]]
    }

    /// A wall with a door, 0.9 wide.
    fn doored() -> Stage {
        let walls = [wall([-5.0, -0.45], 0.0), wall([0.45, 5.0], 0.0)].concat();
        Stage { triangles: two_sided(&walls).into(), ..stage() }
    }

    /// The camera's position after `steps` moves of `by`, local space.
    fn go(stage: &mut Stage, from: [f64; 3], by: [f64; 3], steps: usize, motion: Motion) -> Vec3 {
        let add = |a: [f64; 3], b: [f64; 3]| (DVec3::from(a) + DVec3::from(b)).to_array();
        stage.camera.position = from;
        stage.camera.target = add(from, by);
        for _ in 0..steps {
            let mut wanted = stage.camera.clone();
            wanted.position = add(wanted.position, by);
            wanted.target = add(wanted.target, by);
            advance(stage, wanted, motion);
        }
        stage.local(stage.camera.position)
    }

    #[test]
    fn a_wall_stops_and_one_slides_along_it() {
        for motion in [Motion::Walk, Motion::Fly, Motion::Dolly] {
            for (steps, by) in [(400, -0.03), (2, -30.0)] {
                let at = go(&mut doored(), [2.0, 0.0, 5.0], [0.0, 0.0, by], steps, motion);
                let clearance = doored().clearance;
                assert!((at.z - clearance).abs() < 0.02 * clearance, "{motion:?} {by}: {at}");
                assert!((at.x - 2.0).abs() < 1e-3);
            }
        }
        let at = go(&mut doored(), [2.0, 0.0, 1.0], [0.03, 0.0, -0.03], 90, Motion::Walk);
        assert!(at.x > 4.4 && (at.z - 0.2).abs() < 0.01, "{at}");
    }

    #[test]
    fn doors_are_passed_from_beside_their_middle_too() {
        for x in [-0.3, 0.0, 0.2, 0.4] {
            let at = go(&mut doored(), [x, 0.0, 2.0], [0.0, 0.0, -0.05], 100, Motion::Walk);
            assert!(at.z < -2.0, "from {x}: {at}");
        }
    }

    #[test]
    fn walking_keeps_the_height_and_what_is_lower_does_not_stop() {
        // A table's edge just below the eye, and a wall behind.
        let table =
            [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 0.0, -1.0]].map(|p| Vec3::from(p) - Vec3::Y * 0.15);
        let solid = two_sided(&[&[table][..], &wall([-5.0, 5.0], -3.0)].concat());
        let mut s = Stage { triangles: solid.into(), ..stage() };
        let at = go(&mut s, [0.0, 0.0, 4.0], [0.01, 0.0, -0.05], 200, Motion::Walk);
        assert_eq!(at.y, 0.0);
        let mut high = Stage { triangles: two_sided(&[table.map(|p| p - Vec3::Y * 0.1)]).into(), ..stage() };
        assert!(go(&mut high, [0.0, 0.0, 4.0], [0.0, 0.0, -0.05], 200, Motion::Walk).z < -5.9);
    }

    #[test]
    fn who_begins_too_near_can_leave_and_gets_no_nearer() {
        for (by, least, most) in
            [([0.0, 0.0, 0.05], 1.0, 9.0), ([0.0, 0.0, -0.05], 0.029, 0.2), ([0.05, 0.0, 0.0], 0.029, 0.2)]
        {
            let at = go(&mut doored(), [2.0, 0.0, 0.03], by, 50, Motion::Walk);
            assert!(at.z >= least && at.z <= most, "{at}");
        }
        assert!(go(&mut doored(), [2.0, 0.0, 0.03], [0.05, 0.0, 0.0], 50, Motion::Fly).x > 4.0);
    }

    #[test]
    fn a_corner_holds_and_lets_go() {
        let side = wall([-5.0, 5.0], 0.0).map(|t| t.map(|p| Vec3::new(p.z, p.y, p.x)));
        let corner = two_sided(&[wall([-5.0, 5.0], 0.0), side].concat());
        let mut s = Stage { triangles: corner.into(), ..stage() };
        let at = go(&mut s, [3.0, 0.0, 2.0], [-0.05, 0.0, -0.04], 400, Motion::Walk);
        assert!(at.distance(Vec3::new(0.2, 0.0, 0.2)) < 0.01, "{at}");
        let back = go(&mut s, at.as_dvec3().to_array(), [0.05, 0.0, 0.05], 20, Motion::Walk);
        assert!(back.x > 1.0 && back.z > 1.0, "{back}");
    }
}
