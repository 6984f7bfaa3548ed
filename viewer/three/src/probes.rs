//! Bounced light in the air, in a grid of probes.

use crate::device::Shared;
use glam::Vec3;
use rebounce_viewer::ViewerError;
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
    probes: GpuProbes,
    rows: Rows,
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
    /// Finds the rows of a grid over the scene.
    pub(crate) async fn build(
        gpu: &Gpu,
        shared: Rc<Shared>,
        renderer: Weak<RefCell<Renderer>>,
        scene: Rc<GpuScene>,
        input: &Input,
        spacing: f32,
        pause: &js_sys::Function,
    ) -> Result<Option<Self>, ViewerError> {
        let bounds = [scene.meta.bounds_min, scene.meta.bounds_max].map(Vec3::from);
        let grid = Grid::covering(bounds, (spacing > 0.0).then_some(spacing));
        let Some(caster) = Caster::new(&scene.upload.triangles) else { return Ok(None) };
        let mut rows = Rows::default();
        let mut pacer = Pacer { pause, since: js_sys::Date::now() };
        for first in (0..grid.len()).step_by(BATCH) {
            let mut rays = Vec::with_capacity(BATCH);
            for probe in first..grid.len().min(first + BATCH) {
                rays.push(input.rays(&caster, &grid, probe));
                pacer.rest().await;
            }
            let hits: Vec<_> = rays.iter().map(|rays| &rays.hits[..]).collect();
            let shades = shared.probes().0.shades(gpu, &scene.materials, &hits).await?;
            for (row, rays) in rays.iter().enumerate() {
                input.append(&mut rows, &grid, first + row, rays, |ray| shades.at(row, ray));
                pacer.rest().await;
            }
        }
        let probes = gpu.watch(|| shared.probes().1.upload(gpu, &scene, grid, &rows));
        // What the textures hold is kept for reading.
        rows.entries = Vec::new();
        rows.offsets = Vec::new();
        Ok(Some(Self { gpu: gpu.clone(), shared, renderer, probes, rows }))
    }
}

#[wasm_bindgen]
impl Probes {
    /// First place, local space; spacing; counts along x, y and z.
    pub fn grid(&self) -> Vec<f32> {
        let Grid { first, spacing, counts } = self.probes.grid;
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
            self.shared.probes().1.fill(&self.gpu, &mut encoder, &self.probes, &strengths);
            self.gpu.queue.submit([encoder.finish()]);
        });
        Ok(())
    }

    /// The browser's textures: radiance, planes, moves.
    pub fn textures(&self) -> Vec<JsValue> {
        let textures = [&self.probes.radiance_texture, &self.probes.planes, &self.probes.moved];
        textures.iter().map(|texture| crate::object(texture.as_webgpu())).collect()
    }

    /// Reads the radiance: RGB and a zero by probe and coefficient.
    #[wasm_bindgen(unchecked_return_type = "Promise<Float32Array>")]
    pub fn read(&self) -> js_sys::Promise {
        let begun = self.gpu.watch(|| Readback::buffer(&self.gpu, &self.probes.radiance));
        promise(async move {
            let floats: Vec<f32> = bytemuck::pod_collect_to_vec(&begun.wait().await?);
            Ok(js_sys::Float32Array::from(&floats[..]))
        })
    }

    /// Planes: unit normal and distance by probe and texel.
    pub fn planes(&self) -> Vec<f32> {
        self.rows.planes.as_flattened().to_vec()
    }

    /// Moves: vector, and 1 in free space, by probe.
    pub fn moves(&self) -> Vec<f32> {
        self.rows.moved.as_flattened().to_vec()
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> f64 {
        self.probes.bytes() as f64
    }
}
