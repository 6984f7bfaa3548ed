//! Pointers, wheel and keys, as the element hands them to the class [`Viewer`].

use super::Viewer;
use crate::controls::{Controls, PointerButton, Stage};
use wasm_bindgen::prelude::*;

impl Viewer {
    /// Runs input on the controls and tells the page if that changed anything.
    fn control(&self, work: impl FnOnce(&mut Controls, &mut Stage, [u32; 2], bool)) {
        let changed = {
            let mut state = self.state.borrow_mut();
            let state = &mut *state;
            let mut stage = state.renderer.stage();
            let size = [state.config.width, state.config.height];
            work(&mut state.controls, &mut stage, size, state.renderer.gizmos());
            state.renderer.apply(stage);
            state.renderer.set_active(state.controls.dragged());
            state.renderer.needs_frame()
        };
        if changed {
            self.callbacks.changed();
        }
    }
}

#[wasm_bindgen]
impl Viewer {
    /// A pointer goes down at (x, y), canvas pixels. `button` is that of a `PointerEvent`.
    #[wasm_bindgen(js_name = pointerDown)]
    pub fn pointer_down(
        &self,
        id: i32,
        x: f64,
        y: f64,
        button: i32,
        shift: bool,
        ctrl: bool,
    ) -> Result<(), JsValue> {
        let button = PointerButton::from_event(button, shift, ctrl);
        self.control(|controls, stage, size, handles| {
            controls.pointer_down(id, [x, y], button, size, stage, handles);
        });
        Ok(())
    }

    /// A pointer moves to (x, y).
    #[wasm_bindgen(js_name = pointerMove)]
    pub fn pointer_move(&self, id: i32, x: f64, y: f64) -> Result<(), JsValue> {
        self.control(|controls, stage, size, _| controls.pointer_move(id, [x, y], size, stage));
        Ok(())
    }

    /// A pointer goes up, or is cancelled.
    #[wasm_bindgen(js_name = pointerUp)]
    pub fn pointer_up(&self, id: i32) -> Result<(), JsValue> {
        self.control(|controls, _, _, _| controls.pointer_up(id));
        Ok(())
    }

    /// The wheel turns by `delta_y` pixels over (x, y): dolly.
    pub fn wheel(&self, _x: f64, _y: f64, delta_y: f64) -> Result<(), JsValue> {
        self.control(|controls, stage, _, _| controls.wheel(delta_y, stage));
        Ok(())
    }

    /// A key, by `KeyboardEvent.code`, goes down or up. True when the viewer uses that key.
    pub fn key(&self, code: &str, down: bool) -> bool {
        let used = self.state.borrow_mut().controls.key(code, down);
        if used {
            self.callbacks.changed();
        }
        used
    }
}
