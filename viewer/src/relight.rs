//! One frame of relighting on the GPU: the steps of [`rebounce_shared::relight`] as compute passes.

use crate::bindings::{Slot, compute, empty_buffer, group, layout, part};
use crate::gpu::Gpu;
use crate::shaders;
use crate::upload::{Chunk, Upload, VALUE_BYTES};
use bytemuck::{Pod, Zeroable};
use rebounce_shared::rbn::Scene;
use wgpu::{BufferUsages, ShaderStages};

/// Threads of a workgroup in all relighting shaders.
const WORKGROUP: u32 = 64;
/// Most workgroups in one dimension of a dispatch that WebGPU guarantees.
const MAX_GROUPS: u32 = 65535;
/// Distance of steps in their uniform buffer, bytes.
const STRIDE: u64 = 256;
/// Threads that share a row of `S e`: neighbouring links are read at once, and little is lost on short rows or on
/// software adapters (there, 8 take about as long as 1, and 64 seven times as long).
pub const LANES: u32 = 8;

/// `Step` of the shaders: what one dispatch works on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
struct Step {
    first: u32,
    count: u32,
    extra: u32,
    /// Threads of the grid in x; for the transport, workgroups.
    threads: u32,
}

/// Which shader a dispatch runs; the transport with its chunk of links, those for later bounces first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kernel {
    Direct,
    Pull,
    Lift,
    Transport(usize),
    Push,
    Display,
}

/// One dispatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Dispatch {
    kernel: Kernel,
    step: Step,
    groups: [u32; 2],
}

impl Dispatch {
    /// One thread for each of `count`.
    fn threads(kernel: Kernel, first: usize, count: usize) -> Self {
        let groups = grid((count as u32).div_ceil(WORKGROUP));
        let step =
            Step { first: first as u32, count: count as u32, extra: 0, threads: groups[0] * WORKGROUP };
        Self { kernel, step, groups }
    }

    /// `lanes` threads for each row.
    fn transport(kernel: Kernel, step: Step, lanes: u32) -> Self {
        let groups = grid(step.count.div_ceil(WORKGROUP / lanes));
        Self { kernel, step: Step { threads: groups[0], ..step }, groups }
    }
}

/// Workgroups in x and y, at least so many, within WebGPU's limits.
fn grid(groups: u32) -> [u32; 2] {
    if groups <= MAX_GROUPS { [groups, 1] } else { [MAX_GROUPS, groups.div_ceil(MAX_GROUPS)] }
}

/// `extra` of [`Kernel::Lift`]: from the parents, instead of from the links.
const FROM_PARENTS: u32 = 1;

/// All dispatches of a frame, in order.
fn plan(scene: &Scene, upload: &Upload) -> Vec<Dispatch> {
    let later = upload.later.chunks.len();
    let transport = |(i, chunk): (usize, &Chunk)| {
        let (first, count) = (chunk.rows.start, chunk.rows.len() as u32);
        let step = Step { first, count, extra: chunk.first_link, threads: 0 };
        Dispatch::transport(Kernel::Transport(i), step, LANES)
    };
    let mut plan = vec![Dispatch::threads(Kernel::Direct, 0, scene.direct_count())];
    for l in (0..(scene.meta.direct_levels as usize).saturating_sub(1)).rev() {
        plan.push(Dispatch::threads(Kernel::Pull, scene.level(l).start, scene.level(l).len()));
    }
    if later > 0 {
        plan.extend(upload.later.chunks.iter().enumerate().map(transport));
        plan.push(Dispatch::threads(Kernel::Lift, 0, scene.later_count()));
        for l in scene.meta.later_levels as usize..scene.meta.sender_levels as usize {
            let mut lift = Dispatch::threads(Kernel::Lift, scene.level(l).start, scene.level(l).len());
            lift.step.extra = FROM_PARENTS;
            plan.push(lift);
        }
    }
    plan.extend((later..).zip(&upload.transport.chunks).map(transport));
    for l in 1..scene.meta.levels.len() {
        plan.push(Dispatch::threads(Kernel::Push, scene.level(l).start, scene.level(l).len()));
    }
    plan.push(Dispatch::threads(Kernel::Display, 0, scene.points.len()));
    plan.retain(|dispatch| dispatch.step.count > 0);
    plan
}

