//! One frame of relighting on the GPU: the steps of [`rebounce_shared::relight`] as compute passes.
//!
//! * here: pipelines, buffers, and the passes;
//! * `plan` – the dispatches in order;
//! * `elsewhere` – direct light at other places than the points;
//! * `other_solvers` – bounced light from another solver than the operator;
//! * `from_sources` – the light of the sky and of emissive surfaces, straight to the points;
//! * `from_groups` – all light of a fixed solution, in place of links;
//! * `from_transfer` – all light of a file for an environment, likewise.

#[cfg(feature = "radiosity")]
pub mod elsewhere;
mod from_groups;
mod from_sources;
#[cfg(feature = "radiosity")]
mod from_transfer;
#[cfg(feature = "radiosity")]
mod other_solvers;
mod plan;

use super::upload::{LinkBuffers, Upload};
use crate::gpu::bindings::{Slot, compute, empty_buffer, group, layout, part};
use crate::gpu::scope::Scope;
use crate::gpu::{Gpu, MAX_LAYERS};
use crate::shaders;
use from_groups::FromGroups;
use from_sources::{FromSources, FromSourcesPipelines, Groups};
#[cfg(feature = "radiosity")]
use from_transfer::FromTransfer;
use plan::{Dispatch, Kernel, LEVEL_THREADS, STRIDE, Step, plan};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
#[cfg(feature = "radiosity")]
use std::cell::Cell;
use std::cell::OnceCell;
#[cfg(feature = "antiradiance")]
use std::ops::Range;
use wgpu::{BufferUsages, ShaderStages};

/// Threads that share a row on a GPU: reads of neighbouring links coalesce, and short rows waste little.
pub const LANES: u32 = 8;
/// Threads that share a row on a software adapter, where synchronization within a workgroup is expensive.
pub const SOFTWARE_LANES: u32 = 1;

/// Parts of the light that [`Relight::display`] holds, of a scene with sources.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parts {
    /// Light that bounced at least once.
    pub bounced: bool,
    /// Light straight from the sky and emissive surfaces.
    pub from_sources: bool,
}

impl Parts {
    /// All light.
    pub const ALL: Self = Self { bounced: true, from_sources: true };
}

/// Work of an evaluation.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CachedEvaluation {
    /// Whether the sum continues from its present value; otherwise from zero.
    pub keep: bool,
    /// Lights added to the sum.
    pub still: Vec<u32>,
    /// Lights evaluated in addition to the sum.
    pub moving: Vec<u32>,
}

impl CachedEvaluation {
    /// Number of evaluated lights.
    pub fn count(&self) -> usize {
        self.still.len() + self.moving.len()
    }
}

/// Range of the dispatches of a frame. Without antiradiance nothing is encoded between them, and all are encoded.
#[cfg(feature = "antiradiance")]
type Steps = Range<usize>;
#[cfg(not(feature = "antiradiance"))]
type Steps = ();

/// A kernel's bind group layout and pipeline.
type KernelPass = (wgpu::BindGroupLayout, wgpu::ComputePipeline);

/// Pipelines, independent of a scene.
pub struct RelightPipelines {
    direct: KernelPass,
    pull: KernelPass,
    send: KernelPass,
    transport: wgpu::BindGroupLayout,
    short: wgpu::ComputePipeline,
    bounce: wgpu::BindGroupLayout,
    lift: KernelPass,
    level: KernelPass,
    lanes: u32,
    shared: [wgpu::ComputePipeline; 2],
    /// Created for the first scene with sources.
    sources: OnceCell<FromSourcesPipelines>,
}

