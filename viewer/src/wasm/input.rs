//! Pointers, wheel and keys, passed from the element to the class [`Viewer`].

use super::viewer::Viewer;
use crate::controls::{Controls, PointerButton, Stage, sun};
use wasm_bindgen::prelude::*;

impl Viewer {
    /// Runs input on the controls and notifies the page of a change.
    fn control<T>(&self, work: impl FnOnce(&mut Controls, &mut Stage) -> T) -> T {
        let (result, changed) = {
            let mut state = self.state.borrow_mut();
            let state = &mut *state;
            let mut stage = state.renderer.stage(state.size);
            let result = work(&mut state.controls, &mut stage);
            state.renderer.apply(stage);
            state.renderer.set_marks(state.controls.marks());
            (result, state.renderer.needs_frame())
        };
        if changed {
            self.callbacks.changed();
        }
        result
    }
}

/// Index of a light, or -1 for `None` or an index out of range.
fn index(light: Option<usize>, count: usize) -> i32 {
    light.filter(|light| *light < count).map_or(-1, |light| light as i32)
}

#[wasm_bindgen]
impl Viewer {
    /// A pointer goes down at (x, y), canvas pixels. `button` as in a `PointerEvent`; grabs a handle within `reach`
    /// pixels.
    #[wasm_bindgen(js_name = pointerDown)]
    #[expect(clippy::too_many_arguments, reason = "one event, one call")]
    pub fn pointer_down(&self, id: i32, x: f64, y: f64, button: i32, shift: bool, ctrl: bool, reach: f64) {
        let button = PointerButton::from_event(button, shift, ctrl);
        self.control(|controls, stage| controls.pointer_down(id, [x, y], button, reach, stage));
    }

    /// A pointer moves to (x, y). A dragged light passes through surfaces with `shift`, and moves nearer and
    /// farther with `alt`.
    #[wasm_bindgen(js_name = pointerMove)]
    pub fn pointer_move(&self, id: i32, x: f64, y: f64, shift: bool, alt: bool) {
        self.control(|controls, stage| controls.pointer_move(id, [x, y], shift, alt, stage));
    }

    /// A pointer goes up; `click` is false if the browser cancels the pointer.
    #[wasm_bindgen(js_name = pointerUp)]
    pub fn pointer_up(&self, id: i32, click: bool) {
        self.control(|controls, _| controls.pointer_up(id, click));
    }

    /// The visible place at (x, y), canvas pixels, in world space; undefined without a surface.
    #[wasm_bindgen(js_name = surfaceAt)]
    pub fn surface_at(&self, x: f64, y: f64) -> Option<Vec<f64>> {
        let state = self.state.borrow();
        let stage = state.renderer.stage(state.size);
        stage.surface_at([x, y]).map(|place| place.to_vec())
    }

    /// Direction of light for a new sun: through an opening if the view is closed.
    pub fn sunlight(&self) -> Vec<f64> {
        let state = self.state.borrow();
        sun::sunlight(&state.renderer.stage(state.size)).to_vec()
    }

    /// The wheel turns by `delta_y` pixels: walks, dollies, or moves a dragged light farther.
    pub fn wheel(&self, delta_y: f64) {
        self.control(|controls, stage| controls.wheel(delta_y, stage));
    }

    /// Sets the on-screen stick: right and ahead, -1 to 1; zeros release the stick.
    pub fn stick(&self, right: f64, ahead: f64) {
        self.control(|controls, _| controls.stick([right, ahead]));
        self.callbacks.changed();
    }

    /// A key, by `KeyboardEvent.code`, goes down or up. True if the viewer uses the key.
    pub fn key(&self, code: &str, down: bool) -> bool {
        let used = self.control(|controls, stage| controls.key(code, down, stage));
        if used {
            self.callbacks.changed();
        }
        used
    }

    /// Whether drags look around and keys walk; otherwise drags orbit and keys fly.
    #[wasm_bindgen(getter)]
    pub fn inside(&self) -> bool {
        self.state.borrow().controls.is_inside()
    }

    /// Action of drags: `"look"` or `"orbit"`; any other value decides by whether the camera is inside.
    #[wasm_bindgen(setter, js_name = cameraControls)]
    pub fn set_camera_controls(&self, what: &str) {
        let looks = if what == "look" { Some(true) } else { (what == "orbit").then_some(false) };
        self.state.borrow_mut().controls.looks = looks;
    }

    /// The light with a highlighted handle; -1 for none.
    #[wasm_bindgen(getter, js_name = hoveredLight)]
    pub fn hovered_light(&self) -> i32 {
        let state = self.state.borrow();
        let hovered = state.controls.marks().hovered.map(|handle| handle.light);
        index(hovered, state.renderer.lights().len())
    }

    /// Highlights a light's handle.
    #[wasm_bindgen(setter, js_name = hoveredLight)]
    pub fn set_hovered_light(&self, light: i32) {
        self.control(|controls, _| controls.hover(usize::try_from(light).ok()));
    }

    /// The selected light; -1 for none.
    #[wasm_bindgen(getter, js_name = selectedLight)]
    pub fn selected_light(&self) -> i32 {
        let state = self.state.borrow();
        index(state.controls.selected, state.renderer.lights().len())
    }

    /// Selects a light.
    #[wasm_bindgen(setter, js_name = selectedLight)]
    pub fn set_selected_light(&self, light: i32) {
        self.control(|controls, _| controls.selected = usize::try_from(light).ok());
    }
}
