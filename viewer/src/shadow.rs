//! Shadow maps: a depth texture array, one layer a view. Only what changed is drawn again.

use crate::bindings::{Draw, Slot, buffer, depth_attachment, empty_buffer, group, layout, part, view};
use crate::gpu::Gpu;
use crate::shaders;
use crate::shadow_fit::{self, Fit, LightRecord};
use crate::upload::{Run, Upload};
use glam::{Mat4, Vec3};
use rebounce_shared::light::LightSource;
use wgpu::{BufferUsages, CompareFunction, ShaderStages};

/// Distance of matrices in the uniform buffer, bytes.
const STRIDE: u64 = 256;
const MATRIX: u64 = 64;

/// Position, normal and texture coordinates of [`rebounce_shared::rbn::bulk::Vertex`].
pub const VERTEX: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 24,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &[
        wgpu::VertexAttribute { format: wgpu::VertexFormat::Float32x3, offset: 0, shader_location: 0 },
        wgpu::VertexAttribute { format: wgpu::VertexFormat::Snorm16x2, offset: 12, shader_location: 1 },
        wgpu::VertexAttribute { format: wgpu::VertexFormat::Float32x2, offset: 16, shader_location: 2 },
    ],
};

/// The shadow maps of all lights, and the bind group with which shaders see lights and maps.
pub struct Shadows {
    opaque: wgpu::RenderPipeline,
    cut: wgpu::RenderPipeline,
    matrix_layout: wgpu::BindGroupLayout,
    /// Layout of [`Shadows::group`].
    pub layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    maps: wgpu::Texture,
    views: Vec<wgpu::TextureView>,
    uniforms: wgpu::Buffer,
    uniform_group: wgpu::BindGroup,
    /// Lights and shadow maps: group 1 of visibility.wgsl.
    pub group: wgpu::BindGroup,
    fit: Fit,
    /// Widest map, texels: [`shadow_fit::LARGEST`] unless a test asks for another.
    pub largest: u32,
    /// Layers drawn so far.
    pub drawn: u64,
}

