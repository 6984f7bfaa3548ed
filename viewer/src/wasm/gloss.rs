//! Reflections, in the renderer of all files.

use super::viewer::Viewer;
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
impl Viewer {
    /// Whether metals are GGX conductors whose reflectance is the base colour at every angle, and nothing else shines, as
    /// SHOT.json's `gloss` has it; initially false: glTF's model.
    #[wasm_bindgen(getter)]
    pub fn gloss(&self) -> bool {
        self.state.borrow().renderer.conductors()
    }

    /// Chooses it.
    #[wasm_bindgen(setter)]
    pub fn set_gloss(&self, on: bool) -> Result<(), JsValue> {
        self.change(|state| {
            state.renderer.set_conductors(on);
            Ok(())
        })
    }
}
