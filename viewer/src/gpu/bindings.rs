//! Helpers for bind groups, buffers and pipelines.

use super::device::Gpu;
use super::scope::Scope;
use crate::shaders::Source;
use std::num::NonZeroU64;
use wgpu::ShaderStages;

/// Type of a binding.
#[derive(Clone, Copy, Debug)]
pub enum Slot {
    /// A uniform buffer.
    Uniform,
    /// A uniform buffer with a dynamic offset; size of a part in bytes.
    UniformPart(u64),
    /// A read-only storage buffer.
    Read,
    /// A read-write storage buffer.
    Write,
    /// A float texture, sampled with filtering.
    Texture,
    /// A float texture of any float format, read by texel loads.
    TextureLoad,
    /// An unsigned-integer texture.
    TextureUint,
    /// A depth texture.
    Depth,
    /// An array of depth textures.
    DepthArray,
    /// An array of float textures, sampled with filtering.
    TextureArray,
    /// An array of float cubes, sampled with filtering.
    #[cfg(feature = "radiosity")]
    CubeArray,
    /// An array of float cubes of any float format, sampled without filtering.
    #[cfg(feature = "radiosity")]
    UnfilteredCubeArray,
    /// An array of float textures of this format, written.
    #[cfg(feature = "radiosity")]
    WriteArray(wgpu::TextureFormat),
    /// A filtering sampler.
    Sampler,
    /// A comparison sampler.
    Comparison,
    /// A non-filtering sampler.
    Unfiltered,
}

impl Slot {
    fn binding_type(self) -> wgpu::BindingType {
        use wgpu::{
            BindingType, BufferBindingType, SamplerBindingType, TextureSampleType, TextureViewDimension,
        };
        let buffer = |ty, part: Option<NonZeroU64>| BindingType::Buffer {
            ty,
            has_dynamic_offset: part.is_some(),
            min_binding_size: part,
        };
        let texture = |sample_type, view_dimension| BindingType::Texture {
            sample_type,
            view_dimension,
            multisampled: false,
        };
        let d2 = TextureViewDimension::D2;
        match self {
            Self::Uniform => buffer(BufferBindingType::Uniform, None),
            Self::UniformPart(bytes) => buffer(BufferBindingType::Uniform, NonZeroU64::new(bytes)),
            Self::Read => buffer(BufferBindingType::Storage { read_only: true }, None),
            Self::Write => buffer(BufferBindingType::Storage { read_only: false }, None),
            Self::Texture => texture(TextureSampleType::Float { filterable: true }, d2),
            Self::TextureLoad => texture(TextureSampleType::Float { filterable: false }, d2),
            Self::TextureUint => texture(TextureSampleType::Uint, d2),
            Self::Depth => texture(TextureSampleType::Depth, d2),
            Self::DepthArray => texture(TextureSampleType::Depth, TextureViewDimension::D2Array),
            Self::TextureArray => {
                texture(TextureSampleType::Float { filterable: true }, TextureViewDimension::D2Array)
            }
            #[cfg(feature = "radiosity")]
            Self::CubeArray => {
                texture(TextureSampleType::Float { filterable: true }, TextureViewDimension::CubeArray)
            }
            #[cfg(feature = "radiosity")]
            Self::UnfilteredCubeArray => {
                texture(TextureSampleType::Float { filterable: false }, TextureViewDimension::CubeArray)
            }
            #[cfg(feature = "radiosity")]
            Self::WriteArray(format) => BindingType::StorageTexture {
                access: wgpu::StorageTextureAccess::WriteOnly,
                format,
                view_dimension: TextureViewDimension::D2Array,
            },
            Self::Sampler => BindingType::Sampler(SamplerBindingType::Filtering),
            Self::Comparison => BindingType::Sampler(SamplerBindingType::Comparison),
            Self::Unfiltered => BindingType::Sampler(SamplerBindingType::NonFiltering),
        }
    }
}

