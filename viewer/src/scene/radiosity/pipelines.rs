//! Compute pipelines of radiosity, independent of a scene.

use super::PassUniform;
use crate::gpu::Gpu;
use crate::gpu::bindings::{ComputeKernel, Slot, kernel};
use crate::shaders::{self, Source};

/// Threads that share a receiver on a GPU.
const LANES: u32 = 64;
/// Threads that share a receiver on a software adapter: synchronization within a workgroup is expensive there, but Mesa's
/// llvmpipe ends all loops of a thread after 65535 rounds, which is about 300 rays.
const SOFTWARE_LANES: u32 = 16;

/// The pipelines, with the layouts of their bind groups.
pub struct RadiosityPipelines {
    pub(super) gather: ComputeKernel,
    pub(super) pull_down: ComputeKernel,
    pub(super) mean: ComputeKernel,
    pub(super) send: ComputeKernel,
    pub(super) show: ComputeKernel,
    /// Receivers of a workgroup.
    pub(super) receivers_of_group: u32,
}

impl RadiosityPipelines {
    /// Creates the pipelines.
    pub fn new(gpu: &Gpu) -> Self {
        Self::with_lanes(gpu, if gpu.software { SOFTWARE_LANES } else { LANES })
    }

    /// As [`Self::new`], with so many threads a receiver: a power of two up to 64.
    pub fn with_lanes(gpu: &Gpu, lanes: u32) -> Self {
        let uniform = Slot::UniformPart(size_of::<PassUniform>() as u64);
        let made = |entry: &str, source: Source, reads: usize, writes: usize, constants: &[(&str, f64)]| {
            kernel(gpu, entry, source, (uniform, reads, writes), constants)
        };
        Self {
            gather: made("gather_light", shaders::GATHER_LIGHT, 7, 1, &[("LANES", f64::from(lanes))]),
            pull_down: made("pull_down", shaders::PULL_DOWN, 3, 1, &[]),
            mean: made("bounce_mean", shaders::BOUNCE_MEAN, 1, 1, &[]),
            send: made("send_light", shaders::SEND_LIGHT, 3, 2, &[]),
            show: made("show_light", shaders::SHOW_LIGHT, 3, 1, &[]),
            receivers_of_group: 64 / lanes,
        }
    }
}
