//! Antiradiance on the GPU: the steps of [`rebounce_shared::antiradiance`] as compute passes.
//!
//! * here: buffers, their contents, and the dispatches;
//! * `links` – the links, those of what moves apart;
//! * `preparation` – patches of a scene and their first links;
//! * `in_scene` – light between the points of a scene and their patches;
//! * `pipelines` – the compute pipelines.
//!
//! The tables of incident radiance and of exitant intensity stay between frames: light that changes goes on from the light
//! before, by as many steps a frame as there is time for. A cell of a table is three half floats; intensity is by the square
//! unit of an element's area, so that patches and clusters are within their range.
//!
//! The ordered iteration goes through the elements in [waves](rebounce_shared::antiradiance::waves), a dispatch each; the
//! symmetric and the asymmetric one through the levels of the hierarchy.

mod in_scene;
mod links;
mod pipelines;
mod preparation;

pub use in_scene::{AntiradianceCounts, Lamps, SceneAntiradiance};
pub use pipelines::AntiradiancePipelines;
pub use preparation::Preparation;

use crate::error::ViewerError;
use crate::gpu::Gpu;
use crate::gpu::bindings::{WORKGROUP, buffer, empty_buffer, grid, group, part};
use crate::gpu::scope::Scope;
use bytemuck::{Pod, Zeroable};
use links::{GpuLinks, MovingWaves, Shared};
use rebounce_shared::antiradiance::lobe::widened_alpha;
use rebounce_shared::antiradiance::waves::SLICES;
use rebounce_shared::antiradiance::{
    AntiradianceSolver, Cells, DirectLight, Hierarchy, Iteration, Lobes, MovingElements, PartTables, Patch,
    SweepScene, Waves,
};
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
    moving: u32,
    slice: u32,
    slices: u32,
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
/// Usage of what is written and read by shaders.
const STORAGE: BufferUsages =
    BufferUsages::STORAGE.union(BufferUsages::COPY_DST).union(BufferUsages::COPY_SRC);

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

    /// Adds a dispatch of a thread for each index.
    fn over(&mut self, range: Range<usize>, constants: BinsUniform) -> BinsDispatch {
        self.threads(range.len(), range, constants)
    }

    fn threads(&mut self, threads: usize, range: Range<usize>, constants: BinsUniform) -> BinsDispatch {
        let (first, count) = (range.start as u32, range.len() as u32);
        self.dispatch(threads, |groups| BinsUniform { first, count, groups, ..constants })
    }

    /// Adds a dispatch for each wave, over its items.
    fn waves(&mut self, waves: &Waves, constants: BinsUniform) -> Vec<BinsDispatch> {
        (0..waves.count()).map(|wave| self.over(waves.range(wave), constants)).collect()
    }

    /// Adds the dispatches of a part of the bins: over levels of the hierarchy, and over items of waves.
    fn part(
        &mut self,
        hierarchy: &Hierarchy,
        items: impl Iterator<Item = Range<usize>>,
        constants: BinsUniform,
    ) -> PartDispatches {
        let BinsUniform { bins, slice, slices, .. } = constants;
        let bins = (bins - slice).div_ceil(slices) as usize;
        let levels = (0..hierarchy.depth()).map(|level| hierarchy.level(level));
        let levels = levels.map(|level| self.threads(level.len() * bins, level, constants)).collect();
        let items = items.filter(|items| !items.is_empty());
        PartDispatches { levels, waves: items.map(|items| self.over(items, constants)).collect() }
    }
}

/// Dispatches over all bins, or over a slice of them.
struct PartDispatches {
    /// By level, from the root on: over all cells of its elements.
    levels: Vec<BinsDispatch>,
    /// Of the ordered iteration, by wave.
    waves: Vec<BinsDispatch>,
}

