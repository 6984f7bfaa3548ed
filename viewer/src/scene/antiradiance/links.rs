//! Links on the GPU: static links between what stands, and moving links, replaced after each motion.
//!
//! Both are in the same buffers, those of what stands first: a shader binds eight buffers at most.

use super::{AntiradiancePipelines, BinsDispatch, BinsUniform, STORAGE, Uniforms};
use crate::error::ViewerError;
use crate::gpu::bindings::{buffer, empty_buffer, group, part};
use crate::gpu::scope::Scope;
use crate::gpu::{Gpu, MAX_BINDING};
use rebounce_shared::antiradiance::cells::CellTransfer;
use rebounce_shared::antiradiance::{Cells, Waves};
use wgpu::BufferUsages;

/// Bytes of a link.
const LINK: u64 = size_of::<CellTransfer>() as u64;

/// The given number of bytes, if a binding can hold it.
pub(super) fn fitting(bytes: u64) -> Result<u64, ViewerError> {
    if bytes > MAX_BINDING {
        return Err(ViewerError::TooManyElements { bytes, limit: MAX_BINDING });
    }
    Ok(bytes)
}

/// What sweeps of both parts bind.
pub(super) struct Shared {
    pub constants: BinsUniform,
    pub elements: wgpu::Buffer,
    pub ways: wgpu::Buffer,
    pub radiance: wgpu::Buffer,
    pub incident: wgpu::Buffer,
    pub exitant: wgpu::Buffer,
}

/// Links by receiver and bin.
pub(super) struct GpuLinks {
    pub offsets: wgpu::Buffer,
    pub transfers: wgpu::Buffer,
    /// Number of links between what stands.
    still: u64,
    /// Number of cells, if something moves.
    moving: Option<u64>,
    own: Scope,
    /// Of `transfers`, which may become too small.
    room: Scope,
}

impl GpuLinks {
    /// Uploads both.
    pub fn new(gpu: &Gpu, still: &Cells, moving: &Cells) -> Result<Self, ViewerError> {
        let own = Scope::new(gpu);
        let offsets = empty_buffer(
            &own,
            "offsets",
            STORAGE,
            size_of_val(&still.offsets[..]) as u64 + size_of_val(&moving.offsets[..]) as u64,
        );
        gpu.queue.write_buffer(&offsets, 0, bytemuck::cast_slice(&still.offsets));
        let count = still.transfers.len() as u64;
        let (transfers, room) = with_room(gpu, count, moving.transfers.len() as u64)?;
        gpu.queue.write_buffer(&transfers, 0, bytemuck::cast_slice(&still.transfers));
        let cells = (still.offsets.len() - 1) as u64;
        let moving_cells = (!moving.offsets.is_empty()).then_some(cells);
        let out = Self { offsets, transfers, still: count, moving: moving_cells, own, room };
        out.write(gpu, moving);
        Ok(out)
    }

    /// First offset of the links of what moves; 0 where nothing does.
    pub fn moving(&self) -> u32 {
        self.moving.map_or(0, |cells| cells as u32 + 1)
    }

    /// Takes over other links of what moves. Returns whether `transfers` is another buffer.
    pub fn follow(&mut self, gpu: &Gpu, moving: &Cells) -> Result<bool, ViewerError> {
        let needed = LINK * (self.still + moving.transfers.len() as u64);
        let is_outgrown = needed > self.transfers.size();
        if is_outgrown {
            let (transfers, room) = with_room(gpu, self.still, moving.transfers.len() as u64)?;
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(&self.transfers, 0, &transfers, 0, LINK * self.still);
            gpu.queue.submit([encoder.finish()]);
            (self.transfers, self.room) = (transfers, room);
        }
        self.write(gpu, moving);
        Ok(is_outgrown)
    }

    fn write(&self, gpu: &Gpu, moving: &Cells) {
        let after = |offset: &u32| offset + self.still as u32;
        let offsets: Vec<u32> = moving.offsets.iter().map(after).collect();
        gpu.queue.write_buffer(&self.offsets, 4 * u64::from(self.moving()), bytemuck::cast_slice(&offsets));
        gpu.queue.write_buffer(&self.transfers, LINK * self.still, bytemuck::cast_slice(&moving.transfers));
    }

    /// Bind group of a sweep over these items.
    pub fn sweep(
        &self,
        gpu: &Gpu,
        pipelines: &AntiradiancePipelines,
        shared: &Shared,
        (items, uniforms): (&wgpu::Buffer, &wgpu::Buffer),
    ) -> wgpu::BindGroup {
        let Shared { elements, ways, radiance, incident, exitant, .. } = shared;
        let (offsets, transfers) = (&self.offsets, &self.transfers);
        let mut resources = vec![part(uniforms, size_of::<BinsUniform>() as u64)];
        let all = [elements, ways, offsets, transfers, items, radiance, incident, exitant];
        resources.extend(all.map(|buffer| buffer.as_entire_binding()));
        group(gpu, "sweep bins", &pipelines.sweep.0, &resources)
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes() + self.room.bytes()
    }
}

/// A buffer for `still` static and `moving` links, with room for half as many more moving ones.
fn with_room(gpu: &Gpu, still: u64, moving: u64) -> Result<(wgpu::Buffer, Scope), ViewerError> {
    let room = Scope::new(gpu);
    let least = fitting(LINK * (still + moving))?;
    let bytes = (least + LINK * moving / 2).min(MAX_BINDING);
    Ok((empty_buffer(&room, "transfers", STORAGE, bytes), room))
}

/// Waves of what moves.
pub(super) struct MovingWaves {
    pub bound: wgpu::BindGroup,
    pub waves: Vec<BinsDispatch>,
    own: Scope,
}

impl MovingWaves {
    /// Uploads their items; `None` without any.
    pub fn new(
        gpu: &Gpu,
        pipelines: &AntiradiancePipelines,
        (links, shared): (&GpuLinks, &Shared),
        waves: &Waves,
    ) -> Option<Self> {
        if waves.count() == 0 {
            return None;
        }
        let own = Scope::new(gpu);
        let mut uniforms = Uniforms::default();
        let dispatches = uniforms.waves(waves, shared.constants);
        let uniforms = buffer(&own, "moving passes", BufferUsages::UNIFORM, &uniforms.0);
        let items = buffer(&own, "moving items", STORAGE, bytemuck::cast_slice(&waves.items));
        let bound = links.sweep(gpu, pipelines, shared, (&items, &uniforms));
        Some(Self { bound, waves: dispatches, own })
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes()
    }
}
