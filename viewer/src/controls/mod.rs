//! What pointer, wheel and keys do to the camera and to the lights. No GPU, no browser.
//!
//! One pointer on a light's handle drags it (with shift: nearer and farther). Elsewhere the primary
//! button orbits, the secondary one (or ctrl) looks around, the middle one (or shift) pans. Two
//! pointers pan and pinch. The wheel dollies. W A S D, Q E and arrows fly.

pub mod fly;
pub mod gizmo;
pub mod orbit;

use fly::Fly;
use gizmo::Handle;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;

/// What the controls act on, world space.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// The camera.
    pub camera: Camera,
    /// The lights.
    pub lights: Vec<Light>,
    /// The scene's diagonal, scene units.
    pub extent: f64,
    /// The scene's centre.
    pub centre: [f64; 3],
}

/// What a pressed pointer is meant to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointerButton {
    /// Orbits, or drags a light's handle that lies under it.
    Orbit,
    /// Turns the camera around itself.
    Look,
    /// Moves the camera sideways; a light's handle, nearer and farther.
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
            _ => Self::Orbit,
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Pointer {
    id: i32,
    at: [f64; 2],
    button: PointerButton,
}

/// The state of the controls.
#[derive(Debug, Default)]
pub struct Controls {
    pointers: Vec<Pointer>,
    dragged: Option<Handle>,
    fly: Fly,
}

impl Controls {
    /// Forgets pointers and keys; call when camera or scene were replaced.
    pub fn reset(&mut self) {
        self.pointers.clear();
        self.dragged = None;
        self.fly.release();
    }

    /// The handle that is dragged.
    pub fn dragged(&self) -> Option<Handle> {
        self.dragged
    }

    /// Moves the camera to `now_ms`; true while further frames will move it too.
    pub fn advance(&mut self, now_ms: f64, stage: &mut Stage) -> bool {
        self.fly.advance(now_ms, &mut stage.camera, stage.extent);
        self.fly.moving()
    }

    /// A pointer goes down; `handles` tells whether the lights' handles can be dragged.
    pub fn pointer_down(
        &mut self,
        id: i32,
        at: [f64; 2],
        button: PointerButton,
        size: [u32; 2],
        stage: &Stage,
        handles: bool,
    ) {
        self.pointers.retain(|p| p.id != id);
        self.pointers.push(Pointer { id, at, button });
        self.dragged = match self.pointers.len() {
            1 if handles && button != PointerButton::Look => gizmo::pick(stage, at, size),
            _ => None,
        };
    }

    /// A pointer moves.
    pub fn pointer_move(&mut self, id: i32, at: [f64; 2], size: [u32; 2], stage: &mut Stage) {
        let Some(i) = self.pointers.iter().position(|p| p.id == id) else { return };
        let before = self.pointers[i].at;
        let button = self.pointers[i].button;
        self.pointers[i].at = at;
        let delta = [at[0] - before[0], at[1] - before[1]];
        let height = size[1].max(1) as f64;
        let least = 0.01 * stage.extent;
        if let Some(handle) = self.dragged {
            gizmo::drag(stage, handle, delta, button == PointerButton::Pan, size);
        } else if let Some(other) = self.pointers.iter().find(|p| p.id != id) {
            let distance = |a: [f64; 2]| (a[0] - other.at[0]).hypot(a[1] - other.at[1]).max(1.0);
            let pixel = orbit::pixel_at_target(&stage.camera, height);
            orbit::travel(&mut stage.camera, -0.5 * delta[0] * pixel, 0.5 * delta[1] * pixel, 0.0);
            orbit::dolly(&mut stage.camera, distance(before) / distance(at), least);
        } else {
            let turn = [-delta[0] * 3.0 / height, -delta[1] * 3.0 / height];
            match button {
                PointerButton::Orbit => orbit::orbit(&mut stage.camera, turn[0], turn[1]),
                // The picture is grabbed, as in orbiting.
                PointerButton::Look => orbit::look(&mut stage.camera, -turn[0], -turn[1]),
                PointerButton::Pan => {
                    let pixel = orbit::pixel_at_target(&stage.camera, height);
                    orbit::travel(&mut stage.camera, -delta[0] * pixel, delta[1] * pixel, 0.0);
                }
            }
        }
    }

    /// A pointer goes up, or is cancelled.
    pub fn pointer_up(&mut self, id: i32) {
        self.pointers.retain(|p| p.id != id);
        self.dragged = None;
    }

    /// The wheel turns by `delta_y` pixels.
    pub fn wheel(&mut self, delta_y: f64, stage: &mut Stage) {
        if delta_y.is_finite() {
            let factor = (delta_y.clamp(-400.0, 400.0) * 1e-3).exp();
            orbit::dolly(&mut stage.camera, factor, 0.01 * stage.extent);
        }
    }

    /// A key (`KeyboardEvent.code`) goes down or up; true when it is one of the controls'.
    pub fn key(&mut self, code: &str, down: bool) -> bool {
        self.fly.key(code, down)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [u32; 2] = [640, 480];

    fn stage() -> Stage {
        Stage {
            camera: Camera {
                position: [0.0, 0.0, 5.0],
                target: [0.0; 3],
                up: [0.0, 1.0, 0.0],
                yfov_deg: 60.0,
            },
            lights: vec![Light::Point { position: [0.0; 3], intensity: 1.0, color: [1.0; 3] }],
            extent: 10.0,
            centre: [0.0; 3],
        }
    }

    #[test]
    fn a_press_on_a_handle_moves_the_light_and_not_the_camera() {
        let (mut controls, mut s) = (Controls::default(), stage());
        controls.pointer_down(1, [320.0, 240.0], PointerButton::Orbit, SIZE, &s, true);
        controls.pointer_move(1, [350.0, 240.0], SIZE, &mut s);
        assert_eq!(s.camera, stage().camera);
        assert_ne!(s.lights, stage().lights);
        controls.pointer_up(1);
        controls.pointer_move(1, [450.0, 240.0], SIZE, &mut s);
        assert_eq!(s.camera, stage().camera);
    }

    #[test]
    fn a_press_elsewhere_or_with_hidden_handles_orbits() {
        for (at, handles) in [([100.0, 100.0], true), ([320.0, 240.0], false)] {
            let (mut controls, mut s) = (Controls::default(), stage());
            controls.pointer_down(1, at, PointerButton::Orbit, SIZE, &s, handles);
            controls.pointer_move(1, [at[0] + 30.0, at[1]], SIZE, &mut s);
            assert_eq!(s.lights, stage().lights);
            assert_ne!(s.camera.position, stage().camera.position);
            assert_eq!(s.camera.target, stage().camera.target);
        }
    }

    #[test]
    fn two_pointers_pinch() {
        let (mut controls, mut s) = (Controls::default(), stage());
        controls.pointer_down(1, [100.0, 100.0], PointerButton::Orbit, SIZE, &s, true);
        controls.pointer_down(2, [200.0, 100.0], PointerButton::Orbit, SIZE, &s, true);
        controls.pointer_move(2, [300.0, 100.0], SIZE, &mut s);
        assert!((s.camera.position[2] - 2.5).abs() < 1e-9, "twice the distance: half as far");
    }

    #[test]
    fn wheel_survives_nonsense() {
        let (mut controls, mut s) = (Controls::default(), stage());
        controls.wheel(f64::NAN, &mut s);
        assert_eq!(s, stage());
        controls.wheel(1e300, &mut s);
        assert!(s.camera.position.iter().all(|x| x.is_finite()));
    }
}