impl RelightPipelines {
    /// Creates the pipelines; `lights` is the layout of the lights' bind group.
    pub fn new(gpu: &Gpu, lights: &wgpu::BindGroupLayout) -> Self {
        let direct = slots(gpu, "direct", 2, 2);
        let transport = slots(gpu, "transport", 6, 1);
        let bounce = slots(gpu, "bounce", 3, 2);
        let alone = [("LANES", 1.0)];
        let lanes = if gpu.software { SOFTWARE_LANES } else { LANES };
        let shared = shared(gpu, &transport, &bounce, lanes);
        let short = match lanes {
            1 => shared[0].clone(),
            _ => compute(gpu, "transport", shaders::TRANSPORT, &[&transport], &alone),
        };
        Self {
            shared,
            lanes,
            short,
            transport,
            direct: (direct.clone(), compute(gpu, "direct", shaders::DIRECT, &[&direct, lights], &[])),
            pull: kernel(gpu, "pull", shaders::PULL, 2, 1),
            send: kernel(gpu, "send", shaders::SEND, 2, 1),
            bounce,
            lift: kernel(gpu, "lift", shaders::LIFT, 2, 2),
            level: kernel(gpu, "level", shaders::LEVEL, 1, 1),
            sources: OnceCell::new(),
        }
    }
}

/// Creates a kernel over points; its buffers are `reads` and then `writes`.
fn kernel(gpu: &Gpu, entry: &str, source: shaders::Source, reads: usize, writes: usize) -> KernelPass {
    let layout = slots(gpu, entry, reads, writes);
    let pipeline = compute(gpu, entry, source, &[&layout], &[]);
    (layout, pipeline)
}

/// Creates the layout of a kernel's step and buffers.
fn slots(gpu: &Gpu, label: &str, reads: usize, writes: usize) -> wgpu::BindGroupLayout {
    let mut slots = vec![Slot::UniformPart(size_of::<Step>() as u64)];
    slots.extend(std::iter::repeat_n(Slot::Read, reads));
    slots.extend(std::iter::repeat_n(Slot::Write, writes));
    layout(gpu, label, ShaderStages::COMPUTE, &slots)
}

/// Creates the kernels with `lanes` threads per row: transport and bounces.
fn shared(
    gpu: &Gpu,
    transport: &wgpu::BindGroupLayout,
    bounce: &wgpu::BindGroupLayout,
    lanes: u32,
) -> [wgpu::ComputePipeline; 2] {
    let constants = [("LANES", lanes as f64)];
    [
        compute(gpu, "transport", shaders::TRANSPORT, &[transport], &constants),
        compute(gpu, "bounce", shaders::BOUNCE, &[bounce], &constants),
    ]
}

/// Light that is computed on the CPU and written to the points, in place of links.
enum Written {
    /// Of a fixed solution.
    Groups(FromGroups),
    /// Of a file for an environment.
    #[cfg(feature = "radiosity")]
    Transfer(Box<FromTransfer>),
}

impl Written {
    /// Of a scene without links; `None` with links, or by radiosity.
    fn of(scene: &BakedScene) -> Option<Self> {
        #[cfg(feature = "radiosity")]
        if scene.is_for_environment() {
            return Some(Self::Transfer(Box::new(FromTransfer::new(scene))));
        }
        scene.is_solved().then(|| Self::Groups(FromGroups::new(scene)))
    }
}

/// Buffers, bind groups and dispatches of a scene.
pub struct Relight {
    /// Direct irradiance at the direct points, at senders also irradiance of later bounces: RGB and an unused
    /// float.
    pub irradiance: wgpu::Buffer,
    /// Irradiance along the normal of every point, without direct light of lamps: RGB, and the tilt (tilt.wgsl).
    pub display: wgpu::Buffer,
    /// Light levels for the automatic exposure (light_level.wgsl); zero without light.
    pub levels: wgpu::Buffer,
    /// What the senders send, with the light of later bounces, RGB.
    #[cfg(feature = "radiosity")]
    pub sent: wgpu::Buffer,
    /// Where direct light is sampled.
    #[cfg(feature = "antiradiance")]
    pub points: wgpu::Buffer,
    steps: wgpu::Buffer,
    /// `CachedEvaluation` of direct.wgsl.
    choice: wgpu::Buffer,
    direct: wgpu::BindGroup,
    pull: wgpu::BindGroup,
    send: wgpu::BindGroup,
    transport: Vec<wgpu::BindGroup>,
    bounce: Vec<wgpu::BindGroup>,
    lift: wgpu::BindGroup,
    level: wgpu::BindGroup,
    shared: [wgpu::ComputePipeline; 2],
    sources: Option<FromSources>,
    /// Of a scene without links, with the sum of its light and direct light.
    written: Option<(Written, wgpu::ComputePipeline, wgpu::BindGroup)>,
    plan: Vec<Dispatch>,
    /// Whether bounced light comes from radiosity, which adds the light of sources by itself.
    #[cfg(feature = "radiosity")]
    by_radiosity: Cell<bool>,
    /// Whether the file has links.
    #[cfg(feature = "radiosity")]
    is_linked: bool,
    own: Scope,
}

