//! Controls: effects of pointers, wheel and keys on the camera and the lights. No GPU, no browser.
//!
//! A single pointer on a light's handle drags and selects the light ([`drag`]), on a node's handle moves or turns the node.
//! Elsewhere the primary button looks
//! around inside and orbits outside ([`surroundings`]), the secondary button (or ctrl) looks around, the middle
//! button (or shift) pans. Wheel and two pointers walk inside, and dolly outside. W A S D, Q E, arrows and the
//! stick walk inside, and fly outside ([`fly`]). Surfaces stop the camera ([`collide`]).

pub mod collide;
pub mod drag;
pub mod fly;
pub mod gizmo;
#[cfg(feature = "radiosity")]
pub mod node_drag;
#[cfg(feature = "radiosity")]
pub mod node_gizmo;
pub mod orbit;
pub mod shape;
pub mod sun;
pub mod surroundings;

use crate::scene::triangles::{Hit, Triangles};
use crate::scene::view::frame;
use collide::Motion;
use drag::Grip;
use fly::Fly;
use gizmo::{Handle, Marks};
use glam::{DVec3, Vec3};
#[cfg(feature = "radiosity")]
use node_drag::NodeGrip;
#[cfg(feature = "radiosity")]
use node_gizmo::{NodeHandle, StageNode};
use rebounce_shared::camera::{Camera, CameraFrame};
use rebounce_shared::light::Light;
use std::rc::Rc;

/// Walking distance for a pixel of the wheel, scene diagonals.
const WHEEL: f64 = 2.5e-4;
/// Walking distance when two pointers move apart to e times their distance, scene diagonals.
const PINCH: f64 = 0.15;

/// Orbit angle of a drag over the picture's height, radians.
const ORBIT: f64 = 3.0;

/// State changed by the controls, world space.
#[derive(Clone)]
pub struct Stage {
    /// The camera.
    pub camera: Camera,
    /// The lights.
    pub lights: Vec<Light>,
    /// Nodes that may move.
    #[cfg(feature = "radiosity")]
    pub nodes: Vec<StageNode>,
    /// Whether handles are shown and can be dragged.
    pub handles: bool,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// The scene's diagonal, scene units.
    pub extent: f64,
    /// Origin of local space.
    pub origin: [f64; 3],
    /// Distance that the camera keeps from surfaces, scene units.
    pub clearance: f32,
    /// The scene's triangles, local space.
    pub triangles: Rc<Triangles>,
}

impl Stage {
    /// The camera's frame in the picture, for directions; its eye is not in local space.
    pub fn frame(&self) -> CameraFrame {
        frame(&self.camera, [0.0; 3], self.size)
    }

    /// The visible place at a pixel, world space.
    pub fn surface_at(&self, at: [f64; 2]) -> Option<[f64; 3]> {
        let [width, height] = self.size;
        let ray = self.frame().direction(at[0] as f32, at[1] as f32, width, height);
        self.seen_along(ray, f32::INFINITY).map(|hit| self.along(ray, hit.distance))
    }

    /// The nearest hit before `most` along a ray of unit direction from the eye.
    fn seen_along(&self, ray: Vec3, most: f32) -> Option<Hit> {
        self.triangles.cast(self.local(self.camera.position), ray, most)
    }

    /// Returns a place on a ray from the eye, world space.
    fn along(&self, ray: Vec3, distance: f32) -> [f64; 3] {
        (DVec3::from(self.camera.position) + (ray * distance).as_dvec3()).to_array()
    }

    /// Converts a place to local space.
    pub fn local(&self, place: [f64; 3]) -> Vec3 {
        (DVec3::from(place) - DVec3::from(self.origin)).as_vec3()
    }
}

/// Action of a pressed pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointerButton {
    /// Looks around inside, orbits outside, or drags the light's handle under the pointer.
    Turn,
    /// Turns the camera around itself.
    Look,
    /// Moves the camera sideways, or drags a light's handle.
    Pan,
}

