//! Shadow maps: a depth texture array with one layer per projection. A layer is redrawn only after a change.
//!
//! * here: the pass;
//! * `fit` – layers and projections;
//! * `cascades` – projections for the visible part of the scene;
//! * `maps` – the textures.

pub mod cascades;
pub mod fit;
pub mod maps;

use crate::gpu::Gpu;
use crate::gpu::bindings::{
    Draw, Slot, bilinear, blended, depth_attachment, empty_buffer, group, layout, part, view,
};
use crate::gpu::scope::Scope;
use crate::scene::draw_batch::{DrawBatch, VERTEX_BUFFERS};
use crate::scene::extent::Extent;
use crate::scene::upload::Upload;
use crate::shaders;
use fit::{Fit, LightRecord};
use glam::Mat4;
use maps::{Maps, TINTS};
use rebounce_shared::camera::CameraFrame;
use rebounce_shared::light::LightSource;
use std::cell::OnceCell;
use std::rc::Rc;
use wgpu::{BlendFactor, BlendOperation, BufferUsages, CompareFunction, ShaderStages};

/// Stride of matrices in the uniform buffer, bytes.
const STRIDE: u64 = 256;
const MATRIX: u64 = 64;

/// Pipelines, layouts and samplers for drawing and reading shadow maps; independent of a scene.
#[derive(Clone)]
pub struct ShadowPipelines {
    opaque: wgpu::RenderPipeline,
    cut: wgpu::RenderPipeline,
    matrix_layout: wgpu::BindGroupLayout,
    /// Pipeline for the colours of light behind glass, created for the first scene with glass, and its bind group
    /// layout.
    tint: Rc<OnceCell<(wgpu::RenderPipeline, wgpu::BindGroupLayout)>>,
    material_layout: wgpu::BindGroupLayout,
    /// Layout of [`Shadows::group`].
    pub layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    /// Sampler for raw depths, without comparison.
    depths: wgpu::Sampler,
    tints: wgpu::Sampler,
}

impl ShadowPipelines {
    /// Creates the pipelines.
    pub fn new(gpu: &Gpu, material_layout: &wgpu::BindGroupLayout) -> Self {
        let matrix_layout = layout(gpu, "shadow", ShaderStages::VERTEX, &[Slot::UniformPart(MATRIX)]);
        let stages = ShaderStages::COMPUTE | ShaderStages::FRAGMENT;
        let slots = [
            Slot::Read,
            Slot::Read,
            Slot::DepthArray,
            Slot::Comparison,
            Slot::Unfiltered,
            Slot::TextureArray,
            Slot::Sampler,
            Slot::DepthArray,
        ];
        let layout = layout(gpu, "lights", stages, &slots);
        let draw = Draw {
            label: "shadow",
            source: shaders::SHADOW,
            vertex: "opaque",
            fragment: None,
            layouts: &[&matrix_layout, material_layout],
            buffers: &VERTEX_BUFFERS,
            depth: Some((CompareFunction::Greater, true)),
            ..Default::default()
        };
        let opaque = draw.pipeline(gpu);
        let cut = Draw { vertex: "cutout", fragment: Some("cut"), ..draw }.pipeline(gpu);
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            // Lit if the surface is as close to the light as the stored depth, or closer.
            compare: Some(CompareFunction::GreaterEqual),
            ..Default::default()
        });
        let depths = gpu.device.create_sampler(&Default::default());
        Self {
            opaque,
            cut,
            matrix_layout,
            tint: Rc::default(),
            material_layout: material_layout.clone(),
            layout,
            sampler,
            depths,
            tints: bilinear(gpu),
        }
    }

    fn tint(&self, gpu: &Gpu) -> &(wgpu::RenderPipeline, wgpu::BindGroupLayout) {
        self.tint.get_or_init(|| {
            let slots = [Slot::UniformPart(MATRIX), Slot::Depth];
            let layout = layout(gpu, "tint", ShaderStages::VERTEX_FRAGMENT, &slots);
            let product = wgpu::BlendComponent {
                src_factor: BlendFactor::Zero,
                dst_factor: BlendFactor::Src,
                operation: BlendOperation::Add,
            };
            let nearest = wgpu::BlendComponent {
                src_factor: BlendFactor::One,
                dst_factor: BlendFactor::One,
                operation: BlendOperation::Max,
            };
            let draw = Draw {
                label: "tint",
                source: shaders::TINT,
                targets: &[blended(TINTS, wgpu::BlendState { color: product, alpha: nearest })],
                layouts: &[&layout, &self.material_layout],
                buffers: &VERTEX_BUFFERS,
                ..Default::default()
            };
            (draw.pipeline(gpu), layout)
        })
    }
}