impl Shadows {
    /// Without lights.
    pub fn new(gpu: &Gpu, material_layout: &wgpu::BindGroupLayout) -> Self {
        let matrix_layout = layout(gpu, "shadow", ShaderStages::VERTEX, &[Slot::UniformPart(MATRIX)]);
        let stages = ShaderStages::COMPUTE | ShaderStages::FRAGMENT;
        let layout =
            layout(gpu, "lights", stages, &[Slot::Read, Slot::Read, Slot::DepthArray, Slot::Comparison]);
        let draw = Draw {
            label: "shadow",
            source: shaders::SHADOW,
            vertex: "opaque",
            fragment: None,
            layouts: &[&matrix_layout, material_layout],
            buffers: &[Some(VERTEX)],
            depth: Some((CompareFunction::Greater, true)),
            ..Default::default()
        };
        let opaque = draw.pipeline(gpu);
        let cut = Draw { vertex: "cutout", fragment: Some("cut"), ..draw }.pipeline(gpu);
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            // Lit where the surface is as near to the light as what the map holds, or nearer.
            compare: Some(CompareFunction::GreaterEqual),
            ..Default::default()
        });
        let maps = texture(gpu, 1, 1);
        let (uniforms, uniform_group) = uniforms(gpu, &matrix_layout, &[]);
        let group = lights_group(gpu, &layout, &sampler, &maps, &Fit::default());
        Self {
            opaque,
            cut,
            matrix_layout,
            layout,
            sampler,
            views: Vec::new(),
            maps,
            uniforms,
            uniform_group,
            group,
            fit: Fit::default(),
            largest: shadow_fit::LARGEST,
            drawn: 0,
        }
    }

    /// Takes new lights; returns the layers that must be drawn.
    pub fn set_lights(
        &mut self,
        gpu: &Gpu,
        lights: &[LightSource],
        bounds: [Vec3; 2],
        near: f32,
    ) -> Vec<u32> {
        let layers: u32 = lights.iter().map(shadow_fit::layers).sum();
        let size = shadow_fit::size(layers).min(self.largest);
        let fit = shadow_fit::fit(lights, bounds, near, size);
        // At first there are maps without views: the scene before the first light.
        let held = self.views.len() as u32;
        let replaced = self.maps.width() != size || held < layers.max(1);
        if replaced {
            self.maps = texture(gpu, size, layers.max(1));
            self.views = (0..layers.max(1))
                .map(|base_array_layer| {
                    self.maps.create_view(&wgpu::TextureViewDescriptor {
                        dimension: Some(wgpu::TextureViewDimension::D2),
                        base_array_layer,
                        array_layer_count: Some(1),
                        ..Default::default()
                    })
                })
                .collect();
        }
        let changed: Vec<u32> = (0..layers)
            .filter(|&l| replaced || self.fit.matrices.get(l as usize) != Some(&fit.matrices[l as usize]))
            .collect();
        if replaced || !changed.is_empty() || self.fit.matrices.len() != fit.matrices.len() {
            (self.uniforms, self.uniform_group) = uniforms(gpu, &self.matrix_layout, &fit.matrices);
        }
        self.group = lights_group(gpu, &self.layout, &self.sampler, &self.maps, &fit);
        self.fit = fit;
        changed
    }

    /// Forgets what the maps hold, as after loading another scene.
    pub fn forget(&mut self) {
        self.fit = Fit::default();
    }

    /// Draws one layer.
    pub fn draw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        upload: &Upload,
        materials: &[wgpu::BindGroup],
        layer: u32,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        self.drawn += 1;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow"),
            depth_stencil_attachment: depth_attachment(&self.views[layer as usize], true),
            timestamp_writes: timestamps,
            ..Default::default()
        });
        if upload.runs.is_empty() {
            return;
        }
        pass.set_vertex_buffer(0, upload.vertices.slice(..));
        pass.set_index_buffer(upload.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.set_bind_group(0, &self.uniform_group, &[layer * STRIDE as u32]);
        let mut last: Option<&Run> = None;
        for run in &upload.shadow_runs {
            if last.is_none_or(|l| l.cut != run.cut) {
                pass.set_pipeline(if run.cut { &self.cut } else { &self.opaque });
            }
            if last.is_none_or(|l| l.material != run.material) {
                pass.set_bind_group(1, &materials[run.material as usize], &[]);
            }
            pass.draw_indexed(run.indices.clone(), 0, 0..1);
            last = Some(run);
        }
    }

    /// Bytes of the maps.
    pub fn bytes(&self) -> u64 {
        crate::bindings::texture_bytes(&self.maps)
    }

    /// Width of a map, texels.
    pub fn size(&self) -> u32 {
        self.maps.width()
    }
}

fn texture(gpu: &Gpu, size: u32, layers: u32) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("shadow maps"),
        size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Depth32Float,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })
}

fn uniforms(gpu: &Gpu, layout: &wgpu::BindGroupLayout, matrices: &[Mat4]) -> (wgpu::Buffer, wgpu::BindGroup) {
    let uniforms = empty_buffer(
        gpu,
        "shadow matrices",
        BufferUsages::UNIFORM | BufferUsages::COPY_DST,
        STRIDE * matrices.len().max(1) as u64,
    );
    for (i, matrix) in matrices.iter().enumerate() {
        gpu.queue.write_buffer(&uniforms, i as u64 * STRIDE, bytemuck::bytes_of(matrix));
    }
    let group = group(gpu, "shadow", layout, &[part(&uniforms, MATRIX)]);
    (uniforms, group)
}

fn lights_group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    sampler: &wgpu::Sampler,
    maps: &wgpu::Texture,
    fit: &Fit,
) -> wgpu::BindGroup {
    // Never empty: a binding must hold at least one record.
    let mut lights = fit.lights.clone();
    lights.resize(lights.len().max(1), <LightRecord as bytemuck::Zeroable>::zeroed());
    let mut matrices = fit.matrices.clone();
    matrices.resize(matrices.len().max(1), Mat4::IDENTITY);
    let lights = buffer(gpu, "lights", BufferUsages::STORAGE, bytemuck::cast_slice(&lights));
    let matrices = buffer(gpu, "light matrices", BufferUsages::STORAGE, bytemuck::cast_slice(&matrices));
    let maps = maps.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    });
    let resources = [
        lights.as_entire_binding(),
        matrices.as_entire_binding(),
        view(&maps),
        wgpu::BindingResource::Sampler(sampler),
    ];
    group(gpu, "lights", layout, &resources)
}