/// Pipelines, which depend on no scene.
pub struct RelightPipelines {
    direct: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
    pull: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
    lift: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
    push: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
    display: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
    transport: wgpu::BindGroupLayout,
}

impl RelightPipelines {
    /// Makes them; `lights` is the layout of the lights' bind group.
    pub fn new(gpu: &Gpu, lights: &wgpu::BindGroupLayout) -> Self {
        let step = Slot::UniformPart(size_of::<Step>() as u64);
        let layout = |label: &str, slots: &[Slot]| layout(gpu, label, ShaderStages::COMPUTE, slots);
        let direct = layout("direct", &[step, Slot::Read, Slot::Write]);
        let pull = layout("pull", &[step, Slot::Read, Slot::Read, Slot::Write]);
        let lift = layout(
            "lift",
            &[step, Slot::Read, Slot::Read, Slot::Read, Slot::Write, Slot::Write, Slot::Write],
        );
        let push = layout("push", &[step, Slot::Read, Slot::Read, Slot::Read, Slot::Write]);
        let display = layout("display", &[step, Slot::Read, Slot::Read, Slot::Write]);
        let pipeline = |entry: &str, source, layouts: &[&wgpu::BindGroupLayout]| {
            compute(gpu, entry, source, layouts, &[])
        };
        Self {
            transport: layout("transport", &[step, Slot::Read, Slot::Read, Slot::Read, Slot::Write]),
            direct: (direct.clone(), pipeline("direct", shaders::DIRECT, &[&direct, lights])),
            pull: (pull.clone(), pipeline("pull", shaders::PULL, &[&pull])),
            lift: (lift.clone(), pipeline("lift", shaders::LIFT, &[&lift])),
            push: (push.clone(), pipeline("push", shaders::PUSH, &[&push])),
            display: (display.clone(), pipeline("display_values", shaders::DISPLAY, &[&display])),
        }
    }

    fn transport(&self, gpu: &Gpu, lanes: u32, paged: bool) -> wgpu::ComputePipeline {
        let constants = [("LANES", lanes as f64), ("PAGED", paged as u32 as f64)];
        compute(gpu, "transport", shaders::TRANSPORT, &[&self.transport], &constants)
    }
}

/// A scene's part: buffers and the list of dispatches.
pub struct Relight {
    /// Direct irradiance at the direct points, and at senders all that they send: RGB and one unused.
    pub irradiance: wgpu::Buffer,
    /// Vector irradiance at all points: nine floats, channel after channel.
    pub values: wgpu::Buffer,
    /// Irradiance along each point's normal: RGB and one unused.
    pub display: wgpu::Buffer,
    steps: wgpu::Buffer,
    direct: wgpu::BindGroup,
    pull: wgpu::BindGroup,
    lift: wgpu::BindGroup,
    transport: Vec<wgpu::BindGroup>,
    transport_pipeline: wgpu::ComputePipeline,
    push: wgpu::BindGroup,
    display_group: wgpu::BindGroup,
    plan: Vec<Dispatch>,
    /// Senders may be so many that rows hold page marks.
    paged: bool,
    /// Bytes of the buffers made here.
    pub bytes: u64,
}

