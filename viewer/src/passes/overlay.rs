//! Overlays on the picture: the basis's points, and the lights' handles.

use crate::controls::shape::Shape;
use crate::gpu::Gpu;
use crate::gpu::bindings::{
    Draw, Slot, attachment, blended, buffer, depth_attachment, empty_buffer, group, layout,
};
use crate::gpu::scope::Scope;
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use std::ops::Range;
use wgpu::{BufferUsages, CompareFunction, ShaderStages, TextureFormat, VertexFormat};

/// Colours of the levels, coarsest first; repeated for further levels.
const COLORS: [[f32; 3]; 8] = [
    [0.95, 0.26, 0.21],
    [1.0, 0.6, 0.0],
    [1.0, 0.92, 0.23],
    [0.3, 0.75, 0.31],
    [0.0, 0.74, 0.83],
    [0.25, 0.45, 0.95],
    [0.61, 0.25, 0.85],
    [0.95, 0.95, 0.95],
];

/// `Dots` in overlay.wgsl.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Dots {
    color: [f32; 4],
    size: f32,
    pad: [f32; 3],
}

/// A vertex of a handle.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Vertex {
    position: [f32; 2],
    at: [f32; 2],
    shape: [f32; 2],
    color: [f32; 4],
}

const VERTEX: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: 40,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &[
        wgpu::VertexAttribute { format: VertexFormat::Float32x2, offset: 0, shader_location: 0 },
        wgpu::VertexAttribute { format: VertexFormat::Float32x2, offset: 8, shader_location: 1 },
        wgpu::VertexAttribute { format: VertexFormat::Float32x2, offset: 16, shader_location: 2 },
        wgpu::VertexAttribute { format: VertexFormat::Float32x4, offset: 24, shader_location: 3 },
    ],
};

/// The pipelines for one target format.
pub struct OverlayPass {
    format: TextureFormat,
    dots_layout: wgpu::BindGroupLayout,
    dots: wgpu::RenderPipeline,
    gizmo_layout: wgpu::BindGroupLayout,
    gizmo: wgpu::RenderPipeline,
}

impl OverlayPass {
    /// Creates the pipelines.
    pub fn new(gpu: &Gpu, format: TextureFormat) -> Self {
        let stages = ShaderStages::VERTEX_FRAGMENT;
        let dots_layout = layout(gpu, "dots", stages, &[Slot::Uniform, Slot::Read, Slot::Uniform]);
        let target = [blended(format, wgpu::BlendState::ALPHA_BLENDING)];
        let dots = Draw {
            label: "dots",
            source: shaders::OVERLAY,
            targets: &target,
            layouts: &[&dots_layout],
            strip: true,
            depth: Some((CompareFunction::GreaterEqual, false)),
            ..Default::default()
        }
        .pipeline(gpu);
        let gizmo_layout = layout(gpu, "gizmo", stages, &[Slot::Uniform]);
        let gizmo = Draw {
            label: "gizmo",
            source: shaders::GIZMO,
            targets: &target,
            layouts: &[&gizmo_layout],
            buffers: &[Some(VERTEX)],
            ..Default::default()
        }
        .pipeline(gpu);
        Self { format, dots_layout, dots, gizmo_layout, gizmo }
    }

    /// Target format of the pipelines.
    pub fn format(&self) -> TextureFormat {
        self.format
    }

    /// Draws the points of levels (by index, with their ranges), coarser levels larger. `scope` owns the temporary
    /// resources, as in the other functions.
    #[expect(clippy::too_many_arguments, reason = "one call, one place")]
    pub fn draw_points(
        &self,
        scope: &Scope,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        depth: &wgpu::TextureView,
        frame: &wgpu::Buffer,
        points: &wgpu::Buffer,
        levels: &[(usize, Range<u32>)],
    ) {
        let groups: Vec<_> = levels
            .iter()
            .enumerate()
            .map(|(i, (level, _))| {
                let [r, g, b] = COLORS[level % COLORS.len()];
                let size = 1.5 + 0.7 * (levels.len() - 1 - i) as f32;
                let dots = Dots { color: [r, g, b, 0.9], size, pad: [0.0; 3] };
                let dots = buffer(scope, "dots", BufferUsages::UNIFORM, bytemuck::bytes_of(&dots));
                let resources =
                    [frame.as_entire_binding(), points.as_entire_binding(), dots.as_entire_binding()];
                group(scope, "dots", &self.dots_layout, &resources)
            })
            .collect();
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("dots"),
            color_attachments: &[attachment(target, false)],
            depth_stencil_attachment: depth_attachment(depth, false),
            ..Default::default()
        });
        pass.set_pipeline(&self.dots);
        for (bind, (_, range)) in groups.iter().zip(levels).rev() {
            pass.set_bind_group(0, bind, &[]);
            pass.draw(0..4, range.clone());
        }
    }

    /// Draws the lights' handles.
    pub fn draw_gizmos(
        &self,
        scope: &Scope,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        size: [u32; 2],
        shapes: &[Shape],
    ) {
        if shapes.is_empty() {
            return;
        }
        let vertices: Vec<Vertex> = shapes.iter().flat_map(quad).collect();
        let vertices_buffer = buffer(scope, "gizmo", BufferUsages::VERTEX, bytemuck::cast_slice(&vertices));
        let view = empty_buffer(scope, "gizmo view", BufferUsages::UNIFORM | BufferUsages::COPY_DST, 16);
        scope.queue.write_buffer(&view, 0, bytemuck::bytes_of(&[size[0] as f32, size[1] as f32, 0.0, 0.0]));
        let bind = group(scope, "gizmo", &self.gizmo_layout, &[view.as_entire_binding()]);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("gizmo"),
            color_attachments: &[attachment(target, false)],
            ..Default::default()
        });
        pass.set_pipeline(&self.gizmo);
        pass.set_bind_group(0, &bind, &[]);
        pass.set_vertex_buffer(0, vertices_buffer.slice(..));
        pass.draw(0..vertices.len() as u32, 0..1);
    }
}

/// Two triangles around a shape, with a margin of a pixel for the soft edge.
fn quad(shape: &Shape) -> [Vertex; 6] {
    let half = [0.5 * shape.length + shape.radius + 1.0, shape.radius + 1.0];
    let (sin, cos) = shape.angle.sin_cos();
    let second = if shape.length > 0.0 { -0.5 * shape.length } else { shape.hole };
    let corner = |sx: f32, sy: f32| {
        let at = [sx * half[0], sy * half[1]];
        let position =
            [shape.centre[0] + at[0] * cos - at[1] * sin, shape.centre[1] + at[0] * sin + at[1] * cos];
        Vertex { position, at, shape: [shape.radius, second], color: shape.color }
    };
    let (a, b, c, d) = (corner(-1.0, -1.0), corner(1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0));
    [a, b, c, c, b, d]
}
