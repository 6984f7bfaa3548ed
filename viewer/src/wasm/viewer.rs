//! The browser's class `Viewer`: the renderer on a canvas. Here: construction, loading, frames.

use super::callbacks::Callbacks;
use super::page::{self, js_error, promise};
use super::shared::SharedDevice;
use crate::controls::Controls;
use crate::error::ViewerError;
use crate::gpu::LIMITS;
use crate::gpu::browser::{self, Context};
use crate::passes::composite::FIRST_KEY;
use crate::renderer::Renderer;
use crate::renderer::pace::{Pace, Work};
use crate::scene::GpuScene;
use rebounce_shared::baked::BakedScene;
use std::cell::RefCell;
use std::rc::Rc;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::spawn_local;
use web_sys::HtmlCanvasElement;

/// Milliseconds of a frame that computes a slice of bounced light.
#[cfg(feature = "radiosity")]
const SOLVING_BUDGET: f64 = 12.0;

/// A view of a baked scene on a canvas.
#[wasm_bindgen]
pub struct Viewer {
    pub(super) state: Rc<RefCell<ViewerState>>,
    pub(super) callbacks: Rc<Callbacks>,
}

/// A viewer, behind its handle.
pub(super) struct ViewerState {
    pace: Pace,
    pub(super) renderer: Renderer,
    pub(super) controls: Controls,
    canvas: HtmlCanvasElement,
    context: Context,
    /// Width and height of the canvas's pictures, pixels.
    pub(super) size: [u32; 2],
    configured: bool,
    _shared: Rc<SharedDevice>,
}

impl Drop for ViewerState {
    /// Detaches the device from the canvas, which may outlive the viewer.
    fn drop(&mut self) {
        self.context.unconfigure();
    }
}

impl ViewerState {
    /// Texture for the next picture; `None` while the canvas has no texture.
    fn texture(&mut self) -> Option<wgpu::Texture> {
        let ([width, height], shared) = (self.size, &self._shared);
        if !self.configured {
            self.canvas.set_width(width);
            self.canvas.set_height(height);
            let device: &JsValue = browser::device(&shared.gpu.device);
            let members = [
                ("device", device.clone()),
                ("format", if shared.is_bgra { "bgra8unorm" } else { "rgba8unorm" }.into()),
                ("alphaMode", "opaque".into()),
            ];
            self.context.configure(&page::object(members)).ok()?;
            self.configured = true;
        }
        let texture = self.context.texture().ok()?;
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        Some(browser::wrapped(&shared.gpu.device, texture, shared.format(), usage, self.size))
    }
}

impl Viewer {
    /// Runs `work` on the state, then requests a frame from the page.
    pub(super) fn change<T>(
        &self,
        work: impl FnOnce(&mut ViewerState) -> Result<T, ViewerError>,
    ) -> Result<T, JsValue> {
        let result = work(&mut self.state.borrow_mut());
        self.callbacks.changed();
        result.map_err(|e| js_error(&e))
    }
}

#[wasm_bindgen]
impl Viewer {
    /// Creates a viewer that draws on `canvas`. Rejects with `no-webgpu`, `no-adapter` or `no-device`.
    #[wasm_bindgen(unchecked_return_type = "Promise<Viewer>")]
    pub fn create(canvas: HtmlCanvasElement) -> js_sys::Promise {
        promise(async move {
            let shared = SharedDevice::get().await?;
            let size = [canvas.width().max(1), canvas.height().max(1)];
            let context = canvas.get_context("webgpu").ok().flatten();
            let context = context.ok_or_else(|| ViewerError::NoDevice("the canvas has no context".into()))?;
            let callbacks = Rc::new(Callbacks::default());
            shared.watch(&callbacks);
            // Separate errors, on the shared device.
            let gpu = shared.gpu.share();
            let pace = Pace::default();
            if gpu.software {
                pace.expect_slow();
            }
            let state = ViewerState {
                pace,
                renderer: gpu.watch(|| Renderer::with(gpu.clone(), shared.pipelines.clone())),
                controls: Controls::default(),
                canvas,
                context: context.unchecked_into(),
                size,
                configured: false,
                _shared: shared,
            };
            Ok(Viewer { state: Rc::new(RefCell::new(state)), callbacks })
        })
    }

