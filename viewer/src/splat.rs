//! Splatting: the display basis is drawn function by function, and adds up in each pixel. Pixels
//! that no function of the finest level covers take the finest coarser level that does.

use crate::bindings::{
    Draw, Slot, attachment, blended, depth_attachment, empty_buffer, group, layout, target, texture_bytes,
    view,
};
use crate::gbuffer::GBuffer;
use crate::gpu::Gpu;
use crate::shaders;
use crate::timing::Stamps;
use crate::upload::Upload;
use std::ops::Range;
use wgpu::{BufferUsages, CompareFunction, ShaderStages, TextureFormat};

const ADD: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::One,
    dst_factor: wgpu::BlendFactor::One,
    operation: wgpu::BlendOperation::Add,
};

/// The pipelines.
pub struct SplatPass {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
    holes_layout: wgpu::BindGroupLayout,
    holes: wgpu::RenderPipeline,
    format: TextureFormat,
    /// `Splat` in splat.wgsl: the factor on irradiance.
    uniform: wgpu::Buffer,
}

/// Targets of one size.
pub struct SplatTarget {
    /// Σ w (n·V) and, in alpha, Σ w.
    pub sums: wgpu::TextureView,
    /// Depth of the pixels that nothing has covered yet, 1 elsewhere.
    holes: wgpu::TextureView,
    holes_group: wgpu::BindGroup,
    /// Bytes of the textures.
    pub bytes: u64,
}

impl SplatPass {
    /// Makes the pipelines. Sums are kept in 32 bits where the device can blend them, else in 16.
    pub fn new(gpu: &Gpu) -> Self {
        let format =
            if gpu.float32_blendable { TextureFormat::Rgba32Float } else { TextureFormat::Rgba16Float };
        let stages = ShaderStages::VERTEX_FRAGMENT;
        let layout_ = layout(
            gpu,
            "splat",
            stages,
            &[
                Slot::Uniform,
                Slot::Uniform,
                Slot::Read,
                Slot::Read,
                Slot::Depth,
                Slot::TextureUint,
                Slot::Read,
            ],
        );
        let depth = Some((CompareFunction::Greater, false));
        let pipeline = Draw {
            label: "splat",
            source: shaders::SPLAT,
            targets: &[blended(format, wgpu::BlendState { color: ADD, alpha: ADD })],
            layouts: &[&layout_],
            strip: true,
            depth,
            ..Default::default()
        }
        .pipeline(gpu);
        let holes_layout = layout(gpu, "holes", ShaderStages::FRAGMENT, &[Slot::TextureLoad, Slot::Depth]);
        // Below this a sum of 16-bit weights has too few digits left.
        let least = if gpu.float32_blendable { 1e-7 } else { 1e-4 };
        let holes = Draw {
            label: "holes",
            source: shaders::HOLES,
            layouts: &[&holes_layout],
            depth: Some((CompareFunction::Always, true)),
            constants: &[("LEAST_WEIGHT", least)],
            ..Default::default()
        }
        .pipeline(gpu);
        let uniform = empty_buffer(gpu, "splat scale", BufferUsages::UNIFORM | BufferUsages::COPY_DST, 16);
        Self { layout: layout_, pipeline, holes_layout, holes, format, uniform }
    }

    /// Targets of this size, for the pixels of `gbuffer`.
    pub fn target(&self, gpu: &Gpu, gbuffer: &GBuffer, width: u32, height: u32) -> SplatTarget {
        let sums = target(gpu, "splat sums", self.format, width, height);
        let holes = target(gpu, "holes", TextureFormat::Depth32Float, width, height);
        let bytes = texture_bytes(&sums) + texture_bytes(&holes);
        let sums = sums.create_view(&Default::default());
        let holes_group = group(gpu, "holes", &self.holes_layout, &[view(&sums), view(&gbuffer.depth)]);
        SplatTarget { sums, holes: holes.create_view(&Default::default()), holes_group, bytes }
    }

    /// The bind groups for a picture's `Frame`, a scene's points, their cuts and values: for the pixels of the
    /// G-buffer, and for those that are still holes.
    pub fn groups(
        &self,
        gpu: &Gpu,
        frame: &wgpu::Buffer,
        upload: &Upload,
        values: &wgpu::Buffer,
        gbuffer: &GBuffer,
        target: &SplatTarget,
    ) -> [wgpu::BindGroup; 2] {
        [&gbuffer.depth, &target.holes].map(|depth| {
            let resources = [
                frame.as_entire_binding(),
                self.uniform.as_entire_binding(),
                upload.points.as_entire_binding(),
                values.as_entire_binding(),
                view(depth),
                view(&gbuffer.surface),
                upload.cuts.as_entire_binding(),
            ];
            group(gpu, "splat", &self.layout, &resources)
        })
    }

    /// Sets the factor on irradiance that keeps sums within the target's range.
    pub fn set_scale(&self, gpu: &Gpu, scale: f32) {
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&[scale, 0.0, 0.0, 0.0]));
    }

    /// Draws the finest of `levels` (ranges of points, coarsest first) and fills holes from the
    /// coarser ones.
    pub fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &SplatTarget,
        gbuffer: &GBuffer,
        groups: &[wgpu::BindGroup; 2],
        levels: &[Range<u32>],
        stamps: Option<Stamps<'_>>,
    ) {
        let passes = levels.len();
        for (i, level) in levels.iter().rev().enumerate() {
            if i > 0 {
                let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                    label: Some("holes"),
                    depth_stencil_attachment: depth_attachment(&target.holes, true),
                    ..Default::default()
                });
                pass.set_pipeline(&self.holes);
                pass.set_bind_group(0, &target.holes_group, &[]);
                pass.draw(0..3, 0..1);
            }
            let (first, last) = (i == 0, i + 1 == passes);
            let stamps = stamps.filter(|_| first || last).map(|s| s.render(first, last));
            let depth = if first { &gbuffer.depth } else { &target.holes };
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("splat"),
                color_attachments: &[attachment(&target.sums, first)],
                depth_stencil_attachment: depth_attachment(depth, false),
                timestamp_writes: stamps,
                ..Default::default()
            });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &groups[!first as usize], &[]);
            pass.draw(0..4, level.clone());
        }
        if passes == 0 {
            drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("splat"),
                color_attachments: &[attachment(&target.sums, true)],
                timestamp_writes: stamps.map(|s| s.render(true, true)),
                ..Default::default()
            }));
        }
    }
}
