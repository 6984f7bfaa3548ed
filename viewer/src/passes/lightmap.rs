//! Light of a lightmap on the visible surfaces: the scene is drawn once more over the depth of the G-buffer.

use super::gbuffer::GBuffer;
use crate::gpu::Gpu;
use crate::gpu::bindings::{Draw, attachment, depth_attachment, opaque, target};
use crate::gpu::scope::Scope;
use crate::scene::draw_batch::VERTEX_BUFFERS;
use crate::scene::lightmap::{CHART_BUFFERS, GpuLightmap, LightmapLayoutCell};
use crate::scene::upload::Upload;
use crate::shaders;
use std::cell::OnceCell;
use wgpu::{CompareFunction, TextureFormat};

/// Format of the picture: light may be very bright.
const LIGHT: TextureFormat = TextureFormat::Rgba32Float;

/// The pipelines, without and with back-face culling; made on first use.
#[derive(Default)]
pub struct LightmapPass {
    /// The layout of [`GpuLightmap::group`].
    pub layout: LightmapLayoutCell,
    pipelines: [OnceCell<wgpu::RenderPipeline>; 2],
}

/// The picture of this size, in pixels: RGB irradiance; alpha: 1 where the surface has a chart.
pub fn picture(scope: &Scope, size: [u32; 2]) -> wgpu::TextureView {
    target(scope, "lightmap picture", LIGHT, size[0], size[1]).create_view(&Default::default())
}

impl LightmapPass {
    fn pipeline(
        &self,
        gpu: &Gpu,
        frame: &wgpu::BindGroupLayout,
        one_sided: bool,
    ) -> Option<&wgpu::RenderPipeline> {
        let layouts = [frame, self.layout.get()?];
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

    /// Draws the light to a [`picture`], after the G-buffer and after a change of the strengths. `frame` is the camera's bind
    /// group for the G-buffer, with its layout.
    #[expect(clippy::too_many_arguments, reason = "one call, one place")]
    pub fn draw(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        picture: &wgpu::TextureView,
        gbuffer: &GBuffer,
        (frame, frame_layout): (&wgpu::BindGroup, &wgpu::BindGroupLayout),
        upload: &Upload,
        lightmap: &GpuLightmap,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("lightmap"),
            color_attachments: &[attachment(picture, true)],
            depth_stencil_attachment: depth_attachment(&gbuffer.depth, false),
            ..Default::default()
        });
        pass.set_bind_group(0, frame, &[]);
        lightmap.bind(&mut pass, upload);
        for run in &upload.runs {
            if let Some(pipeline) = self.pipeline(gpu, frame_layout, run.one_sided) {
                pass.set_pipeline(pipeline);
                run.draw(&mut pass);
            }
        }
    }
}
