//! A .rbn file and its lights, relit on the GPU.

use crate::device::{Device, Shared};
use crate::probes::Probes;
use crate::view::View;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
use rebounce_viewer::ViewerError;
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::probes::rows::Input;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use rebounce_viewer::wasm::page::{js_error, promise};
use rebounce_viewer::wasm::wire;
use std::cell::RefCell;
use std::rc::Rc;
use wasm_bindgen::prelude::*;

/// Bounced light of a file under lights that change.
#[wasm_bindgen]
pub struct BouncedLight {
    shared: Rc<Shared>,
    /// The device, with errors of this light alone.
    gpu: Gpu,
    renderer: Rc<RefCell<Renderer>>,
    /// What probes are made from, where they are wanted.
    input: Rc<RefCell<Option<Rc<Input>>>>,
}

impl BouncedLight {
    /// Runs `work` on the renderer; throws what the device has refused so far.
    fn run<T>(&self, work: impl FnOnce(&mut Renderer) -> Result<T, ViewerError>) -> Result<T, JsValue> {
        let done = self.gpu.check().and_then(|()| self.gpu.watch(|| work(&mut self.renderer.borrow_mut())));
        done.map_err(|error| js_error(&error))
    }

    fn scene<T>(&self, read: impl FnOnce(&GpuScene) -> T) -> Result<T, JsValue> {
        let renderer = self.renderer.borrow();
        renderer.scene().map(|scene| read(scene)).ok_or_else(|| js_error(&ViewerError::NoScene))
    }
}

#[wasm_bindgen]
impl BouncedLight {
    /// Without a file yet.
    #[wasm_bindgen(constructor)]
    pub fn new(device: &Device) -> Self {
        let shared = device.shared.clone();
        let gpu = shared.gpu.share();
        let renderer = gpu.watch(|| Renderer::with(gpu.clone(), shared.pipelines.clone()));
        Self { renderer: Rc::new(RefCell::new(renderer)), gpu, shared, input: Rc::default() }
    }

    /// Loads the bytes of a .rbn file, with its lights; rejects as the viewer's `load` does. `probes`: they will be wanted.
    #[wasm_bindgen(unchecked_return_type = "Promise<void>")]
    pub fn load(&self, bytes: js_sys::Uint8Array, probes: bool) -> js_sys::Promise {
        let (renderer, gpu, shared) = (Rc::downgrade(&self.renderer), self.gpu.clone(), self.shared.clone());
        let input = self.input.clone();
        promise(async move {
            let scene = BakedScene::from_bytes(&bytes.to_vec())?;
            drop(bytes);
            *input.borrow_mut() = probes.then(|| Rc::new(Input::of(&scene)));
            let loaded = GpuScene::upload(&gpu, shared.pipelines.loaders(), scene).await?;
            // Without a holder it was disposed meanwhile.
            if let Some(renderer) = renderer.upgrade() {
                renderer.borrow_mut().install(loaded)?;
            }
            Ok(JsValue::UNDEFINED)
        })
    }

    /// The lights, those of the file after loading: lists of numbers of `rebounce_viewer::wasm::wire`.
    pub fn lights(&self) -> Vec<f64> {
        wire::light_numbers(self.renderer.borrow().lights())
    }

    /// Names of the file's own lights, then of its cameras, zero-terminated; empty if none has a name.
    pub fn names(&self) -> Result<String, JsValue> {
        self.scene(|scene| scene.meta.shown.names.clone())
    }

    /// Sets the lights: lists of numbers of `rebounce_viewer::wasm::wire`.
    #[wasm_bindgen(js_name = setLights)]
    pub fn set_lights(&self, lights: &[f64]) -> Result<(), JsValue> {
        self.run(|renderer| renderer.set_lights(wire::lights_of(lights)?))
    }

    /// Sets the picture of environment lights: [`wire::environment_of`]. Without texels, the file's own picture.
    #[wasm_bindgen(js_name = setEnvironment)]
    pub fn set_environment(&self, width: u32, scale: f32, texels: Vec<u32>) -> Result<(), JsValue> {
        self.run(|renderer| renderer.set_environment(wire::environment_of(width, scale, texels)?))
    }

    /// Relights after changes of the lights; true if the bounced light changed.
    pub fn relight(&self) -> Result<bool, JsValue> {
        self.run(|renderer| Ok(renderer.relight()))
    }

    /// World-space place of the local origin: places for [`View`]s are relative to it.
    pub fn origin(&self) -> Result<Vec<f64>, JsValue> {
        self.scene(|scene| scene.meta.origin.to_vec())
    }

    /// Minimum and maximum corner of the scene, local space.
    pub fn bounds(&self) -> Result<Vec<f32>, JsValue> {
        self.scene(|scene| [scene.meta.bounds_min, scene.meta.bounds_max].concat())
    }

    /// Whether materials have normal maps: the irradiance then has tilts.
    #[wasm_bindgen(js_name = isBumpy)]
    pub fn is_bumpy(&self) -> Result<bool, JsValue> {
        self.scene(|scene| scene.meta.is_bumpy())
    }

    /// Share of these places that lie on surfaces of the file, within `reach`: x, y, z of each, local space, a little in
    /// front of a surface if it is one-sided.
    #[wasm_bindgen(js_name = shareOn)]
    pub fn share_on(&self, places: &[f32], reach: f32) -> Result<f64, JsValue> {
        self.scene(|scene| {
            let places = places.as_chunks::<3>().0;
            let triangles = &scene.upload.triangles;
            let on = places.iter().filter(|place| triangles.nearest(Vec3::from(**place), reach).is_some());
            on.count() as f64 / places.len().max(1) as f64
        })
    }

    /// A view of this size, whose places `positions` holds: a `GPUTexture` of the device, rgba32float, in the form of
    /// place_given.wgsl. `every_pixel`: without interpolation between neighbours.
    pub fn view(
        &self,
        positions: JsValue,
        width: u32,
        height: u32,
        every_pixel: bool,
    ) -> Result<View, JsValue> {
        let renderer = self.renderer.borrow();
        let scene = renderer.scene().ok_or_else(|| js_error(&ViewerError::NoScene))?;
        let made = View::new(self.shared.clone(), &self.gpu, scene, positions, [width, height], every_pixel);
        self.gpu.check().map_err(|error| js_error(&error))?;
        Ok(made)
    }

    /// Makes probes, without light until they are built: `spacing` scene units apart, or as far as suits the scene for 0.
    /// Once a file, and only if they were asked for.
    pub fn probes(&self, spacing: f32) -> Option<Probes> {
        let (scene, input) = (self.renderer.borrow().scene().cloned()?, self.input.borrow_mut().take()?);
        let renderer = Rc::downgrade(&self.renderer);
        Some(Probes::new(&self.gpu, self.shared.clone(), renderer, scene, input, spacing))
    }

    /// Counts, bytes on the GPU and times: JSON, integers.
    pub fn stats(&self) -> String {
        self.renderer.borrow_mut().stats().json()
    }
}
