//! Antiradiance as the bounced light of a scene: from direct light at its points to light at its points.
//!
//! A file with an operator shows the operator's light plus the difference of two solutions, with moving patches where they are now and
//! at rest. At rest the display is the operator's light; moving patches away from rest display the first solution alone ([`beside`]), as
//! all points of a file without an operator do.
//!
//! Patches stand for points of two levels ([`PointPatches`]): one for what stands, one for what moves. A few steps are
//! taken in every frame, and the light goes on from that of the frame before; a software adapter takes a slice of the bins while
//! lamps or places change, the same in both solutions. After a motion the links of what moves are made
//! anew, on the CPU, and all else stays. The first links are made piece by piece ([`Preparation`](super::Preparation)), with the
//! light as it was before meanwhile.

use super::preparation::Prepared;
use super::{AntiradiancePipelines, BinsDispatch, GpuAntiradiance, STORAGE, Uniforms, run};
use crate::error::ViewerError;
use crate::gpu::Gpu;
use crate::gpu::bindings::{ComputeKernel, buffer, empty_buffer, group, part};
use crate::gpu::scope::Scope;
use crate::scene::moving::Moving;
use crate::scene::relight::Relight;
use crate::scene::rig::GpuRig;
use crate::scene::upload::Upload;
use bytemuck::{Pod, Zeroable};
use rebounce_shared::antiradiance::waves::SLICES;
use rebounce_shared::antiradiance::{MovingElements, Patch, PointPatches, Serial, beside};
use rebounce_shared::glam::Vec3;
use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use wgpu::BufferUsages;

/// Steps of a frame.
const STEPS: u32 = 2;
/// Steps until light is taken for that of the present lamps and places: an ordered step leaves two thirds of the difference or less.
const ENOUGH: u32 = 20;
/// No patch.
const NONE: u32 = u32::MAX;

/// `Points` in patch_points.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct PointsUniform {
    first: u32,
    count: u32,
    groups: u32,
    lights: u32,
}

/// Lamps with their shadow maps.
#[derive(Clone, Copy)]
pub struct Lamps<'a> {
    /// Layout of the bind group.
    pub layout: &'a wgpu::BindGroupLayout,
    /// Lights and shadow maps.
    pub group: &'a wgpu::BindGroup,
    /// Number of lights.
    pub count: usize,
}

/// Size of the problem, and the steps solved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AntiradianceCounts {
    /// Patches and clusters.
    pub elements: usize,
    /// Links between them.
    pub links: usize,
    /// Bins of directions.
    pub bins: usize,
    /// Steps since the scene was loaded, or was first lit this way.
    pub iterations: u32,
}

/// Steps of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FrameSteps {
    /// So many steps.
    Whole(u32),
    /// A step of a slice of the bins.
    Slice(usize),
}

impl FrameSteps {
    /// Whole steps; a round of slices is one.
    fn whole(self) -> u32 {
        match self {
            Self::Whole(count) => count,
            Self::Slice(slice) => u32::from(slice + 1 == SLICES),
        }
    }
}

/// What is shown beside an operator.
struct BesideOperator {
    /// The light with what moves at rest.
    at_rest: RefCell<GpuAntiradiance>,
    /// Patches that move, at rest.
    moving: Vec<Patch>,
    /// By point: light of the operator, and what changes of it.
    operator: wgpu::Buffer,
    change: wgpu::Buffer,
}

/// The solver of a scene, with its light.
pub struct SceneAntiradiance {
    patches: PointPatches,
    elements: RefCell<MovingElements>,
    light: RefCell<GpuAntiradiance>,
    beside: Option<BesideOperator>,
    counts: Cell<AntiradianceCounts>,
    /// Steps still to take.
    left: Cell<u32>,
    /// Something has moved since the links were made.
    is_unlinked: Cell<bool>,
    /// Lamps or places have changed since the last step.
    is_changed: Cell<bool>,
    /// Slice of the bins whose turn is next.
    slice: Cell<usize>,
    point_of: wgpu::Buffer,
    /// Points of the metals' patches.
    point_of_glossy: wgpu::Buffer,
    points: wgpu::Buffer,
    patch_of: wgpu::Buffer,
    irradiance: wgpu::Buffer,
    /// Direct light of the patches, and of metals by bin.
    direct: [wgpu::Buffer; 2],
    display: wgpu::Buffer,
    push: [wgpu::Buffer; 2],
    uniforms: wgpu::Buffer,
    /// Over the patches.
    lit: BinsDispatch,
    /// Over those of metals.
    lit_lobes: Option<BinsDispatch>,
    /// By level, from the coarsest with patches on.
    shown: Vec<BinsDispatch>,
    own: Scope,
}