/// The shadow maps of all lights, and the bind group of lights and maps for shaders.
pub struct Shadows {
    pipelines: ShadowPipelines,
    maps: Maps,
    /// Cascades of directional lights, which follow the camera.
    near: Maps,
    records: Records,
    fit: Fit,
    /// Matrices of the cascades, stored after the matrices of `fit`.
    cascades: Vec<Mat4>,
    /// The cascades' matrices on the GPU are missing or at another offset.
    unwritten: bool,
    /// Maximum width of a map, texels: [`fit::LARGEST`] unless changed by a test.
    pub largest: u32,
    /// Layers drawn so far.
    pub drawn: u64,
}

impl Shadows {
    /// Without lights.
    pub fn new(gpu: &Gpu, pipelines: &ShadowPipelines) -> Self {
        let [maps, near] = [(); 2].map(|()| Maps::new(gpu, 1, 1, false));
        Self {
            pipelines: pipelines.clone(),
            records: Records::new(gpu, pipelines, &maps, &near, 1),
            maps,
            near,
            fit: Fit::default(),
            cascades: Vec::new(),
            unwritten: false,
            largest: fit::LARGEST,
            drawn: 0,
        }
    }

    /// Lights and shadow maps: group 1 of visibility.wgsl.
    pub fn group(&self) -> &wgpu::BindGroup {
        &self.records.group
    }

    /// The lights' records for shaders.
    pub fn lights(&self) -> &[LightRecord] {
        &self.fit.lights
    }

    /// Sets the lights, of a scene with or without `glass`; returns the layers to draw.
    pub fn set_lights(
        &mut self,
        gpu: &Gpu,
        lights: &[LightSource],
        extent: &Extent,
        near: f32,
        glass: bool,
    ) -> Vec<u32> {
        let layers: u32 = lights.iter().map(|light| extent.layers(light)).sum();
        let size = fit::size(layers, glass).min(self.largest);
        let fit = fit::fit(lights, extent, near, size);
        let held = self.maps.layers.len() as u32;
        let replaced =
            self.maps.texture.width() != size || held < layers.max(1) || self.maps.tints.is_empty() == glass;
        if replaced {
            self.maps = Maps::new(gpu, size, layers.max(1), glass);
        }
        let views = layers + fit::CASCADES * fit.lights.iter().filter_map(LightRecord::sun).count() as u32;
        let moves = self.fit.matrices.len() != fit.matrices.len();
        let refit = replaced || self.records.capacity < views;
        self.unwritten |= refit || moves;
        if refit {
            let capacity = views.max(1).next_power_of_two();
            self.records = Records::new(gpu, &self.pipelines, &self.maps, &self.near, capacity);
        }
        self.records.write(gpu, &fit);
        let is_new =
            |l: &u32| replaced || self.fit.matrices.get(*l as usize) != fit.matrices.get(*l as usize);
        let changed = (0..layers).filter(is_new).collect();
        self.fit = fit;
        changed
    }

    /// Fits the cascades of directional lights to a camera and a picture size; returns the layers to draw.
    pub fn follow(
        &mut self,
        gpu: &Gpu,
        camera: &CameraFrame,
        picture: [u32; 2],
        extent: &Extent,
    ) -> Vec<u32> {
        let suns: Vec<_> = self.fit.lights.iter().filter_map(LightRecord::sun).collect();
        if suns.is_empty() {
            return Vec::new();
        }
        let size = cascades::size(suns.len() as u32, picture[1], self.size()).min(self.largest);
        let seen = cascades::Seen::new(camera, picture);
        let matrices: Vec<_> = suns.iter().flat_map(|sun| cascades::fit(*sun, extent, &seen, size)).collect();
        let first = self.fit.matrices.len();
        if self.near.texture.width() != size || self.near.layers.len() < matrices.len() {
            self.near = Maps::new(gpu, size, matrices.len() as u32, false);
            self.records = Records::new(gpu, &self.pipelines, &self.maps, &self.near, self.records.capacity);
            self.records.write(gpu, &self.fit);
            self.cascades.clear();
        }
        let is_new = |i: &usize| self.cascades.get(*i) != Some(&matrices[*i]);
        let changed: Vec<_> = (0..matrices.len()).filter(is_new).map(|i| (first + i) as u32).collect();
        if std::mem::take(&mut self.unwritten) || !changed.is_empty() {
            self.records.write_matrices(gpu, first, &matrices);
            self.cascades = matrices;
        }
        changed
    }

    /// Discards the contents of the maps, as after loading another scene.
    pub fn forget(&mut self) {
        self.fit = Fit::default();
        self.cascades.clear();
    }

    /// Render target of a layer.
    fn map(&self, layer: u32) -> &wgpu::TextureView {
        let (layer, far) = (layer as usize, self.fit.matrices.len());
        if layer < far { &self.maps.layers[layer] } else { &self.near.layers[layer - far] }
    }

