//! Light of a lightmap on the visible surfaces: the scene is drawn once more over the depth of the G-buffer.

use super::gbuffer::GBuffer;
use crate::gpu::Gpu;
use crate::gpu::bindings::{Draw, Slot, attachment, depth_attachment, group, layout, opaque, target};
use crate::gpu::scope::Scope;
use crate::scene::draw_batch::VERTEX_BUFFERS;
use crate::scene::lightmap::{CHART_BUFFERS, GpuLightmap, LightmapLayoutCell};
use crate::scene::upload::Upload;
use crate::shaders;
use std::cell::OnceCell;
use wgpu::{CompareFunction, ShaderStages, TextureFormat};

/// Format of the picture: light may be very bright.
const LIGHT: TextureFormat = TextureFormat::Rgba32Float;

/// The pipelines, without and with back-face culling; made on first use.
#[derive(Default)]
pub struct LightmapPass {
    /// The layout of [`GpuLightmap::group`].
    pub layout: LightmapLayoutCell,
    frame: OnceCell<wgpu::BindGroupLayout>,
    pipelines: [OnceCell<wgpu::RenderPipeline>; 2],
}

/// Irradiance of the pixels of one picture size.
pub struct LightmapTarget {
    /// RGB irradiance; alpha: 1 where the surface has a chart.
    pub picture: wgpu::TextureView,
    frame: wgpu::BindGroup,
}

impl LightmapPass {
    fn frame_layout(&self, gpu: &Gpu) -> &wgpu::BindGroupLayout {
        self.frame
            .get_or_init(|| layout(gpu, "lightmap frame", ShaderStages::VERTEX_FRAGMENT, &[Slot::Uniform]))
    }

    /// The picture of this size, in pixels, for a camera's `Frame`.
    pub fn target(&self, gpu: &Gpu, scope: &Scope, frame: &wgpu::Buffer, size: [u32; 2]) -> LightmapTarget {
        LightmapTarget {
            picture: target(scope, "lightmap picture", LIGHT, size[0], size[1])
                .create_view(&Default::default()),
            frame: group(gpu, "lightmap frame", self.frame_layout(gpu), &[frame.as_entire_binding()]),
        }
    }

    fn pipeline(&self, gpu: &Gpu, one_sided: bool) -> Option<&wgpu::RenderPipeline> {
        let layouts = [self.frame_layout(gpu), self.layout.get()?];
        let [vertices, instances] = VERTEX_BUFFERS;
        let [coordinates, offsets] = CHART_BUFFERS;
        Some(self.pipelines[one_sided as usize].get_or_init(|| {
            Draw {
                label: "lightmap",
                source: shaders::LIGHTMAP,
                targets: &[opaque(LIGHT)],
                layouts: &layouts,
                buffers: &[vertices, instances, coordinates, offsets],
                depth: Some((CompareFunction::Equal, false)),
                cull: one_sided,
                ..Default::default()
            }
            .pipeline(gpu)
        }))
    }

    /// Draws the light, after the G-buffer and after a change of the strengths.
    pub fn draw(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &LightmapTarget,
        gbuffer: &GBuffer,
        upload: &Upload,
        lightmap: &GpuLightmap,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("lightmap"),
            color_attachments: &[attachment(&target.picture, true)],
            depth_stencil_attachment: depth_attachment(&gbuffer.depth, false),
            ..Default::default()
        });
        pass.set_bind_group(0, &target.frame, &[]);
        lightmap.bind(&mut pass, upload);
        for run in &upload.runs {
            if let Some(pipeline) = self.pipeline(gpu, run.one_sided) {
                pass.set_pipeline(pipeline);
                run.draw(&mut pass);
            }
        }
    }
}
