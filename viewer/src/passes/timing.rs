//! Milliseconds per pass, where the device has timestamp queries.

use super::settings::Way;
use crate::gpu::Gpu;
use crate::gpu::oneshot::Receiver;
use crate::gpu::readback::{self, Read};
use crate::gpu::scope::Scope;
use wgpu::BufferUsages;

/// Timed passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pass {
    /// All shadow maps drawn in a frame.
    Shadows,
    /// From direct irradiance to the display basis.
    Relight,
    /// G-buffer.
    GBuffer,
    /// Candidate functions of every slot.
    Find,
    /// Light of the slots.
    Gather,
    /// Blended surfaces.
    Blended,
    /// Composite.
    Composite,
    /// Steps of antiradiance, with light from points to patches and back.
    #[cfg(feature = "antiradiance")]
    Antiradiance,
}

const PASSES: usize = if cfg!(feature = "antiradiance") { 8 } else { 7 };
const BYTES: u64 = PASSES as u64 * 16;

/// Milliseconds of each pass when it last ran; absent if it never did.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Milliseconds {
    /// Shadow maps.
    pub shadows: Option<f64>,
    /// Direct irradiance, pull, transport, push.
    pub relight: Option<f64>,
    /// G-buffer.
    pub g_buffer: Option<f64>,
    /// Search for candidate functions; only after a change of the view.
    pub find: Option<f64>,
    /// Light of the slots, from functions to pixels.
    pub gather: Option<f64>,
    /// All layers of blended surfaces; only in scenes with blended surfaces.
    pub blended: Option<f64>,
    /// Composite.
    pub composite: Option<f64>,
    /// All steps of antiradiance of a frame.
    #[cfg(feature = "antiradiance")]
    pub antiradiance: Option<f64>,
}

/// Positions of the two timestamps of a pass.
#[derive(Clone, Copy)]
pub struct Stamps<'a> {
    set: &'a wgpu::QuerySet,
    first: u32,
}

impl<'a> Stamps<'a> {
    /// Timestamp writes of a render pass; `begin` and `end` mark the first and the last pass of its kind.
    pub fn render(self, begin: bool, end: bool) -> wgpu::RenderPassTimestampWrites<'a> {
        wgpu::RenderPassTimestampWrites {
            query_set: self.set,
            beginning_of_pass_write_index: begin.then_some(self.first),
            end_of_pass_write_index: end.then_some(self.first + 1),
        }
    }

    /// Timestamp writes of a compute pass, as in [`Self::render`].
    pub fn compute(self, begin: bool, end: bool) -> wgpu::ComputePassTimestampWrites<'a> {
        wgpu::ComputePassTimestampWrites {
            query_set: self.set,
            beginning_of_pass_write_index: begin.then_some(self.first),
            end_of_pass_write_index: end.then_some(self.first + 1),
        }
    }
}

/// Queries of a single frame at a time; frames are not timed while a result is in flight.
pub struct Timing {
    _own: Scope,
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    staging: wgpu::Buffer,
    pending: Option<(Receiver<Read>, [bool; PASSES], Option<Way>)>,
    displayed: Option<(Way, f64)>,
    used: [bool; PASSES],
    last: Milliseconds,
    period_ns: f64,
}

impl Timing {
    /// `None` if the device has no timestamp queries.
    pub fn new(gpu: &Gpu) -> Option<Self> {
        if !gpu.timestamps {
            return None;
        }
        let own = Scope::new(gpu);
        let buffer = |usage| {
            own.buffer(&wgpu::BufferDescriptor {
                label: Some("timestamps"),
                size: BYTES,
                usage,
                mapped_at_creation: false,
            })
        };
        Some(Self {
            set: own.queries(&wgpu::QuerySetDescriptor {
                label: Some("timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * PASSES as u32,
            }),
            resolved: buffer(BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC),
            staging: buffer(BufferUsages::COPY_DST | BufferUsages::MAP_READ),
            pending: None,
            displayed: None,
            used: [false; PASSES],
            last: Milliseconds::default(),
            period_ns: gpu.queue.get_timestamp_period() as f64,
            _own: own,
        })
    }

    /// The timestamps of the pass about to be encoded.
    pub fn stamps(&mut self, pass: Pass) -> Option<Stamps<'_>> {
        if self.pending.is_some() {
            return None;
        }
        self.used[pass as usize] = true;
        Some(Stamps { set: &self.set, first: 2 * pass as u32 })
    }

    /// Resolves the queries. Call at the end of a frame's commands.
    pub fn resolve(&mut self, encoder: &mut wgpu::CommandEncoder) {
        if self.pending.is_none() && self.used.contains(&true) {
            for (i, _) in self.used.iter().enumerate().filter(|(_, used)| **used) {
                let first = 2 * i as u32;
                // Offsets of resolved queries must be multiples of 256, so every result is copied to its place.
                encoder.resolve_query_set(&self.set, first..first + 2, &self.resolved, 0);
                encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.staging, 16 * i as u64, 16);
            }
        }
    }

    /// Starts the readback. Call after the frame is submitted; `way` is the way of filling the slots if the slots
    /// were filled anew.
    pub fn submitted(&mut self, way: Option<Way>) {
        if self.pending.is_none() && self.used.contains(&true) {
            self.pending = Some((readback::bytes(&self.staging), std::mem::take(&mut self.used), way));
        }
    }

    /// Returns the measurement for the choice between the ways, once for every frame that filled the slots anew:
    /// milliseconds of a frame with a moving camera plus milliseconds of a frame with moving light.
    pub fn take_displayed(&mut self) -> Option<(Way, f64)> {
        self.displayed.take()
    }

    /// The latest results.
    pub fn collect(&mut self, gpu: &Gpu) -> Milliseconds {
        #[cfg(not(target_arch = "wasm32"))]
        let _ = gpu.device.poll(wgpu::PollType::Poll);
        #[cfg(target_arch = "wasm32")]
        let _ = gpu;
        let Some((receiver, used, way)) = &self.pending else { return self.last };
        let (used, way) = (*used, *way);
        let Some(bytes) = receiver.try_take() else { return self.last };
        if let Ok(bytes) = bytes {
            let stamps: Vec<u64> = bytemuck::pod_collect_to_vec(&bytes);
            for (i, _) in used.iter().enumerate().filter(|(_, used)| **used) {
                let ms = stamps[2 * i + 1].wrapping_sub(stamps[2 * i]) as f64 * self.period_ns * 1e-6;
                let slot = match i {
                    0 => &mut self.last.shadows,
                    1 => &mut self.last.relight,
                    2 => &mut self.last.g_buffer,
                    3 => &mut self.last.find,
                    4 => &mut self.last.gather,
                    5 => &mut self.last.blended,
                    #[cfg(feature = "antiradiance")]
                    7 => &mut self.last.antiradiance,
                    _ => &mut self.last.composite,
                };
                *slot = Some(ms);
            }
            if let (Some(way), Some(find), Some(gather)) = (way, self.last.find, self.last.gather) {
                self.displayed = Some((way, find + 2.0 * gather));
            }
        }
        self.pending = None;
        self.last
    }
}