impl Relight {
    /// Creates buffers and bind groups for a scene. Direct light is sampled at `points`: those of the file, where their
    /// groups are.
    pub fn new(
        gpu: &Gpu,
        pipelines: &RelightPipelines,
        upload: &Upload,
        points: &wgpu::Buffer,
        scene: &BakedScene,
    ) -> Self {
        let own = Scope::new(gpu);
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let colours = |label, count: usize| empty_buffer(&own, label, storage, 16 * count as u64);
        let irradiance = colours("irradiance", scene.direct_count());
        let display = colours("display", scene.points.len());
        let still = colours("still", scene.direct_count());
        // Every light has at least one layer.
        let choice = empty_buffer(&own, "choice", storage, 4 * (3 + MAX_LAYERS as u64));
        let bounced = colours("bounced", scene.sender_count());
        let sent = colours("sent", scene.sender_count());
        let levels = empty_buffer(&own, "levels", storage, 8 * LEVEL_THREADS as u64);
        let plan = plan(scene, upload, pipelines.lanes);
        let steps = empty_buffer(
            &own,
            "steps",
            BufferUsages::UNIFORM | BufferUsages::COPY_DST,
            STRIDE * plan.len().max(1) as u64,
        );
        for (i, dispatch) in plan.iter().enumerate() {
            gpu.queue.write_buffer(&steps, i as u64 * STRIDE, bytemuck::bytes_of(&dispatch.step));
        }
        let make = |label: &str, layout: &wgpu::BindGroupLayout, buffers: &[&wgpu::Buffer]| {
            let mut resources = vec![part(&steps, size_of::<Step>() as u64)];
            resources.extend(buffers.iter().map(|b| b.as_entire_binding()));
            group(gpu, label, layout, &resources)
        };
        let (offsets, entries) = (&upload.push_offsets, &upload.push_entries);
        let sources = upload.source_links.as_ref().map(|links| {
            let made = pipelines.sources.get_or_init(|| FromSourcesPipelines::new(gpu, pipelines.lanes));
            FromSources::new(&own, made, &scene.sources, scene.points.len(), |light, strengths| Groups {
                gather: by_chunk(links, &|rows, links| {
                    let buffers = [rows, links, strengths, offsets, entries, &upload.points, light];
                    make("sources", &made.gather.0, &buffers)
                }),
                join: [&irradiance, &display].map(|to| make("join", &made.join.0, &[light, to])),
            })
        });
        let written = Written::of(scene).map(|written| {
            let (layout, pipeline) = kernel(gpu, "join", shaders::JOIN, 1, 1);
            (written, pipeline, make("join", &layout, &[&display, &irradiance]))
        });
        Self {
            sources,
            written,
            direct: make("direct", &pipelines.direct.0, &[points, &choice, &still, &irradiance]),
            #[cfg(feature = "radiosity")]
            by_radiosity: scene.is_unlinked().into(),
            #[cfg(feature = "radiosity")]
            is_linked: !scene.is_unlinked(),
            pull: make("pull", &pipelines.pull.0, &[&upload.pull_offsets, &upload.pull_entries, &irradiance]),
            send: make("send", &pipelines.send.0, &[&upload.points, &irradiance, &sent]),
            transport: by_chunk(&upload.links, &|rows, links| {
                let buffers = [rows, links, &sent, offsets, entries, &upload.points, &display];
                make("transport", &pipelines.transport, &buffers)
            }),
            bounce: by_chunk(&upload.later, &|rows, links| {
                make("bounce", &pipelines.bounce, &[rows, links, &display, &bounced, &irradiance])
            }),
            lift: make("lift", &pipelines.lift.0, &[offsets, entries, &bounced, &irradiance]),
            level: make("level", &pipelines.level.0, &[&irradiance, &levels]),
            shared: pipelines.shared.clone(),
            irradiance,
            display,
            #[cfg(feature = "radiosity")]
            sent,
            #[cfg(feature = "antiradiance")]
            points: points.clone(),
            levels,
            steps,
            choice,
            plan,
            own,
        }
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes()
    }

