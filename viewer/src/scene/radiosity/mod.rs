//! Radiosity on the GPU: the steps of [`rebounce_shared::radiosity`] as compute passes, in slices, so that a page stays
//! responsive.
//!
//! * here: buffers, their contents, and the dispatches;
//! * `pipelines` – the compute pipelines;
//! * `plan` – the steps of a solution in order.

mod pipelines;
mod plan;

pub use pipelines::RadiosityPipelines;
pub use plan::Progress;

use super::reclip::Reclipped;
use super::upload::Upload;
use crate::error::ViewerError;
use crate::gpu::bindings::{buffer, empty_buffer, grid, group, part};
use crate::gpu::scope::Scope;
use crate::gpu::{Gpu, MAX_BINDING};
use bytemuck::{Pod, Zeroable};
use plan::{Plan, SolverKernel, SolverStep};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::colour::pack_rgb9e5;
use rebounce_shared::motion::Motions;
use rebounce_shared::radiosity::accelerator::{BvhNode, PlacedModel};
use rebounce_shared::radiosity::{Accelerator, Clipping, RadiositySettings, Reconstruction};
use rebounce_shared::rbn::bulk::Point;
use std::cell::RefCell;
use wgpu::BufferUsages;

/// `Pass` in radiosity_pass.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct PassUniform {
    first: u32,
    count: u32,
    groups: u32,
    sender_level: u32,
    levels: u32,
    rays: u32,
    number: u32,
    exact: u32,
    top: u32,
    finest_radius: f32,
    epsilon: f32,
    significance: f32,
    whole: u32,
    none: u32,
    factor: f32,
    bounce: u32,
}

/// Bytes between the uniforms of two dispatches.
const STRIDE: u64 = 256;
/// Dispatches that share a buffer of uniforms: those of one slice.
const MOST_DISPATCHES: usize = 64;
/// Uniforms of the dispatch that shows a solution: it may share a submission with those of a slice, and a queue writes
/// buffers before it runs any of them.
const SHOWN_AT: usize = MOST_DISPATCHES;

/// The solver of a scene.
pub struct Radiosity {
    accelerator: Accelerator,
    settings: RadiositySettings,
    pass: PassUniform,
    plan: Plan,
    points: wgpu::Buffer,
    clipping: RefCell<Clipping>,
    reclipped: RefCell<Reclipped>,
    nodes: wgpu::Buffer,
    models: wgpu::Buffer,
    uniforms: wgpu::Buffer,
    gather: wgpu::BindGroup,
    pull_down: wgpu::BindGroup,
    mean: wgpu::BindGroup,
    /// From direct light, and from the bounce before.
    send: [wgpu::BindGroup; 2],
    show: wgpu::BindGroup,
    own: Scope,
}

impl Radiosity {
    /// Uploads what a scene's solutions need. `points` are those of the file where their groups are, `direct` has the direct
    /// irradiance of all points, and `display` gets the bounced irradiance.
    ///
    /// # Errors
    /// [`ViewerError::TooLarge`] where something is larger than a binding.
    pub fn new(
        gpu: &Gpu,
        pipelines: &RadiosityPipelines,
        upload: &Upload,
        scene: &BakedScene,
        [points, direct, display]: [&wgpu::Buffer; 3],
        settings: RadiositySettings,
    ) -> Result<Self, ViewerError> {
        let own = Scope::new(gpu);
        let accelerator = Accelerator::new(scene);
        let placed = accelerator.placed(scene, &Motions::default());
        let count = scene.points.len();
        // A binary tree over the placed models has fewer nodes than models.
        let top_nodes = placed.models.len().max(1);
        let node_bytes = (accelerator.nodes.len() + top_nodes) * size_of::<BvhNode>();
        for (section, bytes) in
            [("INDX", node_bytes), ("INDX", size_of_val(&accelerator.triangles[..])), ("PNTS", 16 * count)]
        {
            let (bytes, limit) = (bytes as u64, MAX_BINDING);
            if bytes > limit {
                return Err(ViewerError::TooLarge { section, bytes, limit });
            }
        }
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        let stored = |label, bytes: &[u8]| buffer(&own, label, storage, bytes);
        let colours = |label| empty_buffer(&own, label, storage, 16 * count as u64);
        let nodes = empty_buffer(&own, "nodes", storage, node_bytes as u64);
        gpu.queue.write_buffer(&nodes, 0, bytemuck::cast_slice(&accelerator.nodes));
        let models = empty_buffer(&own, "models", storage, (top_nodes * size_of::<PlacedModel>()) as u64);
        let triangles = stored("triangles", bytemuck::cast_slice(&accelerator.triangles));
        let albedo: Vec<u32> = (0..count).map(|i| pack_rgb9e5(scene.albedo(i))).collect();
        let albedo = stored("albedo", bytemuck::cast_slice(&albedo));
        let [values, sum, sent] = ["values", "sum", "sent"].map(colours);
        let means = empty_buffer(&own, "means", storage, 4 * u64::from(settings.bounces.max(1)));
        let uniform = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let uniforms = empty_buffer(&own, "passes", uniform, STRIDE * (SHOWN_AT + 1) as u64);
        let make = |label: &str, layout, buffers: &[&wgpu::Buffer]| {
            let mut resources = vec![part(&uniforms, size_of::<PassUniform>() as u64)];
            resources.extend(buffers.iter().map(|buffer| buffer.as_entire_binding()));
            group(&own, label, layout, &resources)
        };
        let bound = [&nodes, &triangles, &models, points, &upload.cuts, &upload.lookup, &sent, &values];
        let gather = make("gather light", &pipelines.gather.0, &bound);
        let rows = [&upload.push_offsets, &upload.push_entries, &means, &values];
        let pull_down = make("pull down", &pipelines.pull_down.0, &rows);
        let mean = make("mean", &pipelines.mean.0, &[&values, &means]);
        let show = make("show light", &pipelines.show.0, &[&values, &sum, direct, display]);
        let send = [direct, &values]
            .map(|unshot| make("send light", &pipelines.send.0, &[&albedo, unshot, &means, &sum, &sent]));
        let levels = scene.meta.levels.len();
        let plan = Plan::new((0..levels).map(|l| scene.level(l)).collect(), &settings);
        let pass = PassUniform {
            sender_level: plan.sender_level() as u32,
            levels: levels as u32,
            rays: settings.rays.max(1),
            exact: u32::from(settings.reconstruction == Reconstruction::Exact),
            top: accelerator.nodes.len() as u32,
            finest_radius: scene.meta.levels.last().map_or(0.0, |level| level.support_radius),
            epsilon: settings.epsilon,
            significance: settings.significance,
            ..PassUniform::default()
        };
        let out = Self {
            accelerator,
            settings,
            pass,
            plan,
            points: points.clone(),
            clipping: Clipping::new(scene).into(),
            reclipped: RefCell::default(),
            nodes,
            models,
            uniforms,
            gather,
            pull_down,
            mean,
            send,
            show,
            own,
        };
        out.place(gpu, upload, scene, &Motions::default());
        Ok(out)
    }

