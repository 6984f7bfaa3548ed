//! Results of the class [`Viewer`]: pictures, counts, statistics, animations.

use super::page::promise;
#[cfg(not(feature = "radiosity"))]
use super::page::{animation, tracks};
use super::viewer::Viewer;
use super::wire;
use crate::renderer::Renderer;
use crate::renderer::stats::Counts;
use wasm_bindgen::prelude::*;

impl Viewer {
    /// Runs a reading function on the renderer.
    fn read<T>(&self, work: impl FnOnce(&mut Renderer) -> T) -> T {
        let renderer = &mut self.state.borrow_mut().renderer;
        let gpu = renderer.gpu().clone();
        gpu.watch(|| work(renderer))
    }
}

#[wasm_bindgen]
impl Viewer {
    /// The graphics adapter's name.
    pub fn adapter(&self) -> String {
        self.state.borrow().renderer.gpu().adapter.clone()
    }

    /// The scene's name.
    #[wasm_bindgen(js_name = sceneName)]
    pub fn scene_name(&self) -> String {
        self.state.borrow().renderer.scene().map_or(String::new(), |scene| scene.meta.scene_name.clone())
    }

    /// Names of the file's own lights, then of its cameras, zero-terminated; empty if no light or camera has a
    /// name.
    pub fn names(&self) -> String {
        self.state.borrow().renderer.scene().map_or(String::new(), |scene| scene.meta.shown.names.clone())
    }

    /// The file's cameras as concatenated lists of numbers: see [`crate::wasm::wire`].
    pub fn cameras(&self) -> Vec<f64> {
        let mut out = Vec::new();
        for camera in self.state.borrow().renderer.scene().map_or(&[][..], |scene| &scene.meta.cameras) {
            out.extend(wire::camera_numbers(camera));
        }
        out
    }

    /// Way from functions to pixels of the last picture: `"lookup"` or `"splat"`.
    pub fn displayed(&self) -> String {
        self.state.borrow().renderer.displayed().into()
    }

    /// Counts, bytes on the GPU and, if the device has timestamp queries, microseconds per pass: JSON, integers.
    pub fn stats(&self) -> String {
        self.state.borrow_mut().renderer.stats().json()
    }

    /// The scene's own animations of lights and nodes: a list of `{ name, duration, tracks }`, times and values in typed
    /// arrays.
    #[wasm_bindgen(unchecked_return_type = "Animation[]")]
    pub fn animations(&self) -> js_sys::Array {
        let state = self.state.borrow();
        let animations = state.renderer.scene().map_or(&[][..], |scene| &scene.meta.animations);
        #[cfg(feature = "radiosity")]
        let animations = super::nodes::with_nodes(
            animations,
            state.renderer.node_animations(),
            state.renderer.rig_animations(),
        );
        #[cfg(not(feature = "radiosity"))]
        let animations =
            animations.iter().map(|own| animation(&own.name, own.duration, tracks(own))).collect();
        animations
    }

    /// Work counts of the last picture's bounced light: pixels, pixels with a lookup, functions tested, kernels
    /// evaluated. For splatting: quads instead of functions tested, and no kernels.
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
}
