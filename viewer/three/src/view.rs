//! Bounced light at the pixels of a picture of another renderer.

use crate::device::Shared;
use rebounce_viewer::gpu::{Gpu, wrapped};
use rebounce_viewer::passes::display::given::{self, GivenTarget};
use rebounce_viewer::scene::GpuScene;
use rebounce_viewer::view::Frame;
use rebounce_viewer::wasm::page::js_error;
use std::rc::Rc;
use wasm_bindgen::prelude::*;

/// Numbers of a camera: eye, right, up, forward, each a vector; right and up to the picture's edges at distance 1.
const CAMERA: usize = 12;

/// Irradiance of one picture.
#[wasm_bindgen]
pub struct View {
    shared: Rc<Shared>,
    gpu: Gpu,
    target: GivenTarget,
    open_reach: f32,
}

impl View {
    pub(crate) fn new(
        shared: Rc<Shared>,
        gpu: &Gpu,
        scene: &GpuScene,
        positions: JsValue,
        size: [u32; 2],
        every_pixel: bool,
    ) -> Self {
        let gpu = gpu.clone();
        let target = gpu.watch(|| {
            let usage = wgpu::TextureUsages::TEXTURE_BINDING;
            let positions = wrapped(&gpu.device, positions.unchecked_into(), given::FORMAT, usage, size);
            let positions = positions.create_view(&Default::default());
            shared.given.target(&gpu, scene, &positions, size, every_pixel)
        });
        Self { shared, target, open_reach: scene.open_reach, gpu }
    }
}

#[wasm_bindgen]
impl View {
    /// The browser's `GPUTexture` of irradiance: rgba32float.
    pub fn texture(&self) -> JsValue {
        crate::object(self.target.irradiance.as_webgpu())
    }

    /// After a change of the positions: finds the functions of all pixels. `camera`: eye, right, up and forward in local
    /// space, or nothing for a picture without openness.
    pub fn find(&self, camera: &[f32]) -> Result<(), JsValue> {
        let three = |at: usize| [camera[at], camera[at + 1], camera[at + 2]];
        let mut frame = Frame { near: 1.0, ..bytemuck::Zeroable::zeroed() };
        if camera.len() == CAMERA {
            frame = Frame {
                eye: three(0),
                right: three(3),
                up: three(6),
                forward: three(9),
                open_reach: self.open_reach,
                ..frame
            };
        }
        self.encode(|encoder| self.shared.given.find(&self.gpu, encoder, &self.target, &frame))
    }

    /// After [`Self::find`], or after a change of the light: computes the irradiance of all pixels.
    pub fn gather(&self) -> Result<(), JsValue> {
        self.encode(|encoder| self.shared.given.gather(encoder, &self.target))
    }

    /// Bytes on the GPU, without the positions.
    pub fn bytes(&self) -> f64 {
        self.target.bytes() as f64
    }

    fn encode(&self, work: impl FnOnce(&mut wgpu::CommandEncoder)) -> Result<(), JsValue> {
        self.gpu.check().map_err(|error| js_error(&error))?;
        self.gpu.watch(|| {
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            work(&mut encoder);
            self.gpu.queue.submit([encoder.finish()]);
        });
        Ok(())
    }
}
