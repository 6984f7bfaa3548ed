//! Settings of the class [`Viewer`]: camera, lights, exposure, mode, overlay.

use super::viewer::Viewer;
use super::wire;
use crate::passes::settings::{Display, Mode, Overlay, ToneMapping};
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
impl Viewer {
    /// The present camera as a list of numbers: see [`crate::wasm::wire`].
    pub fn camera(&self) -> Vec<f64> {
        wire::camera_numbers(self.state.borrow().renderer.camera())
    }

    /// The present lights.
    pub fn lights(&self) -> Vec<f64> {
        wire::light_numbers(self.state.borrow().renderer.lights())
    }

    /// Sets the camera.
    #[wasm_bindgen(js_name = setCamera)]
    pub fn set_camera(&self, camera: &[f64]) -> Result<(), JsValue> {
        self.change(|state| {
            state.renderer.set_camera(wire::camera_of(camera)?)?;
            state.controls.reset();
            Ok(())
        })
    }

    /// Sets the lights.
    #[wasm_bindgen(js_name = setLights)]
    pub fn set_lights(&self, lights: &[f64]) -> Result<(), JsValue> {
        self.change(|state| state.renderer.set_lights(wire::lights_of(lights)?))
    }

    /// Sets the mix: the numbers of [`crate::wasm::wire`] for each light; lights beyond are as they are.
    #[wasm_bindgen(js_name = setMix)]
    pub fn set_mix(&self, mix: &[f64]) -> Result<(), JsValue> {
        self.change(|state| state.renderer.set_mix(wire::mix_of(mix)))
    }

    /// Sets the picture of environment lights: rows of rgb9e5 texels from the top, `scale` the radiance of a texel of 1.
    /// Without texels, the file's own picture.
    #[wasm_bindgen(js_name = setEnvironment)]
    pub fn set_environment(&self, width: u32, scale: f32, texels: Vec<u32>) -> Result<(), JsValue> {
        self.change(|state| state.renderer.set_environment(wire::environment_of(width, scale, texels)?))
    }

    /// Blur of the background, 0 to 1.
    #[wasm_bindgen(setter, js_name = backgroundBlur)]
    pub fn set_background_blur(&self, blur: f64) -> Result<(), JsValue> {
        self.change(|state| {
            state.renderer.set_background_blur(blur as f32);
            Ok(())
        })
    }

    /// Sets camera and lights, or neither on an error, and measures the exposure again.
    #[wasm_bindgen(js_name = setShot)]
    pub fn set_shot(&self, camera: &[f64], lights: &[f64]) -> Result<(), JsValue> {
        let key = self.callbacks.key.clone();
        self.change(|state| {
            let before = state.renderer.lights().to_vec();
            state.renderer.set_lights(wire::lights_of(lights)?)?;
            let set = wire::camera_of(camera).and_then(|camera| state.renderer.set_camera(camera));
            if set.is_err() {
                state.renderer.set_lights(before)?;
            }
            set?;
            state.renderer.rekey();
            key.set(0.0);
            state.controls.reset();
            Ok(())
        })
    }

    /// Exposure in stops on top of the automatic one.
    #[wasm_bindgen(getter)]
    pub fn exposure(&self) -> f64 {
        self.state.borrow().renderer.exposure() as f64
    }

    /// Sets the exposure.
    #[wasm_bindgen(setter)]
    pub fn set_exposure(&self, stops: f64) -> Result<(), JsValue> {
        self.change(|state| state.renderer.set_exposure(stops as f32))
    }

    /// Measured factor on radiance in the first picture of the scene; 0 while unknown.
    #[wasm_bindgen(getter)]
    pub fn measured(&self) -> f32 {
        self.callbacks.key.get()
    }

    /// Sets the initial exposure without a measurement, as after the loss of a device; 0 changes nothing.
    #[wasm_bindgen(setter)]
    pub fn set_measured(&self, key: f32) -> Result<(), JsValue> {
        self.callbacks.key.set(key);
        self.change(|state| {
            state.renderer.set_key(key);
            Ok(())
        })
    }

