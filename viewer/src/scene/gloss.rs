//! Glossy transfer on the GPU: what arrives at points of glossy surfaces from each direction.

use super::cube_maps::CubeMapKernels;
use super::upload::Upload;
use crate::error::ViewerError;
use crate::gpu::bindings::{ComputeKernel, Slot, WORKGROUP, buffer, empty_buffer, grid, group, kernel, part};
use crate::gpu::scope::Scope;
use crate::gpu::{Gpu, MAX_BINDING};
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
use rebounce_shared::harmonics::{COUNT, Coefficients};
use rebounce_shared::rbn::gloss::GlossLayout;
use std::cell::{OnceCell, RefCell};
use std::ops::Range;
use wgpu::BufferUsages;

/// `GlossPass` in gloss_pass.wgsl.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
struct GlossUniform {
    first: u32,
    count: u32,
    groups: u32,
    channels: u32,
    components: u32,
    vectors: u32,
    points: u32,
    pad: u32,
}

/// Bytes between the uniforms of two dispatches.
const STRIDE: u64 = 256;
/// Number of points without transfer.
const NOWHERE: u32 = u32::MAX;

/// The kernels, independent of a scene.
pub struct GlossKernels {
    vectors: ComputeKernel,
    arrive: ComputeKernel,
    links: ComputeKernel,
    /// Cube maps; made for the first scene with them.
    pub cube_maps: OnceCell<CubeMapKernels>,
}

/// What a dispatch runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum GlossKernel {
    /// light_vectors.wgsl, over all vectors.
    Vectors,
    /// arrive.wgsl, over the points of a level.
    Arrive,
    /// gloss_links.wgsl, over the points of a level that have links.
    Links,
}

