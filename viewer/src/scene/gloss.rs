//! Glossy transfer on the GPU: what arrives at points of glossy surfaces from each direction.

use super::upload::Upload;
use crate::error::ViewerError;
use crate::gpu::bindings::{Slot, WORKGROUP, buffer, compute, empty_buffer, grid, group, layout, part};
use crate::gpu::scope::Scope;
use crate::gpu::{Gpu, MAX_BINDING};
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::harmonics::{COUNT, Coefficients};
use rebounce_shared::rbn::gloss::GlossLayout;
use std::cell::RefCell;
use std::ops::Range;
use wgpu::{BufferUsages, ShaderStages};

/// `GlossPass` in gloss_pass.wgsl.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
struct PassUniform {
    first: u32,
    count: u32,
    groups: u32,
    channels: u32,
    components: u32,
    vectors: u32,
    pad: [u32; 2],
}

/// Bytes between the uniforms of two dispatches.
const STRIDE: u64 = 256;
/// Number of points without transfer.
const NOWHERE: u32 = u32::MAX;

/// The kernels, independent of a scene.
pub struct GlossKernels {
    vectors: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
    arrive: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
}

impl GlossKernels {
    /// Creates the pipelines.
    pub fn new(gpu: &Gpu) -> Self {
        let made = |entry: &str, source: shaders::Source, reads: usize| {
            let mut slots = vec![Slot::UniformPart(size_of::<PassUniform>() as u64)];
            slots.extend(std::iter::repeat_n(Slot::Read, reads));
            slots.push(Slot::Write);
            let layout = layout(gpu, entry, ShaderStages::COMPUTE, &slots);
            let pipeline = compute(gpu, entry, source, &[&layout], &[]);
            (layout, pipeline)
        };
        Self {
            vectors: made("light_vectors", shaders::LIGHT_VECTORS, 3),
            arrive: made("arrive", shaders::ARRIVE, 7),
        }
    }
}

/// The transfer of a scene.
pub struct GpuGloss {
    /// Sizes, and which surfaces reflect.
    pub layout: GlossLayout,
    /// By point of the file, its number in the transfer.
    pub places: wgpu::Buffer,
    /// By point of the transfer, coefficients of what arrives: RGB, and of visibility.
    pub arriving: wgpu::Buffer,
    sky: wgpu::Buffer,
    vectors: wgpu::BindGroup,
    arrive: wgpu::BindGroup,
    /// Workgroups of each dispatch.
    grids: Vec<[u32; 2]>,
    /// Coefficients of the distant light that has arrived.
    lit_by: RefCell<Option<Box<Coefficients>>>,
    own: Scope,
}