/// Creates the layout of a bind group with bindings numbered from 0.
pub fn layout(gpu: &Gpu, label: &str, visibility: ShaderStages, slots: &[Slot]) -> wgpu::BindGroupLayout {
    let entries: Vec<_> = slots
        .iter()
        .enumerate()
        .map(|(i, slot)| wgpu::BindGroupLayoutEntry {
            binding: i as u32,
            visibility,
            ty: slot.binding_type(),
            count: None,
        })
        .collect();
    gpu.device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// Creates a bind group with bindings numbered from 0.
pub fn group(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    let entries: Vec<_> = resources
        .iter()
        .enumerate()
        .map(|(i, resource)| wgpu::BindGroupEntry { binding: i as u32, resource: resource.clone() })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

/// A sampler with linear filtering.
pub fn bilinear(gpu: &Gpu) -> wgpu::Sampler {
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    })
}

/// A sampler of panoramas: trilinear, and repeating in u.
pub fn around(gpu: &Gpu) -> wgpu::Sampler {
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        address_mode_u: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}

/// A view as a binding.
pub fn view(view: &wgpu::TextureView) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::TextureView(view)
}

/// A part of a uniform buffer, for dynamic offsets.
pub fn part(buffer: &wgpu::Buffer, bytes: u64) -> wgpu::BindingResource<'_> {
    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: 0, size: NonZeroU64::new(bytes) })
}

/// A buffer with these bytes, at least 32 bytes long; the rest is zero.
pub fn buffer(scope: &Scope, label: &str, usage: wgpu::BufferUsages, bytes: &[u8]) -> wgpu::Buffer {
    let buffer = empty_buffer(scope, label, usage | wgpu::BufferUsages::COPY_DST, bytes.len() as u64);
    if !bytes.is_empty() {
        scope.queue.write_buffer(&buffer, 0, bytes);
    }
    buffer
}

/// A buffer of zeros, large enough for a record of any kind.
pub fn empty_buffer(scope: &Scope, label: &str, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
    scope.buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size.max(32).next_multiple_of(4),
        usage,
        mapped_at_creation: false,
    })
}

/// A 2D texture with one mip level.
pub fn target(
    scope: &Scope,
    label: &str,
    format: wgpu::TextureFormat,
    width: u32,
    height: u32,
) -> wgpu::Texture {
    scope.texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_DST
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

/// The parts of a module together; less code for the page than `concat`, and than a copy for each module.
#[inline(never)]
fn joined(source: Source) -> String {
    let mut whole = String::new();
    source.iter().for_each(|part| whole += part);
    whole
}

/// A shader module.
pub fn module(gpu: &Gpu, label: &str, source: Source) -> wgpu::ShaderModule {
    gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(joined(source).into()),
    })
}

/// A compute pipeline with these bind groups and override constants.
pub fn compute(
    gpu: &Gpu,
    entry: &str,
    source: Source,
    layouts: &[&wgpu::BindGroupLayout],
    constants: &[(&str, f64)],
) -> wgpu::ComputePipeline {
    gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry),
        layout: Some(&pipeline_layout(gpu, layouts)),
        module: &module(gpu, entry, source),
        entry_point: Some(entry),
        compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
        cache: None,
    })
}

/// A compute pipeline with the layout of its bind group.
#[cfg(feature = "radiosity")]
pub type ComputeKernel = (wgpu::BindGroupLayout, wgpu::ComputePipeline);

/// A [`ComputeKernel`] with a uniform, then storage buffers that are read, then those that are written.
#[cfg(feature = "radiosity")]
pub fn kernel(
    gpu: &Gpu,
    entry: &str,
    source: Source,
    (uniform, reads, writes): (Slot, usize, usize),
    constants: &[(&str, f64)],
) -> ComputeKernel {
    let mut slots = vec![uniform];
    slots.extend(std::iter::repeat_n(Slot::Read, reads));
    slots.extend(std::iter::repeat_n(Slot::Write, writes));
    let layout = layout(gpu, entry, ShaderStages::COMPUTE, &slots);
    let pipeline = compute(gpu, entry, source, &[&layout], constants);
    (layout, pipeline)
}