impl SceneAntiradiance {
    /// Uploads what is prepared; what has moved meanwhile is where it is now.
    ///
    /// # Errors
    /// As [`GpuAntiradiance::new`].
    pub fn new(
        gpu: &Gpu,
        pipelines: &AntiradiancePipelines,
        Prepared { patches, mut elements, still }: Prepared,
        (moving, rig): (&Moving, Option<&GpuRig>),
        (upload, relight): (&Upload, &Relight),
    ) -> Result<Self, ViewerError> {
        let scene = moving.file();
        let riders = rig.map_or(HashMap::new(), GpuRig::ridden);
        let own = Scope::new(gpu);
        let colours = |label, count: usize| empty_buffer(&own, label, STORAGE, 16 * count as u64);
        let beside = relight.is_linked().then(|| {
            let light = GpuAntiradiance::of_moving(gpu, pipelines, &elements, &still)?;
            let moving = elements.patches()[elements.moving()].to_vec();
            let count = scene.points.len();
            let [operator, change] = ["operator", "change"].map(|label| colours(label, count));
            Ok::<_, ViewerError>(BesideOperator { at_rest: light.into(), moving, operator, change })
        });
        let beside = beside.transpose()?;
        elements.follow(&patches.moving(&places(moving, &riders)), &Serial);
        let light = GpuAntiradiance::of_moving(gpu, pipelines, &elements, &still)?;
        let counts = AntiradianceCounts {
            elements: elements.scene().hierarchy.elements.len(),
            links: elements.links().iter().sum(),
            bins: elements.scene().bins.count(),
            iterations: 0,
        };
        let glossy = &elements.lobes().patches;
        let mut patch_of = vec![NONE; scene.points.len()];
        for (number, point) in (0..).zip(&patches.points) {
            patch_of[*point as usize] = number;
        }
        let stored = |label, content: &[u32]| buffer(&own, label, STORAGE, bytemuck::cast_slice(content));
        let (point_of, patch_of) =
            (stored("points of patches", &patches.points), stored("patches of points", &patch_of));
        let of_glossy: Vec<u32> = glossy.iter().map(|patch| patches.points[*patch as usize]).collect();
        let point_of_glossy = stored("points of glossy patches", &of_glossy);
        let direct = [
            colours("direct of patches", patches.points.len()),
            colours("direct of metals", glossy.len() * (counts.bins + 1)),
        ];
        let mut uniforms = Uniforms::default();
        let mut dispatch = |first: usize, count: usize| {
            let (first, all) = (first as u32, count as u32);
            uniforms.dispatch(count, |groups| PointsUniform { first, count: all, groups, lights: 0 })
        };
        let lit = dispatch(0, patches.points.len());
        let coarsest = patches.points.iter().min().copied().unwrap_or(0) as usize;
        let levels = (0..scene.meta.levels.len()).map(|level| scene.level(level));
        let levels = levels.filter(|level| level.end > coarsest);
        let shown = levels.map(|level| dispatch(level.start, level.len())).collect();
        let lit_lobes = (!glossy.is_empty()).then(|| dispatch(0, glossy.len()));
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let uniforms = buffer(&own, "points", usage, &uniforms.0);
        let out = Self {
            patches,
            elements: elements.into(),
            light: light.into(),
            beside,
            counts: counts.into(),
            left: ENOUGH.into(),
            is_unlinked: false.into(),
            is_changed: true.into(),
            slice: 0.into(),
            point_of,
            point_of_glossy,
            points: relight.points.clone(),
            patch_of,
            irradiance: relight.irradiance.clone(),
            direct,
            display: relight.display.clone(),
            push: [upload.push_offsets.clone(), upload.push_entries.clone()],
            uniforms,
            lit,
            lit_lobes,
            shown,
            own,
        };
        out.write_departures(gpu, &out.elements.borrow());
        Ok(out)
    }

    /// Writes how far each patch that moves has left its place at rest.
    fn write_departures(&self, gpu: &Gpu, elements: &MovingElements) {
        let Some(BesideOperator { moving, .. }) = &self.beside else { return };
        let now = &elements.patches()[elements.moving()];
        for ((number, at_rest), now) in (elements.moving().start..).zip(moving).zip(now) {
            let entry = beside::entry(number as u32, beside::departure(at_rest, now));
            let place = 4 * u64::from(self.patches.points[number]);
            gpu.queue.write_buffer(&self.patch_of, place, &entry.to_le_bytes());
        }
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        let beside = self.beside.as_ref().map_or(0, |beside| beside.at_rest.borrow().bytes());
        self.own.bytes() + self.light.borrow().bytes() + beside
    }