impl Relight {
    /// Buffers and bind groups for a scene.
    pub fn new(gpu: &Gpu, pipelines: &RelightPipelines, upload: &Upload, scene: &Scene) -> Self {
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        let irradiance = empty_buffer(gpu, "irradiance", storage, 16 * scene.direct_count() as u64);
        let values = empty_buffer(gpu, "values", storage, VALUE_BYTES * scene.points.len() as u64);
        let display = empty_buffer(gpu, "display", storage, 16 * scene.points.len() as u64);
        let bounced = empty_buffer(gpu, "bounced", storage, 16 * scene.sender_count() as u64);
        let plan = plan(scene, upload);
        let steps = empty_buffer(
            gpu,
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
        let paged = scene.sender_count() > 1 << 16;
        let bytes = irradiance.size() + values.size() + display.size() + bounced.size() + steps.size();
        Self {
            direct: make("direct", &pipelines.direct.0, &[&upload.points, &irradiance]),
            pull: make("pull", &pipelines.pull.0, &[&upload.pull_offsets, &upload.pull_entries, &irradiance]),
            lift: make(
                "lift",
                &pipelines.lift.0,
                &[&upload.push_offsets, &upload.push_entries, &upload.points, &values, &bounced, &irradiance],
            ),
            transport: [&upload.later, &upload.transport]
                .into_iter()
                .flat_map(|matrix| matrix.chunks.iter().map(|chunk| (&matrix.rows, &chunk.links)))
                .map(|(rows, links)| {
                    make("transport", &pipelines.transport, &[rows, links, &irradiance, &values])
                })
                .collect(),
            transport_pipeline: pipelines.transport(gpu, LANES, paged),
            push: make(
                "push",
                &pipelines.push.0,
                &[&upload.push_offsets, &upload.push_entries, &upload.points, &values],
            ),
            display_group: make("display", &pipelines.display.0, &[&upload.points, &values, &display]),
            irradiance,
            values,
            display,
            steps,
            plan,
            paged,
            bytes,
        }
    }

    /// Shares each row of `S e` among so many threads, a power of two up to 64; for measurements.
    pub fn set_lanes(&mut self, gpu: &Gpu, pipelines: &RelightPipelines, lanes: u32) {
        self.transport_pipeline = pipelines.transport(gpu, lanes, self.paged);
        for (i, dispatch) in self.plan.iter_mut().enumerate() {
            if let Kernel::Transport(_) = dispatch.kernel {
                *dispatch = Dispatch::transport(dispatch.kernel, dispatch.step, lanes);
                gpu.queue.write_buffer(&self.steps, i as u64 * STRIDE, bytemuck::bytes_of(&dispatch.step));
            }
        }
    }

    /// Tells the first step how many lights there are.
    pub fn set_light_count(&self, gpu: &Gpu, count: u32) {
        for (i, dispatch) in self.plan.iter().enumerate() {
            if dispatch.kernel == Kernel::Direct {
                let step = Step { extra: count, ..dispatch.step };
                gpu.queue.write_buffer(&self.steps, i as u64 * STRIDE, bytemuck::bytes_of(&step));
            }
        }
    }

    /// Sets all bounced light to zero: no light is on.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.clear_buffer(&self.values, 0, None);
        encoder.clear_buffer(&self.display, 0, None);
    }

    /// Encodes all steps; without `lights` the irradiance is taken as it is in the buffer.
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pipelines: &RelightPipelines,
        lights: Option<&wgpu::BindGroup>,
        timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>,
    ) {
        // Points without links get nothing from the transport.
        encoder.clear_buffer(&self.values, 0, None);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("relight"),
            timestamp_writes: timestamps,
        });
        for (i, dispatch) in self.plan.iter().enumerate() {
            let (pipeline, bind) = match dispatch.kernel {
                Kernel::Direct if lights.is_none() => continue,
                Kernel::Direct => (&pipelines.direct.1, &self.direct),
                Kernel::Pull => (&pipelines.pull.1, &self.pull),
                Kernel::Transport(chunk) => (&self.transport_pipeline, &self.transport[chunk]),
                Kernel::Lift => (&pipelines.lift.1, &self.lift),
                Kernel::Push => (&pipelines.push.1, &self.push),
                Kernel::Display => (&pipelines.display.1, &self.display_group),
            };
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, bind, &[i as u32 * STRIDE as u32]);
            if dispatch.kernel == Kernel::Direct {
                pass.set_bind_group(1, lights, &[]);
            }
            pass.dispatch_workgroups(dispatch.groups[0], dispatch.groups[1], 1);
        }
    }
}
