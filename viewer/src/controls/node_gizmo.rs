//! Handles of nodes that may move: a disc at the middle of what the node moves, and a knob on a ring around it that turns it.

use super::Stage;
use super::shape::{Shape, radius};
use glam::{DQuat, DVec3, Vec2};
use rebounce_shared::motion::NodeMotion;

/// Radius of the ring, radii of a handle.
const RING: f32 = 3.2;
/// With more nodes than that, only the ring of the node under the pointer is shown.
const MOST_RINGS: usize = 24;
const WHITE: [f32; 4] = [1.0, 1.0, 1.0, 0.9];
const DARK: [f32; 4] = [0.0, 0.0, 0.0, 0.4];

/// A node that may move, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageNode {
    /// Middle of its surfaces, and of those of nodes below it, where they are.
    pub middle: DVec3,
    /// Its origin, where it is.
    pub origin: DVec3,
    /// Its motion from where the file has it.
    pub motion: NodeMotion,
}

impl StageNode {
    /// Shifts the node.
    pub fn shift(&mut self, by: DVec3) {
        self.motion.translation = (DVec3::from(self.motion.translation) + by).to_array();
        self.middle += by;
        self.origin += by;
    }

    /// Turns the node about the upright axis through its middle, radians, counterclockwise seen from above.
    pub fn turn(&mut self, angle: f64) {
        let turn = DQuat::from_rotation_y(angle);
        self.motion.rotation = (turn * DQuat::from_array(self.motion.rotation)).normalize().to_array();
        let there = self.middle + turn * (self.origin - self.middle);
        let by = there - self.origin;
        self.motion.translation = (DVec3::from(self.motion.translation) + by).to_array();
        self.origin = there;
    }

    /// Angle of its turn about the upright axis, radians.
    fn heading(&self) -> f64 {
        let ahead = DQuat::from_array(self.motion.rotation) * DVec3::Z;
        ahead.x.atan2(ahead.z) + self.motion.rotation_y_deg.to_radians()
    }
}

/// A handle of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeHandle {
    /// Index of the node.
    pub node: usize,
    /// The knob that turns it.
    pub turns: bool,
}

/// Returns the middle of a node in the picture, pixels, and its distance along the view. `None` behind the eye.
fn middle(stage: &Stage, node: &StageNode) -> Option<(Vec2, f64)> {
    let frame = stage.frame();
    let from_eye = (node.middle - DVec3::from(stage.camera.position)).as_vec3();
    let ahead = from_eye.dot(frame.forward);
    if ahead <= 1e-6 * from_eye.length() {
        return None;
    }
    let [width, height] = stage.size.map(|side| side as f32);
    let scale = 0.5 * height / (frame.tan_half_yfov * ahead);
    let at = Vec2::new(from_eye.dot(frame.right), -from_eye.dot(frame.up)) * scale;
    Some((0.5 * Vec2::new(width, height) + at, f64::from(ahead)))
}

/// Sense in which a turn counterclockwise from above is seen: 1 for counterclockwise, -1 from below.
pub(super) fn sense(stage: &Stage) -> f32 {
    if stage.frame().forward.y > 0.0 { -1.0 } else { 1.0 }
}

/// Returns a handle's place in the picture, pixels, and the distance of its node along the view. `None` behind the eye.
pub(super) fn projected(stage: &Stage, handle: NodeHandle) -> Option<(Vec2, f64)> {
    let node = stage.nodes.get(handle.node)?;
    let (at, distance) = middle(stage, node)?;
    if !handle.turns {
        return Some((at, distance));
    }
    let angle = sense(stage) * node.heading() as f32;
    Some((at + RING * radius(stage.size) * Vec2::new(angle.cos(), -angle.sin()), distance))
}

fn has_ring(stage: &Stage, node: usize, marked: Option<NodeHandle>) -> bool {
    stage.nodes.len() <= MOST_RINGS || marked.is_some_and(|handle| handle.node == node)
}

fn handles(stage: &Stage, marked: Option<NodeHandle>) -> impl Iterator<Item = NodeHandle> + '_ {
    (0..stage.nodes.len()).flat_map(move |node| {
        let knob = has_ring(stage, node, marked).then_some(NodeHandle { node, turns: true });
        knob.into_iter().chain([NodeHandle { node, turns: false }])
    })
}

/// Shapes of all nodes' handles; `marked` is the one under the pointer.
pub fn shapes(stage: &Stage, marked: Option<NodeHandle>) -> Vec<Shape> {
    let r = radius(stage.size);
    let mut out = Vec::new();
    for handle in handles(stage, marked) {
        let Some((at, _)) = projected(stage, handle) else { continue };
        let lit = if marked == Some(handle) { 1.35 } else { 1.0 };
        let disc = |centre: Vec2, radius: f32, hole: f32, color| Shape {
            centre: centre.to_array(),
            radius,
            hole,
            length: 0.0,
            angle: 0.0,
            color,
        };
        if handle.turns {
            let ring = RING * r;
            let around = projected(stage, NodeHandle { turns: false, ..handle }).map_or(at, |(at, _)| at);
            out.push(disc(around, ring + 0.14 * r, ring - 0.14 * r, DARK));
            out.push(disc(around, ring + 0.07 * r, ring - 0.07 * r, WHITE));
            out.push(disc(at, 0.55 * lit * r, 0.0, DARK));
            out.push(disc(at, 0.42 * lit * r, 0.0, WHITE));
        } else {
            out.push(disc(at, 0.95 * lit * r, 0.0, DARK));
            out.push(disc(at, 0.8 * lit * r, 0.55 * lit * r, WHITE));
            out.push(disc(at, 0.28 * lit * r, 0.0, WHITE));
        }
    }
    out
}

/// Returns the nearest handle within `reach` pixels of a pointer, or nearly under the pointer.
pub fn pick(stage: &Stage, at: [f64; 2], reach: f64, marked: Option<NodeHandle>) -> Option<NodeHandle> {
    let reach = reach.max(1.4 * f64::from(radius(stage.size))) as f32;
    let at = Vec2::new(at[0] as f32, at[1] as f32);
    handles(stage, marked)
        .filter_map(|handle| Some((projected(stage, handle)?.0.distance(at), handle)))
        .filter(|(distance, _)| *distance <= reach)
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, handle)| handle)
}