    /// Elements, links, bins and steps.
    pub fn counts(&self) -> AntiradianceCounts {
        self.counts.get()
    }

    /// Whether it adds to an operator's light.
    pub fn is_beside_operator(&self) -> bool {
        self.beside.is_some()
    }

    /// Notes that the direct light at the points has changed. Beside an operator there is nothing to add where all is at rest.
    pub fn relit(&self, is_at_rest: bool) {
        self.is_changed.set(true);
        self.left.set(if is_at_rest && self.beside.is_some() { 0 } else { ENOUGH });
    }

    /// Encodes a copy of the operator's light.
    pub fn keep_operator(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(BesideOperator { operator, .. }) = &self.beside {
            encoder.copy_buffer_to_buffer(&self.display, 0, operator, 0, operator.size());
        }
    }

    /// Encodes the end of all light: no lamp shines.
    pub fn darken(&self, encoder: &mut wgpu::CommandEncoder) {
        self.light.borrow_mut().restart(encoder);
        if let Some(beside) = &self.beside {
            beside.at_rest.borrow_mut().restart(encoder);
        }
        self.left.set(0);
    }

    /// Notes that nodes have moved, or that something has another pose.
    pub fn moved(&self) {
        self.is_unlinked.set(true);
        self.is_changed.set(true);
        self.left.set(ENOUGH);
    }

    /// Whether the displayed light is not yet that of lamps and places as they are.
    pub fn is_solving(&self) -> bool {
        self.left.get() > 0
    }