    /// Loads the bytes of a .rbn file, with its first camera and its lights. The previous scene stays until the new
    /// scene is ready. Rejects with `not-rbn`, `truncated`, `corrupt`, `newer-version`, `older-version`,
    /// `too-large`, `texture` or `device-lost`.
    #[wasm_bindgen(unchecked_return_type = "Promise<void>")]
    pub fn load(&self, bytes: js_sys::Uint8Array) -> js_sys::Promise {
        // Weak: if the viewer is disposed meanwhile, the loaded data is dropped with its device.
        let (held, callbacks) = (Rc::downgrade(&self.state), self.callbacks.clone());
        let gpu = self.state.borrow().renderer.gpu().clone();
        let pipelines = self.state.borrow().renderer.pipelines();
        promise(async move {
            let scene = BakedScene::from_bytes(&bytes.to_vec())?;
            drop(bytes);
            let loaded = GpuScene::upload(&gpu, pipelines.loaders(), scene).await?;
            let state = held.upgrade().filter(|_| !callbacks.is_lost.get());
            let Some(state) = state else { return Err(ViewerError::DeviceLost("while loading".into())) };
            {
                let mut state = state.borrow_mut();
                let state = &mut *state;
                state.renderer.install(loaded)?;
                callbacks.key.set(0.0);
                state.controls.reset();
                state.controls.selected = None;
            }
            callbacks.changed();
            Ok(JsValue::UNDEFINED)
        })
    }

    /// Sets the size of the canvas's drawing buffer, device pixels. Clamped to the GPU's limits.
    pub fn resize(&self, width: u32, height: u32) {
        {
            let mut state = self.state.borrow_mut();
            let size = [width, height].map(|length| length.clamp(1, LIMITS.max_texture_dimension_2d));
            if state.size == size && state.configured {
                return;
            }
            state.size = size;
            state.configured = false;
            state.renderer.invalidate();
        }
        self.callbacks.changed();
    }

    /// Draws if the view changed since the last call and the GPU has finished the previous frame. True if motion,
    /// or a change not yet drawn, needs further frames.
    #[wasm_bindgen(js_name = frame)]
    pub fn frame(&self, now_ms: f64) -> Result<bool, JsValue> {
        if self.callbacks.is_lost.get() {
            return Ok(false);
        }
        let mut state = self.state.borrow_mut();
        let state = &mut *state;
        let gpu = state.renderer.gpu().clone();
        gpu.check().map_err(|e| js_error(&e))?;
        let mut stage = state.renderer.stage(state.size);
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
        state.renderer.want_key(self.callbacks.key.get() <= 0.0);
        let Some(texture) = state.texture() else {
            state.configured = false;
            return Ok(true);
        };
        let view = texture.create_view(&Default::default());
        let [width, height] = state.size;
        let drawn = gpu.watch(|| state.renderer.draw(&view, texture.format(), width, height));
        let (done, start) = (state.pace.begin(work), js_sys::Date::now());
        let finished = browser::queue(&gpu.queue).done();
        let (errors, callbacks) = (gpu.clone(), Rc::downgrade(&self.callbacks));
        let (untimed, held) = (state.renderer.untimed(), Rc::downgrade(&self.state));
        spawn_local(async move {
            let _ = finished.await;
            let taken = js_sys::Date::now() - start;
            done(taken);
            #[cfg(feature = "radiosity")]
            if let Some(state) = held.upgrade() {
                state.borrow_mut().renderer.add_solving_time(taken, SOLVING_BUDGET);
            }
            if let (Some(way), Some(state)) = (untimed, held.upgrade()) {
                state.borrow_mut().renderer.add_time(way, taken);
            }
            // Errors are known by now; the next frame reports them, even if nothing else needs a frame.
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

    /// Called without arguments when input or a setter needs a frame.
    #[wasm_bindgen(setter)]
    pub fn set_onchange(&self, callback: Option<js_sys::Function>) {
        *self.callbacks.change.borrow_mut() = callback;
    }

    /// Called with a message when the GPU device is lost.
    #[wasm_bindgen(setter)]
    pub fn set_ondevicelost(&self, callback: Option<js_sys::Function>) {
        *self.callbacks.lost.borrow_mut() = callback;
    }

    /// Frees the viewer and its GPU memory; the device is destroyed with the page's last viewer.
    pub fn dispose(self) {}
}
