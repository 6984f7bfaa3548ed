//! The G-buffer: albedo, normals, material and depth of the visible surfaces, without blended surfaces and without
//! back faces of one-sided surfaces, which glTF culls.

use crate::gpu::Gpu;
use crate::gpu::bindings::{Draw, Slot, attachment, depth_attachment, group, layout, opaque, target};
use crate::gpu::scope::Scope;
use crate::scene::draw_batch::{DrawBatch, VERTEX_BUFFERS};
use crate::scene::upload::Upload;
use crate::shaders;
use std::cell::OnceCell;
use wgpu::{CompareFunction, ShaderStages, TextureFormat};

const ALBEDO: TextureFormat = TextureFormat::Rgba8UnormSrgb;
/// Surface formats without and with data of detail textures.
const SURFACES: [TextureFormat; 2] = [TextureFormat::Rg32Uint, TextureFormat::Rgba32Uint];

/// The textures of one size.
pub struct GBuffer {
    /// Albedo.
    pub albedo: wgpu::TextureView,
    /// Normals and material.
    pub surface: wgpu::TextureView,
    /// Reversed depth; 0 without a surface.
    pub depth: wgpu::TextureView,
    /// Where the file has the surfaces of meshes that deform (rest_places.wgsl), if the scene has any.
    #[cfg(feature = "radiosity")]
    pub rest: Option<wgpu::TextureView>,
    detailed: bool,
}

impl GBuffer {
    /// Textures of this size in pixels, for a scene with or without detail textures.
    pub fn new(scope: &Scope, width: u32, height: u32, detailed: bool) -> Self {
        let albedo = target(scope, "albedo", ALBEDO, width, height);
        let surface = target(scope, "surface", SURFACES[detailed as usize], width, height);
        let depth = target(scope, "depth", TextureFormat::Depth32Float, width, height);
        let view = |t: &wgpu::Texture| t.create_view(&Default::default());
        Self {
            albedo: view(&albedo),
            surface: view(&surface),
            depth: view(&depth),
            #[cfg(feature = "radiosity")]
            rest: None,
            detailed,
        }
    }
}

#[cfg(feature = "radiosity")]
impl GBuffer {
    /// With a picture of where the file has what deforms.
    pub fn with_rest(self, rest: Option<wgpu::TextureView>) -> Self {
        Self { rest, ..self }
    }
}

/// The pass that fills a [`GBuffer`].
pub struct GBufferPass {
    /// The layout of [`Self::frame_group`].
    pub frame_layout: wgpu::BindGroupLayout,
    material_layout: wgpu::BindGroupLayout,
    /// Pipelines for each of [`SURFACES`], without and with back-face culling, created on first use.
    pipelines: [[OnceCell<wgpu::RenderPipeline>; 2]; 2],
}

impl GBufferPass {
    /// Creates no pipeline yet.
    pub fn new(gpu: &Gpu, material_layout: &wgpu::BindGroupLayout) -> Self {
        let frame_layout = layout(gpu, "frame", ShaderStages::VERTEX_FRAGMENT, &[Slot::Uniform]);
        Self { frame_layout, material_layout: material_layout.clone(), pipelines: Default::default() }
    }

    fn pipeline(&self, gpu: &Gpu, detailed: bool, one_sided: bool) -> &wgpu::RenderPipeline {
        self.pipelines[detailed as usize][one_sided as usize].get_or_init(|| {
            Draw {
                label: "g-buffer",
                source: shaders::GBUFFER,
                targets: &[opaque(ALBEDO), opaque(SURFACES[detailed as usize])],
                layouts: &[&self.frame_layout, &self.material_layout],
                buffers: &VERTEX_BUFFERS,
                depth: Some((CompareFunction::Greater, true)),
                cull: one_sided,
                ..Default::default()
            }
            .pipeline(gpu)
        })
    }

    /// The bind group for a picture's `Frame`.
    pub fn frame_group(&self, gpu: &Gpu, frame: &wgpu::Buffer) -> wgpu::BindGroup {
        group(gpu, "frame", &self.frame_layout, &[frame.as_entire_binding()])
    }

    /// Draws the scene.
    #[expect(clippy::too_many_arguments, reason = "one call, one place")]
    pub fn draw(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &GBuffer,
        frame: &wgpu::BindGroup,
        upload: &Upload,
        materials: &[wgpu::BindGroup],
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("g-buffer"),
            color_attachments: &[attachment(&target.albedo, true), attachment(&target.surface, true)],
            depth_stencil_attachment: depth_attachment(&target.depth, true),
            timestamp_writes: timestamps,
            ..Default::default()
        });
        if upload.runs.is_empty() {
            return;
        }
        pass.set_bind_group(0, frame, &[]);
        upload.bind(&mut pass);
        let mut last: Option<&DrawBatch> = None;
        for run in &upload.runs {
            if last.is_none_or(|l| l.one_sided != run.one_sided) {
                pass.set_pipeline(self.pipeline(gpu, target.detailed, run.one_sided));
            }
            if last.is_none_or(|l| l.material != run.material) {
                pass.set_bind_group(1, &materials[run.material as usize], &[]);
            }
            run.draw(&mut pass);
            last = Some(run);
        }
    }
}