impl GlossKernels {
    /// Creates the pipelines.
    pub fn new(gpu: &Gpu) -> Self {
        let uniform = Slot::UniformPart(size_of::<GlossUniform>() as u64);
        let made = |entry: &str, source: shaders::Source, reads: usize| {
            kernel(gpu, entry, source, (uniform, reads, 1), &[])
        };
        Self {
            vectors: made("light_vectors", shaders::LIGHT_VECTORS, 3),
            arrive: made("arrive", shaders::ARRIVE, 7),
            links: made("gloss_links", shaders::GLOSS_LINKS, 6),
            cube_maps: OnceCell::new(),
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
    /// Radiance of the groups of emissive surfaces.
    pub emission: wgpu::Buffer,
    vectors: wgpu::BindGroup,
    arrive: wgpu::BindGroup,
    links: wgpu::BindGroup,
    /// Dispatches in order, with their workgroups.
    plan: Vec<(GlossKernel, [u32; 2])>,
    /// Coefficients of the distant light that has arrived.
    lit_by: RefCell<Option<Box<Coefficients>>>,
    own: Scope,
}

impl GpuGloss {
    /// Uploads the transfer of a scene; `None` without any. `sent` is what its senders send.
    ///
    /// # Errors
    /// [`ViewerError::TooLarge`] where something is larger than a binding.
    pub fn new(
        gpu: &Gpu,
        kernels: &GlossKernels,
        (upload, sent): (&Upload, &wgpu::Buffer),
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
        let (layout, vectors) = (&gloss.layout, gloss.layout.scales.vectors.len());
        let lit = empty_buffer(&own, "lit vectors", storage, (16 * COUNT * vectors) as u64);
        let sky = empty_buffer(&own, "sky coefficients", storage, (16 * COUNT) as u64);
        let arriving = empty_buffer(&own, "arriving", storage, bytes);
        let places = stored("places", bytemuck::cast_slice(&places));
        let (passes, plan) = dispatches(scene, vectors as u32);
        let mut content = vec![0u8; STRIDE as usize * passes.len()];
        for (slot, pass) in content.chunks_mut(STRIDE as usize).zip(&passes) {
            slot[..size_of::<GlossUniform>()].copy_from_slice(bytemuck::bytes_of(pass));
        }
        let uniforms = buffer(&own, "gloss passes", BufferUsages::UNIFORM, &content);
        let make = |label: &str, layout, buffers: &[&wgpu::Buffer]| {
            let mut resources = vec![part(&uniforms, size_of::<GlossUniform>() as u64)];
            resources.extend(buffers.iter().map(|buffer| buffer.as_entire_binding()));
            group(&own, label, layout, &resources)
        };
        let entries = words("GLBS", &gloss.vectors);
        let scales = stored("vector scales", bytemuck::cast_slice(&layout.scales.vectors));
        let weights = words("GLWT", &gloss.weights);
        let weight_scales = stored("weight scales", bytemuck::cast_slice(&layout.scales.weights));
        let members = stored("GLPT", bytemuck::cast_slice(&members));
        let of_vectors = [&entries, &scales, &sky, &lit];
        let (link_offsets, links) = (&gloss.links.offsets, &gloss.links.links);
        let link_offsets = stored("GLLO", bytemuck::cast_slice(link_offsets));
        let links = stored("GLLK", bytemuck::cast_slice(links));
        let emission = empty_buffer(&own, "reflected emission", storage, 16 * layout.emission.len() as u64);
        let of_links = [&members, &upload.points, &link_offsets, &links, sent, &emission, &arriving];
        let (offsets, rows) = (&upload.push_offsets, &upload.push_entries);
        let of_points = [&members, &weights, &weight_scales, &lit, offsets, rows, &places, &arriving];
        Ok(Some(Self {
            vectors: make("light vectors", &kernels.vectors.0, &of_vectors),
            arrive: make("arrive", &kernels.arrive.0, &of_points),
            links: make("gloss links", &kernels.links.0, &of_links),
            emission,
            layout: layout.clone(),
            places,
            arriving,
            sky,
            plan,
            lit_by: RefCell::default(),
            own,
        }))
    }

    /// Applies the transfer to distant light, and to what the senders send, after a change of either. `emission` is the factor
    /// of each group of emissive surfaces.
    pub fn light(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        kernels: &GlossKernels,
        sky: &Coefficients,
        emission: &[Vec3],
    ) {
        let has_links = self.plan.iter().any(|(kernel, _)| *kernel == GlossKernel::Links);
        let mut lit_by = self.lit_by.borrow_mut();
        let is_same_sky = lit_by.as_deref() == Some(sky);
        if is_same_sky && !has_links {
            return;
        }
        *lit_by = Some(Box::new(*sky));
        let rows: Vec<[f32; 4]> = sky.iter().map(|c| c.extend(0.0).to_array()).collect();
        gpu.queue.write_buffer(&self.sky, 0, bytemuck::cast_slice(&rows));
        let radiance = self.layout.emission.iter().zip(emission);
        let radiance = radiance.map(|(radiance, factor)| (Vec3::from(*radiance) * *factor).extend(0.0));
        let radiance: Vec<[f32; 4]> = radiance.map(|row| row.to_array()).collect();
        gpu.queue.write_buffer(&self.emission, 0, bytemuck::cast_slice(&radiance));
        let mut pass = encoder.begin_compute_pass(&Default::default());
        for (i, (kernel, [x, y])) in self.plan.iter().enumerate() {
            let ((_, pipeline), bind) = match kernel {
                GlossKernel::Vectors if is_same_sky => continue,
                GlossKernel::Vectors => (&kernels.vectors, &self.vectors),
                GlossKernel::Arrive => (&kernels.arrive, &self.arrive),
                GlossKernel::Links => (&kernels.links, &self.links),
            };
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, bind, &[(i as u64 * STRIDE) as u32]);
            pass.dispatch_workgroups(*x, *y, 1);
        }
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes()
    }
}

/// Uniforms of the dispatches, and the dispatches: over the vectors, then over each level of points, and over those with links.
fn dispatches(scene: &BakedScene, vectors: u32) -> (Vec<GlossUniform>, Vec<(GlossKernel, [u32; 2])>) {
    let gloss = &scene.gloss;
    let (mut passes, mut plan) = (Vec::new(), Vec::new());
    let mut push = |kernel: GlossKernel, range: Range<usize>, threads: usize| {
        let [x, y] = grid((threads as u32).div_ceil(WORKGROUP));
        passes.push(GlossUniform {
            first: range.start as u32,
            count: range.len() as u32,
            groups: x,
            channels: gloss.layout.channels,
            components: gloss.layout.scales.components,
            vectors,
            points: scene.points.len() as u32,
            pad: 0,
        });
        plan.push((kernel, [x, y]));
    };
    if vectors > 0 {
        push(GlossKernel::Vectors, 0..0, vectors as usize * COUNT);
    }
    let before = |end: usize| gloss.points.partition_point(|point| (*point as usize) < end);
    for level in (0..scene.meta.levels.len()).map(|l| scene.level(l)) {
        let range = before(level.start)..before(level.end);
        if range.is_empty() {
            continue;
        }
        push(GlossKernel::Arrive, range.clone(), range.len() * COUNT);
        let linked = range.start..range.end.min(gloss.links.len());
        if linked.clone().any(|place| !gloss.links.row(place).is_empty()) {
            push(GlossKernel::Links, linked.clone(), linked.len());
        }
    }
    (passes, plan)
}
