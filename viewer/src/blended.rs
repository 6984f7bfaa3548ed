//! Blended surfaces: glass, curtains, decals (`alphaMode` BLEND), in the right order at every pixel.
//!
//! They are peeled: the nearest layer first, then the nearest of what lies behind it, and so on, each put under those
//! before it. A pass finds a layer's depth, a second one draws its light, as for opaque surfaces: direct light with
//! shadow maps, bounced light from the functions that cover the place. What comes out, the *veil*, is light and the
//! share that it covers; the composite pass lays it over the opaque picture, before tone mapping.
//!
//! Why not sorted triangles: a pane is two large ones, for which no single distance is right, with the faces of a glass
//! box a hand's breadth behind it; a wrong order shows as triangles, and turns over while the camera moves. Layers are
//! exact for boxes, for folds of curtains and for panes that cross, need no sorting, and cost passes instead: two a layer,
//! at most twice [`MOST_LAYERS`](crate::blended_fit::MOST_LAYERS). Deeper ones, of which the least is seen, are left out.
//!
//! The bounced light is looked up anew in each picture and at each place: rows of functions, as `display` keeps them for
//! the G-buffer, would be needed for every layer.

use crate::bindings::{Draw, Slot, attachment, blended, depth_attachment, group, layout, target, view};
use crate::gpu::Gpu;
use crate::scene::LoadedScene;
use crate::scope::Scope;
use crate::shaders;
use crate::timing::Stamps;
use crate::upload::VERTEX_BUFFERS;
use std::cell::OnceCell;
use wgpu::{BlendFactor, BlendOperation, CompareFunction, ShaderStages, TextureFormat};

/// Light in so many bits that layers add up without steps; WebGPU blends no wider format.
const VEIL: TextureFormat = TextureFormat::Rgba16Float;

/// The pass that draws all layers.
pub struct BlendedPass {
    materials: wgpu::BindGroupLayout,
    lights: wgpu::BindGroupLayout,
    /// Made when a scene first has blended surfaces.
    layout: OnceCell<wgpu::BindGroupLayout>,
    /// With backs and without, made when a scene first needs them.
    made: [OnceCell<Made>; 2],
}

struct Made {
    /// Depth of the first layer, and of the others.
    peel: [wgpu::RenderPipeline; 2],
    shade: wgpu::RenderPipeline,
}

/// The textures of one size.
pub struct Veil {
    /// Radiance times the [`unit`](crate::blended_fit::unit), as much of it as is seen, and the share that is covered.
    pub texture: wgpu::TextureView,
    /// Reversed depth of two layers, in turns; 0 where there is none.
    depths: [wgpu::TextureView; 2],
}

/// Blended surfaces of a picture of one size.
pub struct BlendedTarget {
    veil: Veil,
    /// Each with one of the depths to read.
    groups: [wgpu::BindGroup; 2],
}

impl Veil {
    /// Of this size, pixels.
    pub fn new(scope: &Scope, [width, height]: [u32; 2]) -> Self {
        let make =
            |label, format| target(scope, label, format, width, height).create_view(&Default::default());
        let depth = || make("layer depth", TextureFormat::Depth32Float);
        Self { texture: make("veil", VEIL), depths: [depth(), depth()] }
    }
}

impl BlendedPass {
    /// Without pipelines yet; from the layouts of a material's bind group and of the lights'.
    pub fn new(materials: &wgpu::BindGroupLayout, lights: &wgpu::BindGroupLayout) -> Self {
        Self {
            materials: materials.clone(),
            lights: lights.clone(),
            layout: OnceCell::new(),
            made: Default::default(),
        }
    }

    fn layout(&self, gpu: &Gpu) -> &wgpu::BindGroupLayout {
        self.layout.get_or_init(|| {
            let slots = [
                Slot::Uniform,
                Slot::Uniform,
                Slot::Read,
                Slot::Read,
                Slot::Read,
                Slot::Read,
                Slot::Read,
                Slot::Depth,
                Slot::Depth,
            ];
            layout(gpu, "blended", ShaderStages::VERTEX_FRAGMENT, &slots)
        })
    }

