//! Antiradiance on the GPU: the steps of [`rebounce_shared::antiradiance`] as compute passes.
//!
//! * here: buffers, their contents, and the dispatches;
//! * `in_scene` – patches of a scene's points, and the light between both;
//! * `pipelines` – the compute pipelines.
//!
//! The tables of incident radiance and of exitant intensity stay between frames: light that changes goes on from the light
//! before, by as many steps a frame as there is time for. A cell of a table is three half floats; intensity is by the square
//! unit of an element's area, so that patches and clusters are within their range.
//!
//! The ordered iteration goes through the elements in [waves](rebounce_shared::antiradiance::waves), a dispatch each; the
//! symmetric and the asymmetric one through the levels of the hierarchy.

mod in_scene;
mod pipelines;

pub use in_scene::{AntiradianceCounts, Lamps, SceneAntiradiance};
pub use pipelines::AntiradiancePipelines;

use crate::error::ViewerError;
use crate::gpu::bindings::{WORKGROUP, buffer, empty_buffer, grid, group, part};
use crate::gpu::scope::Scope;
use crate::gpu::{Gpu, MAX_BINDING};
use bytemuck::{Pod, Zeroable};
use rebounce_shared::antiradiance::lobe::widened_alpha;
use rebounce_shared::antiradiance::{AntiradianceSolver, Cells, DirectLight, Iteration, Patch, Waves};
use rebounce_shared::glam::Vec3;
use std::ops::Range;
use wgpu::BufferUsages;

/// `Pass` in antiradiance_pass.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct BinsUniform {
    first: u32,
    count: u32,
    groups: u32,
    bins: u32,
    sine: f32,
    solid_angle: f32,
    patches: u32,
}

/// `Glossy` in lobe_bins.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct GlossyPatch {
    element: u32,
    alpha: f32,
}

/// Bytes between the uniforms of two dispatches.
const STRIDE: u64 = 256;
/// Bytes of a cell of the tables.
const CELL: u64 = 8;

/// A dispatch: the place of its uniform, and its workgroups.
#[derive(Clone, Copy, Debug, PartialEq)]
struct BinsDispatch {
    place: u32,
    groups: [u32; 2],
}

/// Uniforms of dispatches, [`STRIDE`] bytes each.
#[derive(Default)]
struct Uniforms(Vec<u8>);

impl Uniforms {
    /// Adds a dispatch of so many threads; `uniform` gets the number of workgroups in x.
    fn dispatch<U: Pod>(&mut self, threads: usize, uniform: impl FnOnce(u32) -> U) -> BinsDispatch {
        let place = self.0.len() as u32;
        let groups = grid((threads as u32).div_ceil(WORKGROUP));
        self.0.extend_from_slice(bytemuck::bytes_of(&uniform(groups[0])));
        self.0.resize(self.0.len().next_multiple_of(STRIDE as usize), 0);
        BinsDispatch { place, groups }
    }
}

/// Patches and clusters of a scene, their links, and the light of the steps so far.
pub struct GpuAntiradiance {
    iteration: Iteration,
    /// Steps since the last restart.
    step: u32,
    /// By level, from the root on: over all cells of its elements.
    levels: Vec<BinsDispatch>,
    /// Of the ordered iteration, by wave.
    waves: Vec<BinsDispatch>,
    /// Over all elements.
    elements: BinsDispatch,
    /// Over all patches.
    patches: BinsDispatch,
    /// Over all cells of glossy patches; `None` without any.
    lobes: Option<BinsDispatch>,
    direct: wgpu::Buffer,
    /// By glossy patch, direct irradiance by bin, then what comes evenly from all sides.
    direct_lobes: wgpu::Buffer,
    ways: wgpu::Buffer,
    incident: wgpu::Buffer,
    irradiance: wgpu::Buffer,
    /// Light over links: gather_bins.wgsl by levels, or sweep_bins.wgsl by waves.
    gather: wgpu::BindGroup,
    measure: wgpu::BindGroup,
    reflect: wgpu::BindGroup,
    arrive_lobes: wgpu::BindGroup,
    reflect_lobes: wgpu::BindGroup,
    leave: wgpu::BindGroup,
    own: Scope,
}