    /// Draws one layer.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        upload: &Upload,
        materials: &[wgpu::BindGroup],
        layer: u32,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        self.drawn += 1;
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow"),
            depth_stencil_attachment: depth_attachment(self.map(layer), true),
            timestamp_writes: timestamps,
            ..Default::default()
        });
        upload.bind(&mut pass);
        pass.set_bind_group(0, &self.records.uniform_group, &[layer * STRIDE as u32]);
        let mut last: Option<&DrawBatch> = None;
        for run in &upload.shadow_runs {
            if last.is_none_or(|l| l.cut != run.cut) {
                pass.set_pipeline(if run.cut { &self.pipelines.cut } else { &self.pipelines.opaque });
            }
            if last.is_none_or(|l| l.material != run.material) {
                pass.set_bind_group(1, &materials[run.material as usize], &[]);
            }
            run.draw(&mut pass);
            last = Some(run);
        }
        drop(pass);
        let Some(tints) = self.maps.tints.get(layer as usize) else { return };
        let (pipeline, layout) = self.pipelines.tint(gpu);
        let resources = [part(&self.records.uniforms, MATRIX), view(&self.maps.layers[layer as usize])];
        let group = group(gpu, "tint", layout, &resources);
        let clear = wgpu::LoadOp::Clear(wgpu::Color { a: 0.0, ..wgpu::Color::WHITE });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("tint"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: tints,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: clear, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        pass.set_pipeline(pipeline);
        upload.bind(&mut pass);
        pass.set_bind_group(0, &group, &[layer * STRIDE as u32]);
        for run in &upload.glass_runs {
            pass.set_bind_group(1, &materials[run.material as usize], &[]);
            run.draw(&mut pass);
        }
    }

    /// Bytes of the maps.
    pub fn bytes(&self) -> u64 {
        self.maps.own.bytes() + self.near.own.bytes()
    }

    /// Width of a map, texels.
    pub fn size(&self) -> u32 {
        self.maps.texture.width()
    }
}

/// Light records and matrices on the GPU, for a number of shadow map layers; there are no more lights than layers.
struct Records {
    _own: Scope,
    capacity: u32,
    uniforms: wgpu::Buffer,
    uniform_group: wgpu::BindGroup,
    lights: wgpu::Buffer,
    matrices: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl Records {
    fn new(gpu: &Gpu, pipelines: &ShadowPipelines, maps: &Maps, near: &Maps, capacity: u32) -> Self {
        let own = Scope::new(gpu);
        let make = |label, usage, record: u64| {
            empty_buffer(&own, label, usage | BufferUsages::COPY_DST, record * capacity as u64)
        };
        let uniforms = make("shadow matrices", BufferUsages::UNIFORM, STRIDE);
        let lights = make("lights", BufferUsages::STORAGE, size_of::<LightRecord>() as u64);
        let matrices = make("light matrices", BufferUsages::STORAGE, MATRIX);
        let all = |texture: &wgpu::Texture| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            })
        };
        let [depths, tints, near] = [&maps.texture, &maps.tint, &near.texture].map(all);
        let resources = [
            lights.as_entire_binding(),
            matrices.as_entire_binding(),
            view(&depths),
            wgpu::BindingResource::Sampler(&pipelines.sampler),
            wgpu::BindingResource::Sampler(&pipelines.depths),
            view(&tints),
            wgpu::BindingResource::Sampler(&pipelines.tints),
            view(&near),
        ];
        Self {
            capacity,
            uniform_group: group(gpu, "shadow", &pipelines.matrix_layout, &[part(&uniforms, MATRIX)]),
            group: group(gpu, "lights", &pipelines.layout, &resources),
            uniforms,
            lights,
            matrices,
            _own: own,
        }
    }

    fn write(&self, gpu: &Gpu, fit: &Fit) {
        if fit.lights.is_empty() {
            return;
        }
        gpu.queue.write_buffer(&self.lights, 0, bytemuck::cast_slice(&fit.lights));
        self.write_matrices(gpu, 0, &fit.matrices);
    }

    /// Writes the matrices of layers from `first` on.
    fn write_matrices(&self, gpu: &Gpu, first: usize, matrices: &[Mat4]) {
        let mut spread = vec![0u8; STRIDE as usize * matrices.len()];
        for (part, matrix) in spread.chunks_mut(STRIDE as usize).zip(matrices) {
            part[..MATRIX as usize].copy_from_slice(bytemuck::bytes_of(matrix));
        }
        gpu.queue.write_buffer(&self.uniforms, STRIDE * first as u64, &spread);
        gpu.queue.write_buffer(&self.matrices, MATRIX * first as u64, bytemuck::cast_slice(matrices));
    }
}