/// Threads of a workgroup in one-dimensional shaders.
pub const WORKGROUP: u32 = 64;
/// Maximum number of workgroups in one dimension of a dispatch that WebGPU guarantees.
const MAX_GROUPS: u32 = 65535;

/// Workgroups in x and y, at least `groups` in total, within WebGPU's limits.
pub fn grid(groups: u32) -> [u32; 2] {
    if groups <= MAX_GROUPS { [groups, 1] } else { [MAX_GROUPS, groups.div_ceil(MAX_GROUPS)] }
}

/// Parameters of a render pipeline that differ between the viewer's passes.
pub struct Draw<'a> {
    /// Name.
    pub label: &'a str,
    /// WGSL.
    pub source: Source,
    /// Vertex entry point.
    pub vertex: &'a str,
    /// Fragment entry point, if present.
    pub fragment: Option<&'a str>,
    /// Colour targets.
    pub targets: &'a [wgpu::ColorTargetState],
    /// Bind groups.
    pub layouts: &'a [&'a wgpu::BindGroupLayout],
    /// Vertex buffers.
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    /// Triangle strips instead of lists.
    pub strip: bool,
    /// Depth test: comparison and whether depth is written.
    pub depth: Option<(wgpu::CompareFunction, bool)>,
    /// Whether clockwise triangles are culled.
    pub cull: bool,
}

impl Draw<'_> {
    /// Creates the pipeline.
    pub fn pipeline(&self, gpu: &Gpu) -> wgpu::RenderPipeline {
        let module = module(gpu, self.label, self.source);
        let targets: Vec<_> = self.targets.iter().cloned().map(Some).collect();
        gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: Some(&pipeline_layout(gpu, self.layouts)),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(self.vertex),
                compilation_options: Default::default(),
                buffers: self.buffers,
            },
            primitive: wgpu::PrimitiveState {
                topology: if self.strip {
                    wgpu::PrimitiveTopology::TriangleStrip
                } else {
                    wgpu::PrimitiveTopology::TriangleList
                },
                cull_mode: self.cull.then_some(wgpu::Face::Back),
                ..Default::default()
            },
            depth_stencil: self.depth.map(|(compare, write)| wgpu::DepthStencilState {
                format: wgpu::TextureFormat::Depth32Float,
                depth_write_enabled: Some(write),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: self.fragment.map(|entry| wgpu::FragmentState {
                module: &module,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

impl Default for Draw<'_> {
    fn default() -> Self {
        Self {
            label: "",
            source: &[],
            vertex: "vertex",
            fragment: Some("fragment"),
            targets: &[],
            layouts: &[],
            buffers: &[],
            strip: false,
            depth: None,
            cull: false,
        }
    }
}

/// A target without blending.
pub fn opaque(format: wgpu::TextureFormat) -> wgpu::ColorTargetState {
    wgpu::ColorTargetState { format, blend: None, write_mask: wgpu::ColorWrites::ALL }
}

/// A target with blending.
pub fn blended(format: wgpu::TextureFormat, blend: wgpu::BlendState) -> wgpu::ColorTargetState {
    wgpu::ColorTargetState { format, blend: Some(blend), write_mask: wgpu::ColorWrites::ALL }
}

/// A colour attachment, cleared to zeros or kept.
pub fn attachment(view: &wgpu::TextureView, clear: bool) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let load = if clear { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load };
    Some(wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
    })
}

/// A depth attachment, cleared to 0 and written, or read-only.
pub fn depth_attachment(
    view: &wgpu::TextureView,
    write: bool,
) -> Option<wgpu::RenderPassDepthStencilAttachment<'_>> {
    let write =
        write.then_some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store });
    Some(wgpu::RenderPassDepthStencilAttachment { view, depth_ops: write, stencil_ops: None })
}

fn pipeline_layout(gpu: &Gpu, layouts: &[&wgpu::BindGroupLayout]) -> wgpu::PipelineLayout {
    let layouts: Vec<_> = layouts.iter().map(|&l| Some(l)).collect();
    gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &layouts,
        immediate_size: 0,
    })
}