/// Patches and clusters of a scene, their links, and the light of the steps so far.
pub struct GpuAntiradiance {
    iteration: Iteration,
    /// Steps since the last restart.
    step: u32,
    whole: PartDispatches,
    /// By slice of the bins; of the ordered iteration.
    slices: Vec<PartDispatches>,
    /// Waves of what moves, which come before.
    moving: Option<MovingWaves>,
    /// Over all elements.
    elements: BinsDispatch,
    /// Over all patches.
    patches: BinsDispatch,
    /// Over all cells of glossy patches; `None` without any.
    lobes: Option<BinsDispatch>,
    direct: wgpu::Buffer,
    /// By glossy patch, direct irradiance by bin, then what comes evenly from all sides.
    direct_lobes: wgpu::Buffer,
    gains: wgpu::Buffer,
    irradiance: wgpu::Buffer,
    items: wgpu::Buffer,
    uniforms: wgpu::Buffer,
    shared: Shared,
    links: GpuLinks,
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
        let AntiradianceSolver { patches, hierarchy, bins, normalisations, .. } = solver;
        let is_ordered = iteration == Iteration::Ordered;
        let spread = (!is_ordered).then_some(&solver.spread);
        let cells = Cells::new(&solver.transfers, spread, hierarchy, bins.count());
        let waves = if is_ordered { Waves::new(&cells, hierarchy, bins) } else { Waves::default() };
        let scene = SweepScene { patches, hierarchy, bins, normalisations };
        let still = PartTables { cells, waves };
        Self::of_parts((gpu, pipelines), (&scene, &solver.lobes), [&still, &PartTables::default()], iteration)
    }

    /// Uploads elements of which some move, with the tables of what stands, for the ordered iteration.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of_moving(
        gpu: &Gpu,
        pipelines: &AntiradiancePipelines,
        elements: &MovingElements,
        still: &PartTables,
    ) -> Result<Self, ViewerError> {
        let scene = (&elements.scene(), elements.lobes());
        Self::of_parts((gpu, pipelines), scene, [still, &elements.moving_tables()], Iteration::Ordered)
    }

    fn of_parts(
        (gpu, pipelines): (&Gpu, &AntiradiancePipelines),
        (scene, lobes): (&SweepScene<'_>, &Lobes),
        [still, moving]: [&PartTables; 2],
        iteration: Iteration,
    ) -> Result<Self, ViewerError> {
        let SweepScene { patches, hierarchy, bins, normalisations } = *scene;
        let count = bins.count();
        let own = Scope::new(gpu);
        let links = GpuLinks::new(gpu, &still.cells, &moving.cells)?;
        let table = links::fitting(CELL * (hierarchy.elements.len() * count) as u64)?;
        let stored = |label, bytes: &[u8]| buffer(&own, label, STORAGE, bytes);
        let empty = |label, bytes| empty_buffer(&own, label, STORAGE, bytes);
        let elements = stored("elements", bytemuck::cast_slice(&hierarchy.elements));
        let ways: Vec<[f32; 4]> = bins.directions.iter().map(|way| way.extend(0.0).to_array()).collect();
        let ways = stored("ways", bytemuck::cast_slice(&ways));
        let by_patch = |label, cells: Vec<[f32; 4]>| stored(label, bytemuck::cast_slice(&cells));
        let is_metal = |patch: &Patch| if patch.roughness.is_some() { 1.0 } else { 0.0 };
        let albedo = |patch: &Patch| patch.albedo.extend(is_metal(patch)).to_array();
        let albedo = by_patch("albedo", patches.iter().map(albedo).collect());
        let no_lobe = std::iter::repeat_n([0.0; 4], lobes.gains.len());
        let radiance = by_patch("radiance", normalisations.iter().map(dark).chain(no_lobe).collect());
        let gains = by_patch("gains", gain_cells(&lobes.gains));
        let glossy = lobes.patches.iter().map(|patch| {
            let patch = *patch as usize;
            let roughness = patches[patch].roughness.unwrap_or_default();
            let alpha = widened_alpha(roughness, bins.sine());
            GlossyPatch { element: hierarchy.element_of[patch], alpha }
        });
        let glossy = stored("glossy patches", bytemuck::cast_slice(&glossy.collect::<Vec<_>>()));
        let arriving = empty("arriving by bin", 16 * lobes.gains.len() as u64);
        let direct_lobes = empty("direct by bin", 16 * (lobes.gains.len() + lobes.patches.len()) as u64);
        let [incident, exitant] = ["incident", "exitant"].map(|label| empty(label, table));
        let [direct, irradiance] =
            ["direct", "irradiance"].map(|label| empty(label, 16 * patches.len() as u64));
        let items = stored("items", bytemuck::cast_slice(&still.waves.items));

        let constants = BinsUniform {
            bins: count as u32,
            sine: bins.sine(),
            solid_angle: bins.solid_angle(),
            patches: patches.len() as u32,
            moving: links.moving(),
            slices: 1,
            ..BinsUniform::default()
        };
        let mut uniforms = Uniforms::default();
        let waves = &still.waves;
        let whole = uniforms.part(hierarchy, (0..waves.count()).map(|wave| waves.range(wave)), constants);
        let slices = (0..if waves.count() > 0 { SLICES } else { 0 }).map(|slice| {
            let items = (0..waves.count()).map(|wave| waves.slice(wave, slice));
            let constants = BinsUniform { slice: slice as u32, slices: SLICES as u32, ..constants };
            uniforms.part(hierarchy, items, constants)
        });
        let slices = slices.collect();
        let [all_elements, all_patches] =
            [hierarchy.elements.len(), patches.len()].map(|count| uniforms.over(0..count, constants));
        let glossy_count = lobes.patches.len();
        let all_lobes =
            (glossy_count > 0).then(|| uniforms.threads(glossy_count * count, 0..glossy_count, constants));
        let uniforms = buffer(&own, "passes", BufferUsages::UNIFORM, &uniforms.0);

        let shared = Shared { constants, elements, ways, radiance, incident, exitant };
        let make = |label: &str, layout, buffers: &[&wgpu::Buffer]| {
            let mut resources = vec![part(&uniforms, size_of::<BinsUniform>() as u64)];
            resources.extend([&shared.elements, &shared.ways].map(|buffer| buffer.as_entire_binding()));
            resources.extend(buffers.iter().map(|buffer| buffer.as_entire_binding()));
            group(&own, label, layout, &resources)
        };
        let Shared { radiance, incident, exitant, .. } = &shared;
        let gather = match iteration {
            Iteration::Ordered => links.sweep(gpu, pipelines, &shared, (&items, &uniforms)),
            Iteration::Symmetric | Iteration::Asymmetric(_) => {
                let gathered = [&links.offsets, &links.transfers, exitant, incident];
                make("gather bins", &pipelines.gather.0, &gathered)
            }
        };
        let measure = make("measure bins", &pipelines.measure.0, &[incident, radiance, &irradiance]);
        let reflected = [&albedo, &direct, &irradiance, radiance];
        let reflect = make("reflect patches", &pipelines.reflect.0, &reflected);
        let arriving_from = [&glossy, incident, &direct_lobes, radiance, &arriving];
        let arrive_lobes = make("arrive lobes", &pipelines.arrive_lobes.0, &arriving_from);
        let of_lobes = [&glossy, &gains, &arriving, radiance];
        let reflect_lobes = make("reflect lobes", &pipelines.reflect_lobes.0, &of_lobes);
        let leave = make("leave bins", &pipelines.leave.0, &[radiance, incident, exitant]);
        let moving = MovingWaves::new(gpu, pipelines, (&links, &shared), &moving.waves);
        Ok(Self {
            iteration,
            step: 0,
            whole,
            slices,
            moving,
            elements: all_elements,
            patches: all_patches,
            lobes: all_lobes,
            direct,
            direct_lobes,
            gains,
            irradiance,
            items,
            uniforms,
            shared,
            links,
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
        let moving = self.moving.as_ref().map_or(0, MovingWaves::bytes);
        self.own.bytes() + self.links.bytes() + moving
    }

    /// Takes over elements of [`Self::of_moving`] where they are now, with the tables of what moves. The light stays.
    ///
    /// # Errors
    /// As [`Self::new`]; it is as before then.
    pub fn follow(
        &mut self,
        gpu: &Gpu,
        pipelines: &AntiradiancePipelines,
        elements: &MovingElements,
        PartTables { cells, waves }: &PartTables,
    ) -> Result<(), ViewerError> {
        if self.links.follow(gpu, cells)? {
            self.gather = self.links.sweep(gpu, pipelines, &self.shared, (&self.items, &self.uniforms));
        }
        self.moving = MovingWaves::new(gpu, pipelines, (&self.links, &self.shared), waves);
        let (scene, still) = (elements.scene(), elements.moving().start);
        let write = |buffer, first: usize, rows: Vec<[f32; 4]>| {
            gpu.queue.write_buffer(buffer, 16 * first as u64, bytemuck::cast_slice(&rows));
        };
        gpu.queue.write_buffer(&self.shared.elements, 0, bytemuck::cast_slice(&scene.hierarchy.elements));
        write(&self.shared.radiance, still, scene.normalisations[still..].iter().map(dark).collect());
        let lobes = elements.lobes();
        let kept = lobes.patches.partition_point(|patch| (*patch as usize) < still) * scene.bins.count();
        write(&self.gains, kept, gain_cells(&lobes.gains[kept..]));
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

    /// Waves of a step of the ordered iteration, of what stands and of what moves; 0 of the others.
    pub fn waves(&self) -> [usize; 2] {
        [self.whole.waves.len(), self.moving.as_ref().map_or(0, |moving| moving.waves.len())]
    }

    /// Directions of the bins.
    fn ways(&self) -> &wgpu::Buffer {
        &self.shared.ways
    }

    /// Sets the direct light of the patches; steps go on from the light before.
    pub fn set_direct(&self, gpu: &Gpu, direct: &DirectLight) {
        let row = |light: &Vec3| light.extend(0.0).to_array();
        let rows: Vec<[f32; 4]> = direct.irradiance.iter().map(row).collect();
        gpu.queue.write_buffer(&self.direct, 0, bytemuck::cast_slice(&rows));
        let bins = self.shared.constants.bins as usize;
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
        encoder.clear_buffer(&self.shared.incident, 0, None);
        encoder.clear_buffer(&self.irradiance, 0, None);
    }

    /// Encodes a step: local pass and pull, global pass and push or a sweep, irradiance.
    pub fn step(&mut self, encoder: &mut wgpu::CommandEncoder, pipelines: &AntiradiancePipelines) {
        self.step_of(encoder, pipelines, &self.whole);
        self.step += 1;
    }

    /// Encodes a step of the ordered iteration whose static waves cover a slice of the bins, of [`SLICES`]; incident radiance of
    /// other bins stays. Other iterations step whole.
    pub fn step_slice(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        pipelines: &AntiradiancePipelines,
        slice: usize,
    ) {
        self.step_of(encoder, pipelines, self.slices.get(slice).unwrap_or(&self.whole));
        self.step += 1;
    }

    fn step_of(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pipelines: &AntiradiancePipelines,
        part: &PartDispatches,
    ) {
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
        part.levels.iter().rev().for_each(|level| run(&mut pass, &self.leave, *level));
        let (pipeline, dispatches) = match self.iteration {
            Iteration::Ordered => (&pipelines.sweep.1, &part.waves),
            Iteration::Symmetric | Iteration::Asymmetric(_) => (&pipelines.gather.1, &part.levels),
        };
        pass.set_pipeline(pipeline);
        if let Some(moving) = &self.moving {
            moving.waves.iter().for_each(|wave| run(&mut pass, &moving.bound, *wave));
        }
        dispatches.iter().for_each(|dispatch| run(&mut pass, &self.gather, *dispatch));
        pass.set_pipeline(&pipelines.measure.1);
        run(&mut pass, &self.measure, self.elements);
    }
}

/// The radiance of a patch without light: the normalisation of its cosines.
fn dark(normalisation: &f32) -> [f32; 4] {
    [0.0, 0.0, 0.0, *normalisation]
}

fn gain_cells(gains: &[Vec3]) -> Vec<[f32; 4]> {
    gains.iter().map(|gain| gain.extend(0.0).to_array()).collect()
}

fn run(pass: &mut wgpu::ComputePass<'_>, bound: &wgpu::BindGroup, dispatch: BinsDispatch) {
    pass.set_bind_group(0, bound, &[dispatch.place]);
    pass.dispatch_workgroups(dispatch.groups[0], dispatch.groups[1], 1);
}
