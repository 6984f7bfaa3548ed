//! The browser's class `Viewer`: the renderer on a canvas.
//!
//! Every failure is a JavaScript `Error` whose `code` is one of [`ViewerError::code`]'s.

mod page;
mod shared;

use crate::composite::FIRST_KEY;
use crate::controls::{Controls, PointerButton, Stage};
use crate::error::ViewerError;
use crate::oneshot;
use crate::pace::{Pace, Work};
use crate::renderer::Renderer;
use crate::scene::LoadedScene;
use crate::settings::{Mode, Overlay, ToneMapping};
use crate::stats::Counts;
use crate::wire;
use page::{animation, coded, js_error, promise};
use rebounce_shared::rbn;
use shared::Shared;
use std::cell::{Cell, RefCell};
use std::rc::Rc;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::spawn_local;
use web_sys::HtmlCanvasElement;

/// Runs once when the module is loaded: a bug in Rust code becomes an `Error` with the code
/// `internal` and the panic's words instead of a bare trap.
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|info| {
        wasm_bindgen::throw_val(coded("internal", &format!("internal error: {info}; please report it")))
    }));
}

/// A view of a baked scene on a canvas.
#[wasm_bindgen]
pub struct Viewer {
    state: Rc<RefCell<State>>,
    callbacks: Rc<Callbacks>,
}

#[derive(Default)]
struct Callbacks {
    change: RefCell<Option<js_sys::Function>>,
    lost: RefCell<Option<js_sys::Function>>,
    is_lost: Cell<bool>,
    /// The automatic exposure that the scene began with, as it was read back; 0 before.
    key: Rc<Cell<f32>>,
}

struct State {
    pace: Pace,
    renderer: Renderer,
    controls: Controls,
    canvas: HtmlCanvasElement,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    configured: bool,
    max_size: u32,
    _shared: Rc<Shared>,
}

impl Drop for State {
    /// Takes the pictures from the canvas, which may live on.
    fn drop(&mut self) {
        let Ok(Some(context)) = self.canvas.get_context("webgpu") else { return };
        let unconfigure = js_sys::Reflect::get(&context, &"unconfigure".into());
        if let Ok(Ok(unconfigure)) = unconfigure.map(|it| it.dyn_into::<js_sys::Function>()) {
            let _ = unconfigure.call0(&context);
        }
    }
}

impl Callbacks {
    fn changed(&self) {
        let callback = self.change.borrow().clone();
        if let Some(callback) = callback {
            let _ = callback.call0(&JsValue::NULL);
        }
    }

    fn lose(&self, message: &str) {
        let callback = self.lost.borrow().clone();
        if let Some(callback) = callback {
            let _ = callback.call1(&JsValue::NULL, &message.into());
        }
    }
}

impl Viewer {
    /// Runs `work` on the state, then tells the page that a frame is wanted.
    fn change<T>(&self, work: impl FnOnce(&mut State) -> Result<T, ViewerError>) -> Result<T, JsValue> {
        let result = work(&mut self.state.borrow_mut());
        self.callbacks.changed();
        result.map_err(|e| js_error(&e))
    }