impl GpuAntiradiance {
    /// Uploads the elements and links of a solver; there is no light yet.
    ///
    /// # Errors
    /// [`ViewerError::TooManyElements`] where a table or the links are larger than a binding.
    pub fn new(
        gpu: &Gpu,
        pipelines: &AntiradiancePipelines,
        solver: &AntiradianceSolver<'_>,
        iteration: Iteration,
    ) -> Result<Self, ViewerError> {
        let (hierarchy, bins) = (&solver.hierarchy, solver.bins.count());
        let is_ordered = iteration == Iteration::Ordered;
        let spread = (!is_ordered).then_some(&solver.spread);
        let cells = Cells::new(&solver.transfers, spread, hierarchy, bins);
        let waves = if is_ordered { Waves::new(&cells, hierarchy, &solver.bins) } else { Waves::default() };
        let table = CELL * (hierarchy.elements.len() * bins) as u64;
        let links = size_of_val(&cells.transfers[..]) as u64;
        if let Some(bytes) = [table, links].into_iter().find(|bytes| *bytes > MAX_BINDING) {
            return Err(ViewerError::TooManyElements { bytes, limit: MAX_BINDING });
        }
        let own = Scope::new(gpu);
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        let stored = |label, bytes: &[u8]| buffer(&own, label, storage, bytes);
        let empty = |label, bytes| empty_buffer(&own, label, storage, bytes);
        let elements = stored("elements", bytemuck::cast_slice(&hierarchy.elements));
        let ways: Vec<[f32; 4]> =
            solver.bins.directions.iter().map(|way| way.extend(0.0).to_array()).collect();
        let ways = stored("ways", bytemuck::cast_slice(&ways));
        let by_patch = |label, cells: Vec<[f32; 4]>| stored(label, bytemuck::cast_slice(&cells));
        let is_metal = |patch: &Patch| if patch.roughness.is_some() { 1.0 } else { 0.0 };
        let albedo = |patch: &Patch| patch.albedo.extend(is_metal(patch)).to_array();
        let albedo = by_patch("albedo", solver.patches.iter().map(albedo).collect());
        let dark = |normalisation: &f32| [0.0, 0.0, 0.0, *normalisation];
        let lobes = &solver.lobes;
        let no_lobe = std::iter::repeat_n([0.0; 4], lobes.gains.len());
        let radiance = by_patch("radiance", solver.normalisations.iter().map(dark).chain(no_lobe).collect());
        let gains = by_patch("gains", lobes.gains.iter().map(|gain| gain.extend(0.0).to_array()).collect());
        let glossy = lobes.patches.iter().map(|patch| {
            let patch = *patch as usize;
            let roughness = solver.patches[patch].roughness.unwrap_or_default();
            let alpha = widened_alpha(roughness, solver.bins.sine());
            GlossyPatch { element: hierarchy.element_of[patch], alpha }
        });
        let glossy = stored("glossy patches", bytemuck::cast_slice(&glossy.collect::<Vec<_>>()));
        let arriving = empty("arriving by bin", 16 * lobes.gains.len() as u64);
        let direct_lobes = empty("direct by bin", 16 * (lobes.gains.len() + lobes.patches.len()) as u64);
        let offsets = stored("offsets", bytemuck::cast_slice(&cells.offsets));
        let transfers = stored("transfers", bytemuck::cast_slice(&cells.transfers));
        let [incident, exitant] = ["incident", "exitant"].map(|label| empty(label, table));
        let [direct, irradiance] =
            ["direct", "irradiance"].map(|label| empty(label, 16 * solver.patches.len() as u64));
        let items = stored("items", bytemuck::cast_slice(&waves.items));

        let constants = BinsUniform {
            bins: bins as u32,
            sine: solver.bins.sine(),
            solid_angle: solver.bins.solid_angle(),
            patches: solver.patches.len() as u32,
            ..BinsUniform::default()
        };
        let mut uniforms = Uniforms::default();
        let mut dispatch = |range: Range<usize>, threads: usize| {
            let (first, count) = (range.start as u32, range.len() as u32);
            uniforms.dispatch(threads, |groups| BinsUniform { first, count, groups, ..constants })
        };
        let levels = (0..hierarchy.depth()).map(|level| hierarchy.level(level));
        let levels = levels.map(|level| dispatch(level.clone(), level.len() * bins)).collect();
        let [all_elements, all_patches] =
            [hierarchy.elements.len(), solver.patches.len()].map(|count| dispatch(0..count, count));
        let count = lobes.patches.len();
        let all_lobes = (count > 0).then(|| dispatch(0..count, count * bins));
        let waves = waves.starts.windows(2).map(|wave| {
            let items = wave[0] as usize..wave[1] as usize;
            dispatch(items.clone(), items.len())
        });
        let waves = waves.collect();
        let uniforms = buffer(&own, "passes", BufferUsages::UNIFORM, &uniforms.0);

        let make = |label: &str, layout, buffers: &[&wgpu::Buffer]| {
            let mut resources = vec![part(&uniforms, size_of::<BinsUniform>() as u64)];
            resources.extend([&elements, &ways].map(|buffer| buffer.as_entire_binding()));
            resources.extend(buffers.iter().map(|buffer| buffer.as_entire_binding()));
            group(&own, label, layout, &resources)
        };
        let gather = if is_ordered {
            let swept = [&offsets, &transfers, &items, &radiance, &incident, &exitant];
            make("sweep bins", &pipelines.sweep.0, &swept)
        } else {
            make("gather bins", &pipelines.gather.0, &[&offsets, &transfers, &exitant, &incident])
        };
        let measure = make("measure bins", &pipelines.measure.0, &[&incident, &radiance, &irradiance]);
        let reflected = [&albedo, &direct, &irradiance, &radiance];
        let reflect = make("reflect patches", &pipelines.reflect.0, &reflected);
        let arriving_from = [&glossy, &incident, &direct_lobes, &radiance, &arriving];
        let arrive_lobes = make("arrive lobes", &pipelines.arrive_lobes.0, &arriving_from);
        let of_lobes = [&glossy, &gains, &arriving, &radiance];
        let reflect_lobes = make("reflect lobes", &pipelines.reflect_lobes.0, &of_lobes);
        let leave = make("leave bins", &pipelines.leave.0, &[&radiance, &incident, &exitant]);
        Ok(Self {
            iteration,
            step: 0,
            levels,
            waves,
            elements: all_elements,
            patches: all_patches,
            lobes: all_lobes,
            direct,
            direct_lobes,
            ways,
            incident,
            irradiance,
            gather,
            measure,
            reflect,
            arrive_lobes,
            reflect_lobes,
            leave,
            own,
        })
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes()
    }

