//! Bounced light in the air, in a grid of probes.

use crate::device::Shared;
use glam::Vec3;
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::probes::caster::Caster;
use rebounce_viewer::probes::fill::GpuProbes;
use rebounce_viewer::probes::grid::Grid;
use rebounce_viewer::probes::hits::BATCH;
use rebounce_viewer::probes::rows::{Input, Rows};
use rebounce_viewer::readback::Readback;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use rebounce_viewer::wasm::page::{js_error, promise};
use std::cell::RefCell;
use std::rc::{Rc, Weak};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;

/// Milliseconds of work between pauses.
const SLICE_MS: f64 = 8.0;

/// Probes of a file.
#[wasm_bindgen]
pub struct Probes {
    shared: Rc<Shared>,
    gpu: Gpu,
    renderer: Weak<RefCell<Renderer>>,
    scene: Rc<GpuScene>,
    input: Rc<Input>,
    probes: Rc<RefCell<GpuProbes>>,
    /// Planes and moves, once they are known.
    rows: Rc<RefCell<Rows>>,
}

/// Pauses once a slice of work is done.
struct Pacer<'a> {
    pause: &'a js_sys::Function,
    since: f64,
}

impl Pacer<'_> {
    async fn rest(&mut self) {
        if js_sys::Date::now() - self.since < SLICE_MS {
            return;
        }
        if let Ok(promise) = self.pause.call0(&JsValue::NULL) {
            // A pause that fails is none.
            let _ = JsFuture::from(js_sys::Promise::resolve(&promise)).await;
        }
        self.since = js_sys::Date::now();
    }
}

impl Probes {
    /// Probes over the scene, without light yet.
    pub(crate) fn new(
        gpu: &Gpu,
        shared: Rc<Shared>,
        renderer: Weak<RefCell<Renderer>>,
        scene: Rc<GpuScene>,
        input: Rc<Input>,
        spacing: f32,
    ) -> Self {
        let bounds = [scene.meta.bounds_min, scene.meta.bounds_max].map(Vec3::from);
        let grid = Grid::covering(bounds, (spacing > 0.0).then_some(spacing));
        let probes = gpu.watch(|| shared.probes().1.allocate(gpu, &scene, grid));
        let (probes, rows) = (Rc::new(RefCell::new(probes)), Rc::default());
        Self { gpu: gpu.clone(), shared, renderer, scene, input, probes, rows }
    }
}

#[wasm_bindgen]
impl Probes {
    /// Finds what senders give to the probes. `pause` returns a promise, which is waited for between parts of the work of
    /// some milliseconds. Resolves with false for a scene with too many triangles.
    #[wasm_bindgen(unchecked_return_type = "Promise<boolean>")]
    pub fn build(&self, pause: js_sys::Function) -> js_sys::Promise {
        let (gpu, shared, scene, input) =
            (self.gpu.clone(), self.shared.clone(), self.scene.clone(), self.input.clone());
        let (probes, known) = (Rc::downgrade(&self.probes), self.rows.clone());
        let grid = self.probes.borrow().grid;
        promise(async move {
            let Some(caster) = Caster::new(&scene.upload.triangles) else { return Ok(JsValue::FALSE) };
            let mut rows = Rows::default();
            let mut pacer = Pacer { pause: &pause, since: js_sys::Date::now() };
            for first in (0..grid.len()).step_by(BATCH) {
                let mut rays = Vec::with_capacity(BATCH);
                for probe in first..grid.len().min(first + BATCH) {
                    rays.push(input.rays(&caster, &grid, probe));
                    pacer.rest().await;
                }
                let hits: Vec<_> = rays.iter().map(|rays| &rays.hits[..]).collect();
                let surfaces = shared.probes().0.shades(&gpu, &scene.materials, &hits).await?;
                for (row, rays) in rays.iter().enumerate() {
                    input.append(&mut rows, &grid, first + row, rays, |ray| surfaces.at(row, ray));
                    pacer.rest().await;
                }
                // Without a holder they were disposed meanwhile.
                if probes.strong_count() == 0 {
                    return Ok(JsValue::FALSE);
                }
            }
            let Some(probes) = probes.upgrade() else { return Ok(JsValue::FALSE) };
            gpu.watch(|| shared.probes().1.upload(&gpu, &scene, &mut probes.borrow_mut(), &rows));
            // The GPU has the rest.
            *known.borrow_mut() = Rows { entries: Vec::new(), offsets: Vec::new(), ..rows };
            Ok(JsValue::TRUE)
        })
    }

    /// First place, local space; spacing; counts along x, y and z.
    pub fn grid(&self) -> Vec<f32> {
        let Grid { first, spacing, counts } = self.probes.borrow().grid;
        let mut out = first.to_array().to_vec();
        out.push(spacing);
        out.extend(counts.map(|count| count as f32));
        out
    }

    /// After a change of the light: computes the radiance of every probe.
    pub fn fill(&self) -> Result<(), JsValue> {
        let Some(renderer) = self.renderer.upgrade() else { return Ok(()) };
        let strengths = renderer.borrow().source_strengths();
        self.gpu.check().map_err(|error| js_error(&error))?;
        self.gpu.watch(|| {
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            self.shared.probes().1.fill(&self.gpu, &mut encoder, &self.probes.borrow(), &strengths);
            self.gpu.queue.submit([encoder.finish()]);
        });
        Ok(())
    }

    /// The browser's textures: radiance, planes, moves.
    pub fn textures(&self) -> Vec<JsValue> {
        let probes = self.probes.borrow();
        let textures = [&probes.radiance_texture, &probes.planes, &probes.moved];
        textures.iter().map(|texture| crate::object(texture.as_webgpu())).collect()
    }

    /// Reads the radiance: RGB and a zero by probe and coefficient.
    #[wasm_bindgen(unchecked_return_type = "Promise<Float32Array>")]
    pub fn read(&self) -> js_sys::Promise {
        let begun = self.gpu.watch(|| Readback::buffer(&self.gpu, &self.probes.borrow().radiance));
        promise(async move {
            let floats: Vec<f32> = bytemuck::pod_collect_to_vec(&begun.wait().await?);
            Ok(js_sys::Float32Array::from(&floats[..]))
        })
    }

    /// Planes: unit normal and distance by probe and texel.
    pub fn planes(&self) -> Vec<f32> {
        self.rows.borrow().planes.as_flattened().to_vec()
    }

    /// Moves: vector, and 1 in free space, by probe.
    pub fn moves(&self) -> Vec<f32> {
        self.rows.borrow().moved.as_flattened().to_vec()
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> f64 {
        self.probes.borrow().bytes() as f64
    }
}
