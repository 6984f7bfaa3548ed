//! Light straight from the sky and from emissive surfaces at all points:
//! [`from_sources`](rebounce_shared::relight::from_sources).

use super::plan::Kernel;
use super::{KernelPass, kernel, slots};
use crate::gpu::Gpu;
use crate::gpu::bindings::{compute, empty_buffer};
use crate::gpu::scope::Scope;
use crate::shaders;
use rebounce_shared::environment::bins;
use rebounce_shared::glam::{Vec2, Vec3};
use rebounce_shared::rbn::sources::Sources;
use std::cell::{Cell, RefCell};
use wgpu::BufferUsages;

/// Pipelines, independent of a scene.
pub(super) struct FromSourcesPipelines {
    /// Links times strengths.
    pub(super) gather: KernelPass,
    /// Sum with other light.
    pub(super) join: KernelPass,
}

impl FromSourcesPipelines {
    /// Creates the pipelines, with `lanes` threads a row.
    pub(super) fn new(gpu: &Gpu, lanes: u32) -> Self {
        let layout = slots(gpu, "sources", 6, 1);
        let pipeline = gather(gpu, &layout, lanes);
        Self { gather: (layout, pipeline), join: kernel(gpu, "join", shaders::JOIN, 1, 1) }
    }
}

fn gather(gpu: &Gpu, layout: &wgpu::BindGroupLayout, lanes: u32) -> wgpu::ComputePipeline {
    compute(gpu, "sources", shaders::SOURCES, &[layout], &[("LANES", lanes.into())])
}

/// Bind groups of a scene.
pub(super) struct Groups {
    /// By chunk of links.
    pub(super) gather: Vec<wgpu::BindGroup>,
    /// Sums with the direct light, and with what is displayed.
    pub(super) join: [wgpu::BindGroup; 2],
}

/// Strengths of the sources of a scene, and the bind groups.
pub(super) struct FromSources {
    /// By source: RGB, and the direction that its light comes from, packed as tilt.wgsl says; 0 for none.
    strengths: wgpu::Buffer,
    sky_bins: usize,
    present: RefCell<Vec<Vec3>>,
    is_stale: Cell<bool>,
    groups: Groups,
    gather: wgpu::ComputePipeline,
    join: wgpu::ComputePipeline,
}

impl FromSources {
    /// Creates the buffers for a number of points; `groups` makes the bind groups of the points' light and the strengths.
    pub(super) fn new(
        own: &Scope,
        pipelines: &FromSourcesPipelines,
        sources: &Sources,
        points: usize,
        groups: impl FnOnce(&wgpu::Buffer, &wgpu::Buffer) -> Groups,
    ) -> Self {
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let light = empty_buffer(own, "from sources", usage, 16 * points as u64);
        let strengths = empty_buffer(own, "strengths", usage, 16 * sources.count() as u64);
        Self {
            groups: groups(&light, &strengths),
            strengths,
            sky_bins: sources.sky_bins(),
            present: RefCell::default(),
            is_stale: Cell::new(false),
            gather: pipelines.gather.1.clone(),
            join: pipelines.join.1.clone(),
        }
    }

    /// Sets the number of threads per row.
    pub(super) fn set_lanes(&mut self, gpu: &Gpu, pipelines: &FromSourcesPipelines, lanes: u32) {
        self.gather = gather(gpu, &pipelines.gather.0, lanes);
    }

    /// Sets the strengths; what follows from them is computed anew after a change.
    pub(super) fn set_strengths(&self, gpu: &Gpu, strengths: &[Vec3]) {
        if *self.present.borrow() == strengths {
            return;
        }
        let row = |(i, strength): (usize, &Vec3)| {
            let is_bin = i < self.sky_bins;
            strength.extend(if is_bin { packed(bins::direction(i, Vec2::splat(0.5))) } else { 0.0 })
        };
        let rows: Vec<_> = strengths.iter().enumerate().map(row).collect();
        gpu.queue.write_buffer(&self.strengths, 0, bytemuck::cast_slice(&rows));
        *self.present.borrow_mut() = strengths.to_vec();
        self.is_stale.set(true);
    }

    /// Whether the strengths have changed since the last call.
    pub(super) fn take_stale(&self) -> bool {
        self.is_stale.take()
    }

    /// Pipeline and bind group of a kernel; `None` where there is nothing to do.
    pub(super) fn pass(
        &self,
        kernel: Kernel,
        is_stale: bool,
    ) -> Option<(&wgpu::ComputePipeline, &wgpu::BindGroup)> {
        match kernel {
            Kernel::Sources(chunk) if is_stale => Some((&self.gather, &self.groups.gather[chunk])),
            Kernel::Join => Some((&self.join, &self.groups.join[0])),
            Kernel::Show => Some((&self.join, &self.groups.join[1])),
            _ => None,
        }
    }
}

/// Greatest component of a tilt, as in tilt.wgsl.
const STEEPEST: Vec3 = Vec3::splat(2.0);

/// As `tilt_pack` of tilt.wgsl; never 0.
pub(super) fn packed(tilt: Vec3) -> f32 {
    let steps = (tilt.clamp(-STEEPEST, STEEPEST) / STEEPEST * 127.0).round() + 128.0;
    steps.dot(Vec3::new(1.0, 256.0, 65536.0))
}