    /// Settings of the solutions.
    pub fn settings(&self) -> &RadiositySettings {
        &self.settings
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes()
    }

    /// Puts the groups where `motions` have them: models for rays, points, and what ends supports and relates points around
    /// what has moved. The solution begins anew with [`Self::restart`].
    pub fn place(&self, gpu: &Gpu, upload: &Upload, scene: &BakedScene, motions: &Motions) {
        let placed = self.accelerator.placed(scene, motions);
        let top = (self.accelerator.nodes.len() * size_of::<BvhNode>()) as u64;
        gpu.queue.write_buffer(&self.nodes, top, bytemuck::cast_slice(&placed.nodes));
        gpu.queue.write_buffer(&self.models, 0, bytemuck::cast_slice(&placed.models));
        let functions = self.clipping.borrow_mut().follow(scene, &self.accelerator, &placed, motions);
        upload.reclip(gpu, scene, &functions, &mut self.reclipped.borrow_mut());
        let there = |(i, point): (usize, &Point)| Point { cuts: point.cuts, ..scene.moved_point(i, motions) };
        let points: Vec<Point> = functions.points.iter().enumerate().map(there).collect();
        gpu.queue.write_buffer(&self.points, 0, bytemuck::cast_slice(&points));
    }

    /// Begins a solution of the present direct light.
    pub fn restart(&mut self) {
        self.plan.restart();
    }

    /// How far the solution is.
    pub fn progress(&self) -> Progress {
        self.plan.progress()
    }

    /// Encodes the next steps of the solution: gathers for at most `receivers` points. Returns how many were looked at.
    pub fn encode(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        pipelines: &RadiosityPipelines,
        receivers: u32,
    ) -> u32 {
        let steps = self.plan.take(receivers, MOST_DISPATCHES);
        self.run(gpu, encoder, pipelines, &steps, 0);
        steps.iter().filter(|step| step.kernel == SolverKernel::Gather).map(|step| step.count).sum()
    }

    /// Writes the bounced light of the solution so far to what is displayed.
    pub fn show(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, pipelines: &RadiosityPipelines) {
        self.run(gpu, encoder, pipelines, &[self.plan.show()], SHOWN_AT);
    }

    fn run(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        pipelines: &RadiosityPipelines,
        steps: &[SolverStep],
        place_of_first: usize,
    ) {
        let mut uniforms = vec![0u8; STRIDE as usize * steps.len()];
        let mut work = Vec::new();
        for (step, place) in steps.iter().zip(uniforms.chunks_exact_mut(STRIDE as usize)) {
            let (pipeline, bind, groups) = match step.kernel {
                SolverKernel::Gather => {
                    (&pipelines.gather.1, &self.gather, step.count.div_ceil(pipelines.receivers_of_group))
                }
                SolverKernel::PullDown => (&pipelines.pull_down.1, &self.pull_down, step.count.div_ceil(64)),
                SolverKernel::Mean => (&pipelines.mean.1, &self.mean, 1),
                SolverKernel::Show => (&pipelines.show.1, &self.show, step.count.div_ceil(64)),
                SolverKernel::Send { from_direct } => {
                    (&pipelines.send.1, &self.send[usize::from(!from_direct)], step.count.div_ceil(64))
                }
            };
            let groups = grid(groups);
            let uniform = self.uniform(step, groups[0]);
            place[..size_of::<PassUniform>()].copy_from_slice(bytemuck::bytes_of(&uniform));
            work.push((pipeline, bind, groups));
        }
        gpu.queue.write_buffer(&self.uniforms, STRIDE * place_of_first as u64, &uniforms);
        let mut pass = encoder.begin_compute_pass(&Default::default());
        for (i, (pipeline, bind, groups)) in work.into_iter().enumerate() {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, bind, &[(place_of_first + i) as u32 * STRIDE as u32]);
            pass.dispatch_workgroups(groups[0], groups[1], 1);
        }
    }

    fn uniform(&self, step: &SolverStep, groups: u32) -> PassUniform {
        PassUniform {
            first: step.first,
            count: step.count,
            groups,
            number: step.number,
            whole: u32::from(step.is_whole),
            none: u32::from(step.is_none),
            factor: step.factor,
            bounce: step.bounce,
            ..self.pass
        }
    }
}