impl PointerButton {
    /// From a `PointerEvent`'s button (0 left, 1 middle, 2 right) and modifier keys.
    pub fn from_event(button: i32, shift: bool, ctrl: bool) -> Self {
        match button {
            1 => Self::Pan,
            2 => Self::Look,
            _ if shift => Self::Pan,
            _ if ctrl => Self::Look,
            _ => Self::Turn,
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Pointer {
    id: i32,
    at: [f64; 2],
    start: [f64; 2],
    button: PointerButton,
}

/// The state of the controls.
#[derive(Debug, Default)]
pub struct Controls {
    pointers: Vec<Pointer>,
    /// The dragged handle.
    grip: Option<Grip>,
    /// The camera when the first pointer went down.
    before: Option<Camera>,
    /// The pointers have been dragged since, or several pointers were down: no click.
    dragged: bool,
    fly: Fly,
    hovered: Option<Handle>,
    /// The dragged handle of a node, and the one under the pointer.
    #[cfg(feature = "radiosity")]
    node_grip: Option<NodeGrip>,
    #[cfg(feature = "radiosity")]
    hovered_node: Option<NodeHandle>,
    /// The selected light.
    pub selected: Option<usize>,
    /// Whether drags look around; `None` decides by whether the camera is inside.
    pub looks: Option<bool>,
    inside: bool,
    /// Camera position of the decision on `inside`.
    decided_at: Option<[f64; 3]>,
}

impl Controls {
    /// Forgets pointers, keys and whether the camera is inside; call after replacing the camera or the scene.
    pub fn reset(&mut self) {
        self.pointers.clear();
        (self.grip, self.hovered, self.decided_at) = (None, None, None);
        #[cfg(feature = "radiosity")]
        {
            (self.node_grip, self.hovered_node) = (None, None);
        }
        self.fly.release();
    }

    /// The highlighted handles.
    pub fn marks(&self) -> Marks {
        let hovered = self.grip.as_ref().map(|grip| grip.handle).or(self.hovered);
        #[cfg(feature = "radiosity")]
        let node = self.node_grip.as_ref().map(|grip| grip.handle).or(self.hovered_node);
        Marks {
            hovered,
            selected: self.selected,
            #[cfg(feature = "radiosity")]
            node,
        }
    }

    /// Highlights a light's handle as if under a pointer.
    pub fn hover(&mut self, light: Option<usize>) {
        self.hovered = light.map(|light| Handle { light, aim: false });
    }

    /// Whether drags look around and keys walk.
    pub fn is_inside(&self) -> bool {
        self.looks.unwrap_or(self.inside)
    }

    /// Updates `inside` after a move, while no pointer or key holds the camera.
    fn decide(&mut self, stage: &Stage) {
        if self.pointers.is_empty() && !self.fly.moving() && self.decided_at != Some(stage.camera.position) {
            self.inside = surroundings::is_inside(stage, self.inside && self.decided_at.is_some());
            self.decided_at = Some(stage.camera.position);
        }
    }

    /// Moves the camera to time `now_ms`; true while the motion continues.
    pub fn advance(&mut self, now_ms: f64, stage: &mut Stage) -> bool {
        self.decide(stage);
        self.fly.advance(now_ms, stage, self.is_inside());
        self.fly.moving()
    }

    /// A pointer goes down; `reach` is the picking distance of handles, pixels.
    pub fn pointer_down(&mut self, id: i32, at: [f64; 2], button: PointerButton, reach: f64, stage: &Stage) {
        self.decide(stage);
        self.pointers.retain(|p| p.id != id);
        self.grip = None;
        #[cfg(feature = "radiosity")]
        self.node_grip.take();
        self.dragged = !self.pointers.is_empty();
        if !self.dragged {
            self.before = Some(stage.camera.clone());
            if stage.handles && button != PointerButton::Look {
                self.grip = gizmo::pick(stage, at, reach).and_then(|handle| Grip::new(stage, handle, at));
            }
            if let Some(grip) = &self.grip {
                self.selected = Some(grip.handle.light);
            }
            #[cfg(feature = "radiosity")]
            if stage.handles && self.grip.is_none() && button != PointerButton::Look {
                let handle = node_gizmo::pick(stage, at, reach, self.hovered_node);
                self.node_grip = handle.and_then(|handle| NodeGrip::new(stage, handle));
            }
        }
        self.pointers.push(Pointer { id, at, start: at, button });
    }

    /// A pointer moves. A pointer that is not down highlights the handle under the pointer. A dragged light passes
    /// through surfaces with `shift`, and moves nearer and farther with `alt`.
    pub fn pointer_move(&mut self, id: i32, at: [f64; 2], shift: bool, alt: bool, stage: &mut Stage) {
        let Some(i) = self.pointers.iter().position(|p| p.id == id) else {
            self.hovered = if stage.handles { gizmo::pick(stage, at, 0.0) } else { None };
            #[cfg(feature = "radiosity")]
            {
                let is_free = stage.handles && self.hovered.is_none();
                let marked = self.hovered_node;
                self.hovered_node = if is_free { node_gizmo::pick(stage, at, 0.0, marked) } else { None };
            }
            return;
        };
        let Pointer { at: before, start, button, .. } = self.pointers[i];
        self.pointers[i].at = at;
        let slack = 0.5 * f64::from(shape::radius(stage.size));
        self.dragged |= (at[0] - start[0]).hypot(at[1] - start[1]) > slack;
        let delta = [at[0] - before[0], at[1] - before[1]];
        let height = stage.size[1].max(1) as f64;
        let pixel = orbit::pixel_at_target(&stage.camera, stage.frame().tan_half_yfov, height);
        #[cfg(feature = "radiosity")]
        if let Some(grip) = &self.node_grip {
            return grip.drag(stage, [before, at], shift || alt);
        }
        if let Some(grip) = &mut self.grip {
            grip.drag(stage, [before, at], shift, alt);
        } else if let Some(other) = self.pointers.iter().find(|p| p.id != id) {
            let distance = |a: [f64; 2]| (a[0] - other.at[0]).hypot(a[1] - other.at[1]).max(1.0);
            let wider = distance(at) / distance(before);
            if self.is_inside() {
                let step = PINCH * stage.extent;
                fly::travel(stage, [-step * delta[0] / height, 0.0, step * wider.ln()], true);
            } else {
                fly::travel(stage, [-0.5 * delta[0] * pixel, 0.5 * delta[1] * pixel, 0.0], false);
                dolly(stage, 1.0 / wider);
            }
        } else {
            match button {
                PointerButton::Turn if !self.is_inside() => {
                    let mut wanted = stage.camera.clone();
                    orbit::orbit(&mut wanted, -delta[0] * ORBIT / height, -delta[1] * ORBIT / height);
                    collide::advance(stage, wanted, Motion::Orbit);
                }
                // Grabs the picture: the place under the pointer stays under the pointer.
                PointerButton::Turn | PointerButton::Look => {
                    let tan = stage.frame().tan_half_yfov;
                    let angle = |at: [f64; 2], i: usize| {
                        let across = (2.0 * at[i] - f64::from(stage.size[i])) / height;
                        f64::from((across as f32 * tan).atan2(1.0))
                    };
                    let [yaw, pitch] = [0, 1].map(|i| angle(at, i) - angle(before, i));
                    orbit::look(&mut stage.camera, yaw, pitch);
                }
                PointerButton::Pan => {
                    fly::travel(stage, [-delta[0] * pixel, delta[1] * pixel, 0.0], false);
                }
            }
        }
    }

    /// A pointer goes up; `click`: released by the user. A click without a handle clears the selection.
    pub fn pointer_up(&mut self, id: i32, click: bool) {
        let button = self.pointers.iter().find(|p| p.id == id).map(|p| p.button);
        if click && !self.dragged && self.grip.is_none() && button == Some(PointerButton::Turn) {
            self.selected = None;
        }
        self.pointers.retain(|p| p.id != id);
        self.grip = None;
        #[cfg(feature = "radiosity")]
        self.node_grip.take();
    }

    /// Releases all pointers and restores the light or camera of the gesture; true if a pointer was down.
    fn cancel(&mut self, stage: &mut Stage) -> bool {
        if self.pointers.is_empty() {
            return false;
        }
        #[cfg(feature = "radiosity")]
        if let Some(grip) = self.node_grip.take() {
            if let Some(node) = stage.nodes.get_mut(grip.handle.node) {
                *node = grip.before;
            }
            self.pointers.clear();
            return true;
        }
        if let Some(grip) = self.grip.take() {
            if let Some(light) = stage.lights.get_mut(grip.handle.light) {
                *light = grip.before;
            }
        } else if let Some(camera) = self.before.take() {
            stage.camera = camera;
        }
        self.pointers.clear();
        true
    }

    /// The wheel turns by `delta_y` pixels.
    pub fn wheel(&mut self, delta_y: f64, stage: &mut Stage) {
        if !delta_y.is_finite() {
            return;
        }
        let delta = delta_y.clamp(-400.0, 400.0);
        if let (Some(grip), Some(pointer)) = (&mut self.grip, self.pointers.first()) {
            grip.put(stage, pointer.at, (-delta * 1e-3).exp());
        } else if self.is_inside() {
            fly::travel(stage, [0.0, 0.0, -delta * WHEEL * stage.extent], true);
        } else {
            dolly(stage, (delta * 1e-3).exp());
        }
    }

    /// Sets the on-screen stick: right and ahead, -1 to 1.
    pub fn stick(&mut self, to: [f64; 2]) {
        self.fly.stick(to);
    }

    /// A key (`KeyboardEvent.code`) goes down or up; true if the controls use the key.
    pub fn key(&mut self, code: &str, down: bool, stage: &mut Stage) -> bool {
        if code == "Escape" { down && self.cancel(stage) } else { self.fly.key(code, down) }
    }
}

/// Moves to `factor` times the distance from the target, as far as surfaces allow.
fn dolly(stage: &mut Stage, factor: f64) {
    let mut wanted = stage.camera.clone();
    orbit::dolly(&mut wanted, factor, 0.01 * stage.extent);
    collide::advance(stage, wanted, Motion::Dolly);
}

#[cfg(test)]
mod tests;
