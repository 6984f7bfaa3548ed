//! What pointers, wheel and keys do to the camera and to the lights. No GPU, no browser.
//!
//! One pointer on a light's handle drags it and chooses the light ([`drag`]). Elsewhere the primary button looks around
//! inside and orbits outside ([`surroundings`]), the secondary one (or ctrl) looks around, the middle one (or shift) pans.
//! Wheel and two pointers walk inside, and dolly outside. W A S D, Q E, arrows and the stick walk inside, and fly outside
//! ([`fly`]). Surfaces stop the camera ([`collide`]).

pub mod collide;
pub mod drag;
pub mod fly;
pub mod gizmo;
pub mod orbit;
pub mod sun;
pub mod surroundings;

use crate::triangles::{Hit, Triangles};
use crate::view::frame;
use collide::Motion;
use drag::Grip;
use fly::Fly;
use gizmo::{Handle, Marks};
use glam::{DVec3, Vec3};
use rebounce_shared::camera::{Camera, CameraFrame};
use rebounce_shared::light::Light;
use std::rc::Rc;

/// Scene diagonals that one walks for a pixel of the wheel.
const WHEEL: f64 = 2.5e-4;
/// Scene diagonals that one walks when two pointers are moved apart to e times their distance.
const PINCH: f64 = 0.15;

/// Radians that a drag over the picture's height orbits.
const ORBIT: f64 = 3.0;

/// What the controls act on, world space.
#[derive(Clone)]
pub struct Stage {
    /// The camera.
    pub camera: Camera,
    /// The lights.
    pub lights: Vec<Light>,
    /// Whether the lights' handles are shown and can be dragged.
    pub handles: bool,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// The scene's diagonal, scene units.
    pub extent: f64,
    /// Where local space has its origin.
    pub origin: [f64; 3],
    /// How far the camera stays away from surfaces, scene units.
    pub clearance: f32,
    /// The scene's triangles, local space.
    pub triangles: Rc<Triangles>,
}

impl Stage {
    /// The camera's frame in the picture, its eye aside.
    pub fn frame(&self) -> CameraFrame {
        frame(&self.camera, [0.0; 3], self.size)
    }

    /// The place that is seen at a pixel, world space.
    pub fn surface_at(&self, at: [f64; 2]) -> Option<[f64; 3]> {
        let [width, height] = self.size;
        let ray = self.frame().direction(at[0] as f32, at[1] as f32, width, height);
        self.seen_along(ray, f32::INFINITY).map(|hit| self.along(ray, hit.distance))
    }

    /// The first surface before `most` along a ray of unit direction from the eye.
    fn seen_along(&self, ray: Vec3, most: f32) -> Option<Hit> {
        self.triangles.cast(self.local(self.camera.position), ray, most)
    }

    /// A place on a ray from the eye, world space.
    fn along(&self, ray: Vec3, distance: f32) -> [f64; 3] {
        (DVec3::from(self.camera.position) + (ray * distance).as_dvec3()).to_array()
    }

    /// A place in local space.
    pub fn local(&self, place: [f64; 3]) -> Vec3 {
        (DVec3::from(place) - DVec3::from(self.origin)).as_vec3()
    }
}

/// What a pressed pointer is meant to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointerButton {
    /// Looks around inside, orbits outside, or drags a light's handle that lies under it.
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
    /// The handle that is dragged.
    grip: Option<Grip>,
    /// The camera when the first pointer went down.
    before: Option<Camera>,
    /// Pointers have been dragged since, or there were several: no click.
    dragged: bool,
    fly: Fly,
    hovered: Option<Handle>,
    /// The chosen light.
    pub selected: Option<usize>,
    /// Whether drags look around; `None`: where the camera is inside.
    pub looks: Option<bool>,
    inside: bool,
    /// Where that was found out.
    decided_at: Option<[f64; 3]>,
}

impl Controls {
    /// Forgets pointers, keys and whether the camera is inside; call when camera or scene were replaced.
    pub fn reset(&mut self) {
        self.pointers.clear();
        (self.grip, self.hovered, self.decided_at) = (None, None, None);
        self.fly.release();
    }

    /// What of the handles stands out.
    pub fn marks(&self) -> Marks {
        let hovered = self.grip.as_ref().map(|grip| grip.handle).or(self.hovered);
        Marks { hovered, selected: self.selected }
    }