impl GpuGloss {
    /// Uploads the transfer of a scene; `None` without any.
    ///
    /// # Errors
    /// [`ViewerError::TooLarge`] where something is larger than a binding.
    pub fn new(
        gpu: &Gpu,
        kernels: &GlossKernels,
        upload: &Upload,
        scene: &BakedScene,
    ) -> Result<Option<Self>, ViewerError> {
        let gloss = &scene.gloss;
        if gloss.is_empty() {
            return Ok(None);
        }
        let bytes = (16 * COUNT * gloss.points.len()) as u64;
        if bytes > MAX_BINDING {
            return Err(ViewerError::TooLarge { section: "GLPT", bytes, limit: MAX_BINDING });
        }
        let own = Scope::new(gpu);
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        let stored = |label, bytes: &[u8]| buffer(&own, label, storage, bytes);
        // Bytes are read as words.
        let words = |label, bytes: &[u8]| {
            let mut padded = bytes.to_vec();
            padded.resize(bytes.len().next_multiple_of(4), 0);
            stored(label, &padded)
        };
        let mut places = vec![NOWHERE; scene.points.len()];
        let (mut members, mut matrix) = (Vec::with_capacity(gloss.points.len()), 0u32);
        for (place, (point, cluster)) in (0..).zip(gloss.points.iter().zip(&gloss.clusters)) {
            places[*point as usize] = place;
            let has_matrix = *cluster != rebounce_shared::rbn::gloss::NO_MATRIX;
            members.push([*point, u32::from(*cluster) | matrix << 8]);
            matrix += u32::from(has_matrix);
        }
        let (layout, vectors) = (&gloss.layout, gloss.layout.vector_scales.len());
        let lit = empty_buffer(&own, "lit vectors", storage, (16 * COUNT * vectors) as u64);
        let sky = empty_buffer(&own, "sky coefficients", storage, (16 * COUNT) as u64);
        let arriving = empty_buffer(&own, "arriving", storage, bytes);
        let places = stored("places", bytemuck::cast_slice(&places));
        let (passes, grids) = dispatches(scene, vectors as u32);
        let mut content = vec![0u8; STRIDE as usize * passes.len()];
        for (slot, pass) in content.chunks_mut(STRIDE as usize).zip(&passes) {
            slot[..size_of::<PassUniform>()].copy_from_slice(bytemuck::bytes_of(pass));
        }
        let uniforms = buffer(&own, "gloss passes", BufferUsages::UNIFORM, &content);
        let make = |label: &str, layout, buffers: &[&wgpu::Buffer]| {
            let mut resources = vec![part(&uniforms, size_of::<PassUniform>() as u64)];
            resources.extend(buffers.iter().map(|buffer| buffer.as_entire_binding()));
            group(&own, label, layout, &resources)
        };
        let entries = words("GLBS", &gloss.vectors);
        let scales = stored("vector scales", bytemuck::cast_slice(&layout.vector_scales));
        let weights = words("GLWT", &gloss.weights);
        let weight_scales = stored("weight scales", bytemuck::cast_slice(&layout.weight_scales));
        let members = stored("GLPT", bytemuck::cast_slice(&members));
        let of_vectors = [&entries, &scales, &sky, &lit];
        let (offsets, rows) = (&upload.push_offsets, &upload.push_entries);
        let of_points = [&members, &weights, &weight_scales, &lit, offsets, rows, &places, &arriving];
        Ok(Some(Self {
            vectors: make("light vectors", &kernels.vectors.0, &of_vectors),
            arrive: make("arrive", &kernels.arrive.0, &of_points),
            layout: layout.clone(),
            places,
            arriving,
            sky,
            grids,
            lit_by: RefCell::default(),
            own,
        }))
    }

    /// Applies the transfer to distant light, if it is other light than before. Returns whether it is.
    pub fn light(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        kernels: &GlossKernels,
        sky: &Coefficients,
    ) -> bool {
        let mut lit_by = self.lit_by.borrow_mut();
        if lit_by.as_deref() == Some(sky) {
            return false;
        }
        *lit_by = Some(Box::new(*sky));
        let rows: Vec<[f32; 4]> = sky.iter().map(|c| c.extend(0.0).to_array()).collect();
        gpu.queue.write_buffer(&self.sky, 0, bytemuck::cast_slice(&rows));
        let mut pass = encoder.begin_compute_pass(&Default::default());
        for (i, [x, y]) in self.grids.iter().enumerate() {
            let (pipeline, bind) = match i {
                0 => (&kernels.vectors.1, &self.vectors),
                _ => (&kernels.arrive.1, &self.arrive),
            };
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, bind, &[(i as u64 * STRIDE) as u32]);
            pass.dispatch_workgroups(*x, *y, 1);
        }
        true
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes()
    }
}

/// Uniforms and workgroups: of the vectors, then of each level of points.
fn dispatches(scene: &BakedScene, vectors: u32) -> (Vec<PassUniform>, Vec<[u32; 2]>) {
    let gloss = &scene.gloss;
    let before = |end: usize| gloss.points.partition_point(|point| (*point as usize) < end);
    let of_level = |range: Range<usize>| (before(range.start), before(range.end));
    let levels = (0..scene.meta.levels.len()).map(|l| of_level(scene.level(l)));
    let mut passes = Vec::new();
    let mut grids = Vec::new();
    for (first, end) in std::iter::once((0, 0)).chain(levels.filter(|(first, end)| first < end)) {
        let count = if passes.is_empty() { vectors } else { (end - first) as u32 };
        let [x, y] = grid((count * COUNT as u32).div_ceil(WORKGROUP));
        passes.push(PassUniform {
            first: first as u32,
            count,
            groups: x,
            channels: gloss.layout.channels,
            components: gloss.layout.components,
            vectors,
            pad: [0; 2],
        });
        grids.push([x, y]);
    }
    (passes, grids)
}