    fn made(&self, gpu: &Gpu, one_sided: bool) -> &Made {
        self.made[one_sided as usize].get_or_init(|| {
            let layouts = [self.layout(gpu), &self.materials, &self.lights];
            let draw = Draw {
                label: "blended",
                source: shaders::BLENDED,
                layouts: &layouts,
                buffers: &VERTEX_BUFFERS,
                cull: one_sided,
                ..Draw::default()
            };
            let depth = Some((CompareFunction::Greater, true));
            let peel = |entry| Draw { fragment: Some(entry), depth, ..draw }.pipeline(gpu);
            let peel = [peel("first"), peel("next")];
            // Under what is there.
            let under = wgpu::BlendComponent {
                src_factor: BlendFactor::OneMinusDstAlpha,
                dst_factor: BlendFactor::One,
                operation: BlendOperation::Add,
            };
            let targets = [blended(VEIL, wgpu::BlendState { color: under, alpha: under })];
            let shade = Draw { targets: &targets, ..draw }.pipeline(gpu);
            Made { peel, shade }
        })
    }

    /// For the scene's blended surfaces as `frame` sees them in front of `opaque`, the depth of the others; what is shown
    /// of their light is in the uniform `shading`.
    pub fn target(
        &self,
        gpu: &Gpu,
        veil: Veil,
        scene: &LoadedScene,
        frame: &wgpu::Buffer,
        shading: &wgpu::Buffer,
        opaque: &wgpu::TextureView,
    ) -> BlendedTarget {
        let bind = |depth: &wgpu::TextureView| {
            let resources = [
                frame.as_entire_binding(),
                shading.as_entire_binding(),
                scene.materials.looks.as_entire_binding(),
                scene.relight.display.as_entire_binding(),
                scene.upload.points.as_entire_binding(),
                scene.upload.cuts.as_entire_binding(),
                scene.upload.lookup.as_entire_binding(),
                view(opaque),
                view(depth),
            ];
            group(gpu, "blended", self.layout(gpu), &resources)
        };
        BlendedTarget { groups: [bind(&veil.depths[0]), bind(&veil.depths[1])], veil }
    }

    /// Draws all layers: after the G-buffer, whose depth hides them, and the relighting.
    pub fn draw(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &BlendedTarget,
        scene: &LoadedScene,
        lights: &wgpu::BindGroup,
        stamps: Option<Stamps<'_>>,
    ) {
        let count = scene.upload.blended_layers as usize;
        for layer in 0..count {
            let [own, other] = [layer % 2, (layer + 1) % 2];
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("layer depth"),
                depth_stencil_attachment: depth_attachment(&target.veil.depths[own], true),
                timestamp_writes: stamps.filter(|_| layer == 0).map(|s| s.render(true, false)),
                ..Default::default()
            });
            let peel = |one_sided| &self.made(gpu, one_sided).peel[(layer > 0) as usize];
            runs(&mut pass, peel, &target.groups[other], scene, lights);
            drop(pass);
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("layer"),
                color_attachments: &[attachment(&target.veil.texture, layer == 0)],
                timestamp_writes: stamps.filter(|_| layer + 1 == count).map(|s| s.render(false, true)),
                ..Default::default()
            });
            let shade = |one_sided| &self.made(gpu, one_sided).shade;
            runs(&mut pass, shade, &target.groups[own], scene, lights);
        }
    }
}

/// Draws all blended surfaces of the scene; `pipeline` is told whether they are one-sided.
fn runs<'a>(
    pass: &mut wgpu::RenderPass<'_>,
    pipeline: impl Fn(bool) -> &'a wgpu::RenderPipeline,
    own: &wgpu::BindGroup,
    scene: &LoadedScene,
    lights: &wgpu::BindGroup,
) {
    pass.set_bind_group(0, own, &[]);
    pass.set_bind_group(2, lights, &[]);
    scene.upload.bind(pass);
    let mut last = None;
    for run in &scene.upload.blended_runs {
        if last != Some(run.one_sided) {
            pass.set_pipeline(pipeline(run.one_sided));
            last = Some(run.one_sided);
        }
        pass.set_bind_group(1, &scene.materials.groups[run.material as usize], &[]);
        run.draw(pass);
    }
}