    /// Has the renderer read something.
    fn read<T>(&self, work: impl FnOnce(&mut Renderer) -> T) -> T {
        let renderer = &mut self.state.borrow_mut().renderer;
        let gpu = renderer.gpu().clone();
        gpu.watch(|| work(renderer))
    }

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
    /// Makes a viewer that draws on `canvas`. Rejects with `no-webgpu`, `no-adapter` or `no-device`.
    #[wasm_bindgen(unchecked_return_type = "Promise<Viewer>")]
    pub fn create(canvas: HtmlCanvasElement) -> js_sys::Promise {
        promise(async move {
            let shared = Shared::get().await?;
            let (width, height) = (canvas.width().max(1), canvas.height().max(1));
            let surface = shared
                .instance
                .create_surface(wgpu::SurfaceTarget::Canvas(canvas.clone()))
                .map_err(|e| ViewerError::NoDevice(e.to_string()))?;
            let mut config = surface
                .get_default_config(&shared.adapter, width, height)
                .ok_or_else(|| ViewerError::NoDevice("the canvas has no usable format".into()))?;
            config.alpha_mode = wgpu::CompositeAlphaMode::Opaque;
            // The shader encodes sRGB itself, so the plain 8-bit format is the one wanted.
            config.format = config.format.remove_srgb_suffix();
            let callbacks = Rc::new(Callbacks::default());
            shared.watch(&callbacks);
            // Errors of its own, on the shared device.
            let gpu = shared.gpu.share();
            let pace = Pace::default();
            if gpu.software {
                pace.expect_slow();
            }
            let state = State {
                pace,
                max_size: gpu.device.limits().max_texture_dimension_2d,
                renderer: gpu.watch(|| Renderer::with(gpu.clone(), shared.pipelines.clone())),
                controls: Controls::default(),
                canvas,
                surface,
                config,
                configured: false,
                _shared: shared,
            };
            Ok(Viewer { state: Rc::new(RefCell::new(state)), callbacks })
        })
    }

    /// Loads the bytes of a .rbn file, with its first camera and its lights. The scene before stays
    /// until the new one is ready. Rejects with `not-rbn`, `truncated`, `corrupt`, `newer-version`,
    /// `older-version`, `too-large`, `texture` or `device-lost`.
    #[wasm_bindgen(unchecked_return_type = "Promise<void>")]
    pub fn load(&self, bytes: js_sys::Uint8Array) -> js_sys::Promise {
        // Weak: a viewer that is disposed meanwhile is gone, and what has been loaded goes with its device.
        let (held, callbacks) = (Rc::downgrade(&self.state), self.callbacks.clone());
        let gpu = self.state.borrow().renderer.gpu().clone();
        let pipelines = self.state.borrow().renderer.pipelines();
        promise(async move {
            let scene = rbn::Scene::from_bytes(&bytes.to_vec())?;
            drop(bytes);
            let loaded = LoadedScene::upload(&gpu, &pipelines, scene).await?;
            let state = held.upgrade().filter(|_| !callbacks.is_lost.get());
            let Some(state) = state else { return Err(ViewerError::DeviceLost("while loading".into())) };
            {
                let mut state = state.borrow_mut();
                let state = &mut *state;
                state.renderer.install(loaded)?;
                state.controls.reset();
            }
            callbacks.changed();
            Ok(JsValue::UNDEFINED)
        })
    }

    /// Sets the size of the canvas's drawing buffer, device pixels. Clamped to what the GPU can draw.
    pub fn resize(&self, width: u32, height: u32) {
        {
            let mut state = self.state.borrow_mut();
            let (width, height) = (width.clamp(1, state.max_size), height.clamp(1, state.max_size));
            if (state.config.width, state.config.height) == (width, height) && state.configured {
                return;
            }
            state.config.width = width;
            state.config.height = height;
            state.configured = false;
            state.renderer.invalidate();
        }
        self.callbacks.changed();
    }

