//! Dragging of nodes' handles: the disc moves a node over the floor, with Shift up and down; the knob turns it.

use super::Stage;
use super::node_gizmo::{self, NodeHandle, StageNode};
use glam::{DVec3, Vec2};
use std::f64::consts::TAU;

/// Farthest that a node is dragged, diagonals of the scene from the eye.
const FARTHEST: f64 = 2.0;

/// A grabbed handle of a node.
#[derive(Clone, Debug)]
pub struct NodeGrip {
    /// The handle.
    pub handle: NodeHandle,
    /// The node before the drag.
    pub before: StageNode,
}

impl NodeGrip {
    /// Grabs a handle.
    pub fn new(stage: &Stage, handle: NodeHandle) -> Option<Self> {
        stage.nodes.get(handle.node).map(|node| Self { handle, before: *node })
    }

    /// Moves the pointer, pixels. `upright`: the node is shifted up and down.
    pub fn drag(&self, stage: &mut Stage, [from, to]: [[f64; 2]; 2], upright: bool) {
        let NodeHandle { node, turns } = self.handle;
        let by = match turns {
            true => None,
            false => shift(stage, node, [from, to], upright),
        };
        let angle = if turns { angle(stage, node, [from, to]) } else { 0.0 };
        let Some(node) = stage.nodes.get_mut(node) else { return };
        node.shift(by.unwrap_or_default());
        if angle != 0.0 {
            node.turn(angle);
        }
    }
}

/// Returns how far a node is shifted so that its middle follows the pointer in the horizontal plane through it, or upright.
/// `None` where the pointer leaves the plane.
fn shift(stage: &Stage, node: usize, ends: [[f64; 2]; 2], upright: bool) -> Option<DVec3> {
    let place = stage.nodes.get(node)?.middle;
    let (at, distance) = node_gizmo::projected(stage, NodeHandle { node, turns: false })?;
    let frame = stage.frame();
    let [width, height] = stage.size;
    let eye = DVec3::from(stage.camera.position);
    let ray = |at: Vec2| frame.direction(at.x, at.y, width, height).as_dvec3();
    let moved = Vec2::new((ends[1][0] - ends[0][0]) as f32, (ends[1][1] - ends[0][1]) as f32);
    let (from, to) = (ray(at), ray(at + moved));
    if upright {
        let forward = frame.forward.as_dvec3();
        let on_plane = |ray: DVec3| ray * (distance / ray.dot(forward).max(1e-6));
        return Some(DVec3::Y * (on_plane(to) - on_plane(from)).y);
    }
    let along = (place.y - eye.y) / to.y;
    let is_near = along > 0.0 && along < FARTHEST * stage.extent;
    is_near.then(|| eye + to * along - place).map(|by| DVec3::new(by.x, 0.0, by.z))
}

/// Returns the angle by which the pointer goes around a node's middle, counterclockwise seen from above.
fn angle(stage: &Stage, node: usize, ends: [[f64; 2]; 2]) -> f64 {
    let Some((at, _)) = node_gizmo::projected(stage, NodeHandle { node, turns: false }) else { return 0.0 };
    let [from, to] = ends.map(|end| (f64::from(at.y) - end[1]).atan2(end[0] - f64::from(at.x)));
    let turn = (to - from + 1.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
    turn * f64::from(node_gizmo::sense(stage))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::controls::tests::stage;
    use glam::DQuat;
    use rebounce_shared::camera::Camera;
    use rebounce_shared::motion::NodeMotion;

    /// A node whose origin is beside its middle, seen from above.
    fn looking_down() -> Stage {
        let node = StageNode { middle: DVec3::ZERO, origin: DVec3::X, motion: NodeMotion::default() };
        let camera = Camera { position: [0.0, 4.0, 4.0], ..stage().camera };
        Stage { nodes: vec![node], camera, ..stage() }
    }

    fn at(stage: &Stage, turns: bool) -> Vec2 {
        node_gizmo::projected(stage, NodeHandle { node: 0, turns }).unwrap().0
    }

    fn drag(stage: &mut Stage, turns: bool, steps: &[[f64; 2]], upright: bool) -> NodeGrip {
        let start = at(stage, turns).as_dvec2().to_array();
        let grip = NodeGrip::new(stage, NodeHandle { node: 0, turns }).unwrap();
        let mut from = start;
        for step in steps {
            let to = [start[0] + step[0], start[1] + step[1]];
            grip.drag(stage, [from, to], upright);
            from = to;
        }
        grip
    }

    #[test]
    fn a_dragged_node_stays_under_the_pointer_and_on_its_floor() {
        let mut s = looking_down();
        let start = at(&s, false);
        drag(&mut s, false, &[[10.0, 20.0], [60.0, -50.0], [80.0, 40.0]], false);
        assert!((at(&s, false) - start - Vec2::new(80.0, 40.0)).length() < 0.1);
        let node = s.nodes[0];
        assert_eq!(node.middle.y, 0.0);
        assert!(node.middle.x > 0.3 && node.middle.z > 0.2);
        assert!((DVec3::from(node.motion.translation) - node.middle).length() < 1e-9);
    }

    #[test]
    fn upright_it_rises() {
        let mut s = looking_down();
        drag(&mut s, false, &[[0.0, -30.0]], true);
        let DVec3 { x, y, z } = s.nodes[0].middle;
        assert!(x == 0.0 && z == 0.0 && y > 0.1, "{y}");
    }

    #[test]
    fn above_the_horizon_it_stays_where_it_was() {
        let mut s = looking_down();
        s.camera.position = [0.0, 0.2, 4.0];
        s.camera.target = [0.0, 0.0, 0.0];
        drag(&mut s, false, &[[0.0, -200.0]], false);
        assert_eq!(s.nodes[0].middle, DVec3::ZERO);
    }

    #[test]
    fn the_knob_turns_a_node_about_its_middle_and_follows_the_pointer() {
        for (height, sign) in [(4.0, 1.0), (-4.0, -1.0)] {
            let mut s = looking_down();
            s.camera.position[1] = height;
            let (middle, knob) = (at(&s, false), at(&s, true));
            let away = (knob - middle).as_dvec2();
            // A quarter counterclockwise in the picture, in steps.
            let steps: Vec<[f64; 2]> = (1..=9)
                .map(|k| {
                    let (sin, cos) = (f64::from(k) * 10f64.to_radians()).sin_cos();
                    let turned = glam::DVec2::new(cos * away.x + sin * away.y, cos * away.y - sin * away.x);
                    (turned - away).to_array()
                })
                .collect();
            drag(&mut s, true, &steps, false);
            let node = s.nodes[0];
            let expected = DQuat::from_rotation_y(sign * 90f64.to_radians());
            let turn = DQuat::from_array(node.motion.rotation);
            assert!(turn.dot(expected).abs() > 1.0 - 1e-9, "{turn}");
            assert!((node.origin - expected * DVec3::X).length() < 1e-9 && node.middle == DVec3::ZERO);
            assert!((DVec3::from(node.motion.translation) - (node.origin - DVec3::X)).length() < 1e-9);
            assert!((at(&s, true) - middle - Vec2::new(0.0, -away.length() as f32)).length() < 0.5);
        }
    }
}