    /// Marks a light's handle as one under a pointer is.
    pub fn hover(&mut self, light: Option<usize>) {
        self.hovered = light.map(|light| Handle { light, aim: false });
    }

    /// Whether drags look around and keys walk.
    pub fn is_inside(&self) -> bool {
        self.looks.unwrap_or(self.inside)
    }

    /// Updates whether the camera is inside, after a move and while no pointer or key holds it.
    fn decide(&mut self, stage: &Stage) {
        if self.pointers.is_empty() && !self.fly.moving() && self.decided_at != Some(stage.camera.position) {
            self.inside = surroundings::is_inside(stage, self.inside && self.decided_at.is_some());
            self.decided_at = Some(stage.camera.position);
        }
    }

    /// Moves the camera to `now_ms`; true while further frames will move it too.
    pub fn advance(&mut self, now_ms: f64, stage: &mut Stage) -> bool {
        self.decide(stage);
        self.fly.advance(now_ms, stage, self.is_inside());
        self.fly.moving()
    }

    /// A pointer goes down; `reach` is how near to a handle counts, pixels.
    pub fn pointer_down(&mut self, id: i32, at: [f64; 2], button: PointerButton, reach: f64, stage: &Stage) {
        self.decide(stage);
        self.pointers.retain(|p| p.id != id);
        self.grip = None;
        self.dragged = !self.pointers.is_empty();
        if !self.dragged {
            self.before = Some(stage.camera.clone());
            if stage.handles && button != PointerButton::Look {
                self.grip = gizmo::pick(stage, at, reach).and_then(|handle| Grip::new(stage, handle, at));
            }
            if let Some(grip) = &self.grip {
                self.selected = Some(grip.handle.light);
            }
        }
        self.pointers.push(Pointer { id, at, start: at, button });
    }

    /// A pointer moves. Over a handle one that is not down marks it. A dragged light goes through surfaces with `shift`,
    /// nearer and farther with `alt`.
    pub fn pointer_move(&mut self, id: i32, at: [f64; 2], shift: bool, alt: bool, stage: &mut Stage) {
        let Some(i) = self.pointers.iter().position(|p| p.id == id) else {
            self.hovered = if stage.handles { gizmo::pick(stage, at, 0.0) } else { None };
            return;
        };
        let Pointer { at: before, start, button, .. } = self.pointers[i];
        self.pointers[i].at = at;
        let slack = 0.5 * f64::from(gizmo::radius(stage.size));
        self.dragged |= (at[0] - start[0]).hypot(at[1] - start[1]) > slack;
        let delta = [at[0] - before[0], at[1] - before[1]];
        let height = stage.size[1].max(1) as f64;
        let pixel = orbit::pixel_at_target(&stage.camera, stage.frame().tan_half_yfov, height);
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
                // The picture is grabbed: what is under the pointer stays there.
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

    /// A pointer goes up; `click`: by hand. A click beside all handles leaves no light chosen.
    pub fn pointer_up(&mut self, id: i32, click: bool) {
        let button = self.pointers.iter().find(|p| p.id == id).map(|p| p.button);
        if click && !self.dragged && self.grip.is_none() && button == Some(PointerButton::Turn) {
            self.selected = None;
        }
        self.pointers.retain(|p| p.id != id);
        self.grip = None;
    }

    /// Releases all pointers and restores the light or camera of the gesture; true if a pointer was down.
    fn cancel(&mut self, stage: &mut Stage) -> bool {
        if self.pointers.is_empty() {
            return false;
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

    /// The on-screen stick is held to the right and ahead, -1 to 1.
    pub fn stick(&mut self, to: [f64; 2]) {
        self.fly.stick(to);
    }

    /// A key (`KeyboardEvent.code`) goes down or up; true when the controls use it.
    pub fn key(&mut self, code: &str, down: bool, stage: &mut Stage) -> bool {
        if code == "Escape" { down && self.cancel(stage) } else { self.fly.key(code, down) }
    }
}

/// Goes to `factor` times the distance from the target, as far as surfaces let it.
fn dolly(stage: &mut Stage, factor: f64) {
    let mut wanted = stage.camera.clone();
    orbit::dolly(&mut wanted, factor, 0.01 * stage.extent);
    collide::advance(stage, wanted, Motion::Dolly);
}

#[cfg(test)]
mod tests;
