//! What pointer, wheel and keys do to the camera and to the lights.

use crate::renderer::Renderer;

/// What a pressed pointer is meant to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointerButton {
    /// Turns the camera, or drags a light that lies under it.
    Primary,
    /// Moves the camera sideways.
    Pan,
}

impl PointerButton {
    /// From a `PointerEvent`'s button (0 left, 1 middle, 2 right) and modifier keys.
    pub fn from_event(button: i32, shift: bool, ctrl: bool) -> Self {
        if button == 0 && !shift && !ctrl { Self::Primary } else { Self::Pan }
    }
}

/// The state of the controls.
#[derive(Debug, Default)]
pub struct Controls {}

impl Controls {
    /// Forgets all motion; call when camera or scene were replaced.
    pub fn reset(&mut self, _renderer: &Renderer) {}
    /// Advances motion to `now_ms`; true while more will follow.
    pub fn advance(&mut self, _now_ms: f64, _renderer: &mut Renderer) -> bool {
        false
    }
    /// A pointer goes down.
    pub fn pointer_down(
        &mut self,
        _id: i32,
        _at: [f64; 2],
        _b: PointerButton,
        _size: [u32; 2],
        _r: &mut Renderer,
    ) {
    }
    /// A pointer moves; true if that changed anything.
    pub fn pointer_move(&mut self, _id: i32, _at: [f64; 2], _size: [u32; 2], _r: &mut Renderer) -> bool {
        false
    }
    /// A pointer goes up.
    pub fn pointer_up(&mut self, _id: i32, _r: &mut Renderer) {}
    /// The wheel turns.
    pub fn wheel(&mut self, _at: [f64; 2], _delta_y: f64, _size: [u32; 2], _r: &mut Renderer) {}
    /// A key goes down or up; true when it is one of the controls'.
    pub fn key(&mut self, _code: &str, _down: bool) -> bool {
        false
    }
}
