//! Where the file has the visible surfaces of meshes that deform: they are drawn once more over the depth of the G-buffer.

use super::gbuffer::GBuffer;
use crate::gpu::Gpu;
use crate::gpu::bindings::{Draw, attachment, depth_attachment, opaque};
use crate::scene::draw_batch::VERTEX_BUFFERS;
use crate::scene::rest_picture::REST;
use crate::scene::rig::GpuRig;
use crate::scene::upload::Upload;
use crate::shaders;
use std::cell::OnceCell;
use wgpu::CompareFunction;

/// Position and normal of the vertices at rest.
const REST_BUFFER: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 24,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![6 => Float32x3, 7 => Snorm16x2],
};

/// The pipelines, without and with back-face culling; made on first use.
#[derive(Default)]
pub struct RestPlacesPass {
    pipelines: [OnceCell<wgpu::RenderPipeline>; 2],
}

impl RestPlacesPass {
    fn pipeline(&self, gpu: &Gpu, frame: &wgpu::BindGroupLayout, one_sided: bool) -> &wgpu::RenderPipeline {
        self.pipelines[one_sided as usize].get_or_init(|| {
            let [vertices, instances] = VERTEX_BUFFERS;
            Draw {
                label: "places at rest",
                source: shaders::REST_PLACES,
                targets: &[opaque(REST)],
                layouts: &[frame],
                buffers: &[vertices, instances, Some(REST_BUFFER)],
                depth: Some((CompareFunction::Equal, false)),
                cull: one_sided,
                ..Default::default()
            }
            .pipeline(gpu)
        })
    }

    /// Draws to the G-buffer's picture of places at rest, after its depth; no effect without one. `frame` is the camera's bind
    /// group for the G-buffer, with its layout.
    pub fn draw(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        gbuffer: &GBuffer,
        (frame, frame_layout): (&wgpu::BindGroup, &wgpu::BindGroupLayout),
        upload: &Upload,
        rig: &GpuRig,
    ) {
        let Some(picture) = &gbuffer.rest else { return };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("places at rest"),
            color_attachments: &[attachment(picture, true)],
            depth_stencil_attachment: depth_attachment(&gbuffer.depth, false),
            ..Default::default()
        });
        pass.set_bind_group(0, frame, &[]);
        upload.bind(&mut pass);
        pass.set_vertex_buffer(2, rig.rest_vertices.slice(..));
        for run in &rig.runs {
            pass.set_pipeline(self.pipeline(gpu, frame_layout, run.one_sided));
            run.draw(&mut pass);
        }
    }
}