    /// Sets the number of threads per row, a power of two up to 64; for measurements.
    pub fn set_lanes(&mut self, gpu: &Gpu, pipelines: &RelightPipelines, lanes: u32) {
        self.shared = shared(gpu, &pipelines.transport, &pipelines.bounce, lanes);
        if let Some((own, made)) = self.sources.as_mut().zip(pipelines.sources.get()) {
            own.set_lanes(gpu, made, lanes);
        }
        for (i, dispatch) in self.plan.iter_mut().enumerate() {
            if let Kernel::Transport(_) | Kernel::Sources(_) | Kernel::Bounce = dispatch.kernel {
                *dispatch = Dispatch::lanes(dispatch.kernel, dispatch.step, lanes);
                gpu.queue.write_buffer(&self.steps, i as u64 * STRIDE, bytemuck::bytes_of(&dispatch.step));
            }
        }
    }

    /// Sets the lights for the first step to evaluate.
    pub fn set_lights(&self, gpu: &Gpu, choice: &CachedEvaluation) {
        let mut words = vec![choice.keep as u32, choice.still.len() as u32, choice.count() as u32];
        words.extend(choice.still.iter().chain(&choice.moving));
        gpu.queue.write_buffer(&self.choice, 0, bytemuck::cast_slice(&words));
    }

    /// Whether the scene is a fixed solution.
    pub fn is_solved(&self) -> bool {
        matches!(self.written, Some((Written::Groups(_), ..)))
    }

    /// Whether the points hold direct light for display: that of sources.
    pub fn has_sources(&self) -> bool {
        self.sources.is_some() || self.written.is_some()
    }

    /// Sets the strengths of the sources
    /// ([`Sources::strengths`](rebounce_shared::rbn::sources::Sources::strengths)), or of the light groups of a fixed
    /// solution ([`group_strengths`](rebounce_shared::light_group::group_strengths)); no effect without either.
    pub fn set_strengths(&self, gpu: &Gpu, strengths: &[Vec3]) {
        if let Some(sources) = &self.sources {
            sources.set_strengths(gpu, strengths);
        }
        if let Some((Written::Groups(groups), ..)) = &self.written {
            groups.set_strengths(gpu, &self.display, strengths);
        }
    }

    /// Sets what of the light is displayed, from the next strengths on; no effect without sources.
    pub fn set_parts(&self, gpu: &Gpu, parts: Parts) {
        match &self.written {
            Some((Written::Groups(groups), ..)) => groups.set_parts(parts),
            #[cfg(feature = "radiosity")]
            Some((Written::Transfer(transfer), ..)) => transfer.set_parts(parts),
            None => {}
        }
        for (i, dispatch) in self.plan.iter().enumerate().filter(|(_, d)| d.kernel == Kernel::Show) {
            let step = dispatch.step.with_parts(parts);
            gpu.queue.write_buffer(&self.steps, i as u64 * STRIDE, bytemuck::bytes_of(&step));
        }
    }