    /// Takes over a solver of the same elements, some of which have moved. The light stays.
    ///
    /// # Errors
    /// As [`Self::new`]; it is as before then.
    pub fn follow(
        &mut self,
        gpu: &Gpu,
        pipelines: &AntiradiancePipelines,
        solver: &AntiradianceSolver<'_>,
    ) -> Result<(), ViewerError> {
        let next = Self { step: self.step, ..Self::new(gpu, pipelines, solver, self.iteration)? };
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for (from, to) in [(&self.incident, &next.incident), (&self.irradiance, &next.irradiance)] {
            encoder.copy_buffer_to_buffer(from, 0, to, 0, from.size());
        }
        gpu.queue.submit([encoder.finish()]);
        *self = next;
        Ok(())
    }

    /// Bounced irradiance by patch: RGB, and a fourth number.
    pub fn irradiance(&self) -> &wgpu::Buffer {
        &self.irradiance
    }

    /// Steps since the last restart.
    pub fn steps(&self) -> u32 {
        self.step
    }

    /// Waves of a step of the ordered iteration; 0 of the others.
    pub fn waves(&self) -> usize {
        self.waves.len()
    }

    /// Sets the direct light of the patches; steps go on from the light before.
    pub fn set_direct(&self, gpu: &Gpu, direct: &DirectLight) {
        let row = |light: &Vec3| light.extend(0.0).to_array();
        let rows: Vec<[f32; 4]> = direct.irradiance.iter().map(row).collect();
        gpu.queue.write_buffer(&self.direct, 0, bytemuck::cast_slice(&rows));
        let bins = (self.ways.size() / 16) as usize;
        let by_bin = direct.by_bin.chunks_exact(bins).flat_map(|row| row.iter().chain([&Vec3::ZERO]));
        let by_bin: Vec<[f32; 4]> = by_bin.map(row).collect();
        gpu.queue.write_buffer(&self.direct_lobes, 0, bytemuck::cast_slice(&by_bin));
    }

    /// Encodes a copy of the direct light of the patches, and of metals by bin; steps go on from the light before.
    pub fn take_direct(&self, encoder: &mut wgpu::CommandEncoder, [patches, lobes]: [&wgpu::Buffer; 2]) {
        for (from, to) in [(patches, &self.direct), (lobes, &self.direct_lobes)] {
            encoder.copy_buffer_to_buffer(from, 0, to, 0, to.size());
        }
    }

    /// Encodes the beginning: no light has bounced yet.
    pub fn restart(&mut self, encoder: &mut wgpu::CommandEncoder) {
        self.step = 0;
        encoder.clear_buffer(&self.incident, 0, None);
        encoder.clear_buffer(&self.irradiance, 0, None);
    }

    /// Encodes a step: local pass and pull, global pass and push or a sweep, irradiance.
    pub fn step(&mut self, encoder: &mut wgpu::CommandEncoder, pipelines: &AntiradiancePipelines) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        // What the step before has brought is reflected now, with the direct light of now.
        if self.step == 0 || self.iteration.reflects(self.step - 1) {
            pass.set_pipeline(&pipelines.reflect.1);
            run(&mut pass, &self.reflect, self.patches);
            if let Some(lobes) = self.lobes {
                pass.set_pipeline(&pipelines.arrive_lobes.1);
                run(&mut pass, &self.arrive_lobes, lobes);
                pass.set_pipeline(&pipelines.reflect_lobes.1);
                run(&mut pass, &self.reflect_lobes, lobes);
            }
        }
        pass.set_pipeline(&pipelines.leave.1);
        self.levels.iter().rev().for_each(|level| run(&mut pass, &self.leave, *level));
        let (pipeline, dispatches) = match self.iteration {
            Iteration::Ordered => (&pipelines.sweep.1, &self.waves),
            Iteration::Symmetric | Iteration::Asymmetric(_) => (&pipelines.gather.1, &self.levels),
        };
        pass.set_pipeline(pipeline);
        dispatches.iter().for_each(|dispatch| run(&mut pass, &self.gather, *dispatch));
        pass.set_pipeline(&pipelines.measure.1);
        run(&mut pass, &self.measure, self.elements);
        self.step += 1;
    }
}

fn run(pass: &mut wgpu::ComputePass<'_>, bound: &wgpu::BindGroup, dispatch: BinsDispatch) {
    pass.set_bind_group(0, bound, &[dispatch.place]);
    pass.dispatch_workgroups(dispatch.groups[0], dispatch.groups[1], 1);
}