    /// Draws if anything changed since the last call and the GPU has done the frame before. True while motion,
    /// or a change not yet drawn, wants further frames.
    #[wasm_bindgen(js_name = frame)]
    pub fn frame(&self, now_ms: f64) -> Result<bool, JsValue> {
        if self.callbacks.is_lost.get() {
            return Ok(false);
        }
        let mut state = self.state.borrow_mut();
        let state = &mut *state;
        let gpu = state.renderer.gpu().clone();
        gpu.check().map_err(|e| js_error(&e))?;
        let mut stage = state.renderer.stage();
        let moving = state.controls.advance(now_ms, &mut stage);
        state.renderer.apply(stage);
        if state.pace.is_busy() {
            return Ok(moving || state.renderer.needs_frame());
        }
        if state.renderer.refining() && state.pace.is_slow() {
            state.renderer.stop_refining();
        }
        if !state.renderer.needs_frame() {
            return Ok(moving);
        }
        state.renderer.set_sketching(state.pace.is_slow_to_move());
        let work = if state.renderer.refining() {
            Work::Average
        } else if state.renderer.draws_view() {
            Work::View
        } else {
            Work::Other
        };
        let surface = &state.surface;
        if !state.configured {
            surface.configure(&gpu.device, &state.config);
            state.configured = true;
        }
        let texture = match surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(t) | wgpu::CurrentSurfaceTexture::Suboptimal(t) => t,
            _ => {
                state.configured = false;
                return Ok(true);
            }
        };
        let view = texture.texture.create_view(&Default::default());
        let (format, width, height) = (state.config.format, state.config.width, state.config.height);
        let drawn = gpu.watch(|| state.renderer.draw(&view, format, width, height));
        gpu.queue.present(texture);
        let (done, start) = (state.pace.begin(work), js_sys::Date::now());
        let (sender, finished) = oneshot::channel();
        gpu.queue.on_submitted_work_done(move || sender.send(()));
        let (errors, callbacks) = (gpu.clone(), Rc::downgrade(&self.callbacks));
        spawn_local(async move {
            finished.await;
            done(js_sys::Date::now() - start);
            // What was refused is known by now, and the next frame says so, wanted for itself or not.
            if let Some(callbacks) = callbacks.upgrade().filter(|_| errors.has_error()) {
                callbacks.changed();
            }
        });
        drawn.map_err(|e| js_error(&e))?;
        if let Some(measured) = state.renderer.take_measured() {
            let key = self.callbacks.key.clone();
            spawn_local(async move {
                if let Ok(bytes) = measured.wait().await {
                    key.set(bytemuck::pod_read_unaligned(&bytes[FIRST_KEY as usize..][..4]));
                }
            });
        }
        Ok(moving || state.renderer.needs_frame())
    }

    /// Called with nothing when input or a setter wants a frame.
    #[wasm_bindgen(setter)]
    pub fn set_onchange(&self, callback: Option<js_sys::Function>) {
        *self.callbacks.change.borrow_mut() = callback;
    }

    /// Called with a sentence when the GPU device is lost.
    #[wasm_bindgen(setter)]
    pub fn set_ondevicelost(&self, callback: Option<js_sys::Function>) {
        *self.callbacks.lost.borrow_mut() = callback;
    }

    /// The present camera, as [`crate::wire`] lists it.
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

    /// Sets both, or neither, and measures the exposure again.
    #[wasm_bindgen(js_name = setShot)]
    pub fn set_shot(&self, camera: &[f64], lights: &[f64]) -> Result<(), JsValue> {
        self.change(|state| {
            let before = state.renderer.lights().to_vec();
            state.renderer.set_lights(wire::lights_of(lights)?)?;
            let set = wire::camera_of(camera).and_then(|camera| state.renderer.set_camera(camera));
            if set.is_err() {
                state.renderer.set_lights(before)?;
            }
            set?;
            state.renderer.rekey();
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

    /// What the measured exposure multiplied radiance with when the scene was shown first; 0 while that is not known.
    #[wasm_bindgen(getter)]
    pub fn measured(&self) -> f32 {
        self.callbacks.key.get()
    }

    /// Takes such an exposure over instead of measuring one, as after the loss of a device; 0 changes nothing.
    #[wasm_bindgen(setter)]
    pub fn set_measured(&self, key: f32) -> Result<(), JsValue> {
        self.callbacks.key.set(key);
        self.change(|state| {
            state.renderer.set_key(key);
            Ok(())
        })
    }

    /// Whether the exposure is measured; else radiance 1 is white at 0 stops.
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

    /// How radiance becomes display values: `"neutral"` or `"agx"`.
    #[wasm_bindgen(getter, js_name = toneMapping)]
    pub fn tone_mapping(&self) -> String {
        self.state.borrow().renderer.tone_mapping().name().into()
    }

    /// Sets how radiance becomes display values.
    #[wasm_bindgen(setter, js_name = toneMapping)]
    pub fn set_tone_mapping(&self, name: &str) -> Result<(), JsValue> {
        self.change(|state| {
            state.renderer.set_tone_mapping(ToneMapping::parse(name)?);
            Ok(())
        })
    }

    /// `"all"`, `"direct"` or `"indirect"`.
    #[wasm_bindgen(getter)]
    pub fn mode(&self) -> String {
        self.state.borrow().renderer.mode().name().into()
    }

    /// Sets which light is shown.
    #[wasm_bindgen(setter)]
    pub fn set_mode(&self, mode: &str) -> Result<(), JsValue> {
        self.change(|state| {
            state.renderer.set_mode(Mode::parse(mode)?);
            Ok(())
        })
    }

    /// `"none"`, `"points"` or `"levels"`.
    #[wasm_bindgen(getter)]
    pub fn overlay(&self) -> String {
        self.state.borrow().renderer.overlay().name().into()
    }

    /// Sets what is drawn over the picture.
    #[wasm_bindgen(setter)]
    pub fn set_overlay(&self, overlay: &str) -> Result<(), JsValue> {
        self.change(|state| {
            state.renderer.set_overlay(Overlay::parse(overlay)?);
            Ok(())
        })
    }

    /// Whether the lights' handles are drawn and can be dragged; true at first.
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

    /// The graphics adapter's name.
    pub fn adapter(&self) -> String {
        self.state.borrow().renderer.gpu().adapter.clone()
    }

    /// The scene's name.
    #[wasm_bindgen(js_name = sceneName)]
    pub fn scene_name(&self) -> String {
        self.state.borrow().renderer.scene().map_or(String::new(), |scene| scene.meta.scene_name.clone())
    }

    /// Counts, bytes on the GPU and, where the device can time them, microseconds per pass: JSON, whole numbers.
    pub fn stats(&self) -> String {
        self.state.borrow_mut().renderer.stats().json()
    }

    /// The scene's own animations of lights: a list of `{ name, duration, tracks }`, times and values in typed arrays.
    #[wasm_bindgen(unchecked_return_type = "Animation[]")]
    pub fn animations(&self) -> js_sys::Array {
        let state = self.state.borrow();
        let animations = state.renderer.scene().map_or(&[][..], |scene| &scene.meta.animations);
        animations.iter().map(animation).collect()
    }

    /// How the bounced light of the last picture was looked up: pixels, those that looked functions up, functions looked
    /// at, kernels evaluated.
    #[wasm_bindgen(unchecked_return_type = "Promise<Float64Array>")]
    pub fn counts(&self) -> js_sys::Promise {
        let begun = self.state.borrow().renderer.read_counts();
        promise(async move {
            let (pixels, begun) = begun?;
            let counts = Counts::new(pixels, &begun.wait().await?);
            let counts = [counts.pixels, counts.rows, counts.looked_at, counts.evaluated].map(|n| n as f64);
            Ok(js_sys::Float64Array::from(&counts[..]))
        })
    }

    /// The indirect light of the present camera and lights: linear radiance albedo/π·E, RGBA 32-bit
    /// floats, rows from the top; alpha is the share of the pixel that a surface covers.
    #[wasm_bindgen(js_name = readIndirect, unchecked_return_type = "Promise<Float32Array>")]
    pub fn read_indirect(&self, width: u32, height: u32) -> js_sys::Promise {
        let begun = self.read(|renderer| renderer.read_indirect(width, height));
        promise(async move {
            let bytes = begun?.wait().await?;
            let floats: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes);
            Ok(js_sys::Float32Array::from(floats.as_slice()))
        })
    }

    /// The tone-mapped picture without handles: RGBA bytes, rows from the top.
    #[wasm_bindgen(js_name = readPixels, unchecked_return_type = "Promise<Uint8Array>")]
    pub fn read_pixels(&self, width: u32, height: u32) -> js_sys::Promise {
        let begun = self.read(|renderer| renderer.read_pixels(width, height));
        promise(async move {
            let bytes = begun?.wait().await?;
            Ok(js_sys::Uint8Array::from(bytes.as_slice()))
        })
    }

    /// Frees the viewer and the GPU's memory that it took; with the page's last viewer goes the device.
    pub fn dispose(self) {}
}