    /// Sets all light at the points to zero: no light is on.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.display, 0, None);
        #[cfg(feature = "radiosity")]
        if let Some((Written::Transfer(transfer), ..)) = &self.written {
            transfer.forget();
        }
        #[cfg(feature = "radiosity")]
        encoder.clear_buffer(&self.irradiance, 0, None);
        #[cfg(feature = "radiosity")]
        encoder.clear_buffer(&self.sent, 0, None);
        encoder.clear_buffer(&self.levels, 0, None);
    }

    /// Encodes all steps; without `lights` the irradiance in the buffer is used. The light from the sources is computed
    /// after a change of their strengths alone. Returns the number of dispatches.
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pipelines: &RelightPipelines,
        lights: Option<&wgpu::BindGroup>,
        timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) -> usize {
        #[cfg(feature = "antiradiance")]
        let steps = 0..self.plan.len();
        #[cfg(not(feature = "antiradiance"))]
        let steps = ();
        self.encode_part(encoder, pipelines, lights, timestamps, steps)
    }

    /// Ranges of the dispatches of direct light and of bounced light.
    #[cfg(feature = "antiradiance")]
    pub fn parts(&self) -> [Steps; 2] {
        let bounced = self.plan.iter().position(|dispatch| dispatch.kernel.is_bounced());
        let bounced = bounced.unwrap_or(self.plan.len());
        [0..bounced, bounced..self.plan.len()]
    }

    /// As [`Self::encode`], of a range of the dispatches.
    #[cfg_attr(not(feature = "antiradiance"), inline(always))]
    pub fn encode_part(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pipelines: &RelightPipelines,
        lights: Option<&wgpu::BindGroup>,
        timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>,
        steps: Steps,
    ) -> usize {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("relight"),
            timestamp_writes: timestamps,
        });
        let is_stale = self.sources.as_ref().is_some_and(FromSources::take_stale);
        let mut count = 0;
        let all = self.plan.iter().enumerate();
        #[cfg(feature = "antiradiance")]
        let all = all.take(steps.end).skip(steps.start);
        #[cfg(not(feature = "antiradiance"))]
        let () = steps;
        for (i, dispatch) in all {
            let (pipeline, bind) = match dispatch.kernel {
                #[cfg(feature = "radiosity")]
                kernel if self.by_radiosity.get() && kernel.is_bounced() => continue,
                Kernel::Direct if lights.is_none() => continue,
                Kernel::Direct => (&pipelines.direct.1, &self.direct),
                Kernel::Pull => (&pipelines.pull.1, &self.pull),
                Kernel::Send => (&pipelines.send.1, &self.send),
                Kernel::Short(chunk) => (&pipelines.short, &self.transport[chunk]),
                Kernel::Transport(chunk) => (&self.shared[0], &self.transport[chunk]),
                Kernel::Bounce => (&self.shared[1], &self.bounce[0]),
                Kernel::Lift => (&pipelines.lift.1, &self.lift),
                Kernel::Level => (&pipelines.level.1, &self.level),
                kernel => {
                    match (&self.written, self.sources.as_ref().and_then(|own| own.pass(kernel, is_stale))) {
                        (Some((_, pipeline, join)), _) => (pipeline, join),
                        (None, Some(pass)) => pass,
                        (None, None) => continue,
                    }
                }
            };
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, bind, &[i as u32 * STRIDE as u32]);
            if dispatch.kernel == Kernel::Direct {
                pass.set_bind_group(1, lights, &[]);
            }
            pass.dispatch_workgroups(dispatch.groups[0], dispatch.groups[1], 1);
            count += 1;
        }
        count
    }
}

/// Makes bind groups of offsets and links of a matrix, chunk by chunk.
fn by_chunk(
    matrix: &LinkBuffers,
    make: &dyn Fn(&wgpu::Buffer, &wgpu::Buffer) -> wgpu::BindGroup,
) -> Vec<wgpu::BindGroup> {
    let mut groups = Vec::new();
    for chunk in &matrix.chunks {
        groups.push(make(&matrix.offsets, &chunk.links));
    }
    groups
}