    /// Whether the exposure is measured; if not, radiance 1 is white at 0 stops.
    #[wasm_bindgen(getter, js_name = autoExposure)]
    pub fn auto_exposure(&self) -> bool {
        self.state.borrow().renderer.auto_exposure()
    }

    /// Turns the measured exposure on or off.
    #[wasm_bindgen(setter, js_name = autoExposure)]
    pub fn set_auto_exposure(&self, on: bool) -> Result<(), JsValue> {
        self.change(|state| {
            state.renderer.set_auto_exposure(on);
            Ok(())
        })
    }

    /// Tone mapping from radiance to display values: `"agx"` or `"neutral"`.
    #[wasm_bindgen(getter, js_name = toneMapping)]
    pub fn tone_mapping(&self) -> String {
        self.state.borrow().renderer.tone_mapping().name().into()
    }

    /// Sets the tone mapping.
    #[wasm_bindgen(setter, js_name = toneMapping)]
    pub fn set_tone_mapping(&self, name: &str) -> Result<(), JsValue> {
        self.change(|state| {
            state.renderer.set_tone_mapping(ToneMapping::parse(name)?);
            Ok(())
        })
    }

    /// Displayed part of the light: `"all"`, `"direct"` or `"indirect"`.
    #[wasm_bindgen(getter)]
    pub fn mode(&self) -> String {
        self.state.borrow().renderer.mode().name().into()
    }

    /// Sets the displayed part of the light.
    #[wasm_bindgen(setter)]
    pub fn set_mode(&self, mode: &str) -> Result<(), JsValue> {
        self.change(|state| {
            state.renderer.set_mode(Mode::parse(mode)?);
            Ok(())
        })
    }

    /// Overlay on the picture: `"none"`, `"points"` or `"levels"`.
    #[wasm_bindgen(getter)]
    pub fn overlay(&self) -> String {
        self.state.borrow().renderer.overlay().name().into()
    }

    /// Sets the overlay.
    #[wasm_bindgen(setter)]
    pub fn set_overlay(&self, overlay: &str) -> Result<(), JsValue> {
        self.change(|state| {
            state.renderer.set_overlay(Overlay::parse(overlay)?);
            Ok(())
        })
    }

    /// Display method from functions to pixels: `"auto"`, `"lookup"` or `"splat"`.
    #[wasm_bindgen(getter)]
    pub fn display(&self) -> String {
        self.state.borrow().renderer.display().name().into()
    }

    /// Sets the display method.
    #[wasm_bindgen(setter)]
    pub fn set_display(&self, display: &str) -> Result<(), JsValue> {
        self.change(|state| {
            state.renderer.set_display(Display::parse(display)?);
            Ok(())
        })
    }

    /// Whether openness of pixels modulates bounced light; initially true.
    #[wasm_bindgen(setter)]
    pub fn set_detail(&self, on: bool) -> Result<(), JsValue> {
        self.change(|state| {
            state.renderer.set_detail(on);
            Ok(())
        })
    }

    /// Whether a backdrop is drawn behind an object; initially true.
    #[wasm_bindgen(setter)]
    pub fn set_backdrop(&self, on: bool) -> Result<(), JsValue> {
        self.change(|state| {
            state.renderer.set_backdrop(on);
            Ok(())
        })
    }

    /// Whether the lights' handles are drawn and can be dragged; initially true.
    #[wasm_bindgen(getter)]
    pub fn gizmos(&self) -> bool {
        self.state.borrow().renderer.gizmos()
    }

    /// Shows or hides the lights' handles.
    #[wasm_bindgen(setter)]
    pub fn set_gizmos(&self, on: bool) -> Result<(), JsValue> {
        self.change(|state| {
            state.renderer.set_gizmos(on);
            Ok(())
        })
    }
}