    /// Encodes some steps, and shows their light; makes some of the links of what has moved, `work` as [`MovingElements::advance`] has it;
    /// timestamps are written at the begin of the first pass and the end of the last.
    ///
    /// # Errors
    /// As [`GpuAntiradiance::new`]: what moves may have more links elsewhere.
    pub fn solve(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        pipelines: &AntiradiancePipelines,
        (moving, rig): (&Moving, Option<&GpuRig>),
        (lamps, work): (&Lamps<'_>, usize),
        [begin, end]: [Option<wgpu::ComputePassTimestampWrites<'_>>; 2],
    ) -> Result<(), ViewerError> {
        // Without links there is nothing to wait for.
        let linked = self.link(gpu, pipelines, (moving, rig), work).inspect_err(|_| self.left.set(0))?;
        let steps = self.steps(gpu.software);
        if linked {
            self.left.set(self.left.get().saturating_sub(steps.whole()));
        }
        if self.beside.is_none() {
            self.take_light(gpu, encoder, pipelines, lamps);
        }
        // An empty pass has the time of the begin.
        drop(encoder.begin_compute_pass(&timed(begin)));
        let [offsets, entries] = &self.push;
        let mut light = self.light.borrow_mut();
        let all = |light: &mut GpuAntiradiance, encoder: &mut wgpu::CommandEncoder| {
            light.take_direct(encoder, self.direct.each_ref());
            match steps {
                FrameSteps::Whole(count) => (0..count).for_each(|_| light.step(encoder, pipelines)),
                FrameSteps::Slice(slice) => light.step_slice(encoder, pipelines, slice),
            }
        };
        all(&mut light, encoder);
        let at_rest = self.beside.as_ref().map(|beside| beside.at_rest.borrow_mut());
        let at_rest = at_rest.map(|mut light| {
            all(&mut light, encoder);
            light.irradiance().clone()
        });
        let now = light.irradiance();
        let mut pass = encoder.begin_compute_pass(&timed(end));
        match self.beside.as_ref().zip(at_rest.as_ref()) {
            Some((BesideOperator { operator, change, .. }, at_rest)) => {
                let shown = [&self.patch_of, now, at_rest, offsets, entries, operator, change, &self.display];
                self.dispatch(gpu, &mut pass, &pipelines.change_patches, &shown, &self.shown);
            }
            None => {
                let shown = [&self.patch_of, now, offsets, entries, &self.display];
                self.dispatch(gpu, &mut pass, &pipelines.show_patches, &shown, &self.shown);
            }
        }
        drop(pass);
        let counts = self.counts.get();
        self.counts.set(AntiradianceCounts { iterations: counts.iterations + steps.whole(), ..counts });
        Ok(())
    }

    /// Steps of a frame. Where lamps or places change, a frame of a software adapter has a slice alone.
    fn steps(&self, is_software: bool) -> FrameSteps {
        let is_changed = self.is_changed.take();
        match is_software {
            true if is_changed => FrameSteps::Slice(self.slice.replace((self.slice.get() + 1) % SLICES)),
            true => FrameSteps::Whole(self.left.get().min(1)),
            false => FrameSteps::Whole(self.left.get().min(STEPS)),
        }
    }

    /// Takes the direct light of the points, before the light of an operator is added to it.
    pub fn take_light(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        pipelines: &AntiradiancePipelines,
        lamps: &Lamps<'_>,
    ) {
        let lit = [&self.point_of, &self.irradiance, &self.direct[0]];
        let mut pass = encoder.begin_compute_pass(&timed(None));
        self.dispatch(gpu, &mut pass, &pipelines.light_patches, &lit, &[self.lit]);
        drop(pass);
        self.light_lobes((gpu, encoder), pipelines, lamps);
    }

    /// Evaluates the lamps at metals, by the bins of their ways.
    fn light_lobes(
        &self,
        (gpu, encoder): (&Gpu, &mut wgpu::CommandEncoder),
        pipelines: &AntiradiancePipelines,
        lamps: &Lamps<'_>,
    ) {
        let Some(dispatch) = self.lit_lobes else { return };
        let place = u64::from(dispatch.place) + std::mem::offset_of!(PointsUniform, lights) as u64;
        gpu.queue.write_buffer(&self.uniforms, place, &(lamps.count as u32).to_le_bytes());
        let kernel = pipelines.direct_lobes(gpu, lamps.layout);
        let light = self.light.borrow();
        let buffers = [&self.point_of_glossy, &self.points, &self.irradiance, light.ways(), &self.direct[1]];
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_bind_group(1, lamps.group, &[]);
        self.dispatch(gpu, &mut pass, kernel, &buffers, &[dispatch]);
    }

    /// Makes some links of what moves where it is now, or was when they were begun. Returns whether all are there.
    fn link(
        &self,
        gpu: &Gpu,
        pipelines: &AntiradiancePipelines,
        (moving, rig): (&Moving, Option<&GpuRig>),
        work: usize,
    ) -> Result<bool, ViewerError> {
        let mut elements = self.elements.borrow_mut();
        if !elements.is_following() {
            if !self.is_unlinked.take() {
                return Ok(true);
            }
            let riders = rig.map_or(HashMap::new(), GpuRig::ridden);
            elements.begin_to_follow(&self.patches.moving(&places(moving, &riders)));
        }
        if !elements.advance(work) {
            return Ok(false);
        }
        self.light.borrow_mut().follow(gpu, pipelines, &elements, &elements.moving_tables())?;
        self.write_departures(gpu, &elements);
        self.counts.set(AntiradianceCounts { links: elements.links().iter().sum(), ..self.counts.get() });
        // It may have moved on meanwhile.
        Ok(!self.is_unlinked.get())
    }

    /// Encodes dispatches of a kernel over points and patches into a pass.
    fn dispatch(
        &self,
        gpu: &Gpu,
        pass: &mut wgpu::ComputePass<'_>,
        (layout, pipeline): &ComputeKernel,
        buffers: &[&wgpu::Buffer],
        dispatches: &[BinsDispatch],
    ) {
        let mut resources = vec![part(&self.uniforms, size_of::<PointsUniform>() as u64)];
        resources.extend(buffers.iter().map(|buffer| buffer.as_entire_binding()));
        let bound = group(gpu, "patches", layout, &resources);
        pass.set_pipeline(pipeline);
        dispatches.iter().for_each(|dispatch| run(pass, &bound, *dispatch));
    }
}

fn timed(stamps: Option<wgpu::ComputePassTimestampWrites<'_>>) -> wgpu::ComputePassDescriptor<'_> {
    wgpu::ComputePassDescriptor { label: Some("patches"), timestamp_writes: stamps }
}

/// Places of points where their nodes are; `riders` have those of points on what deforms.
fn places<'a>(moving: &'a Moving, riders: &'a HashMap<usize, [Vec3; 2]>) -> impl Fn(usize) -> [Vec3; 2] + 'a {
    let motions = moving.motions();
    move |point| riders.get(&point).copied().unwrap_or_else(|| moving.placed_point(&motions, point))
}
