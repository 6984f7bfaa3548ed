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
//! Where layers have colours (glass), light and coverage do not suffice: what goes through is a colour, each layer's light
//! is multiplied with that of the layers in front before it is added, and the product is copied from layer to layer.
//!
//! The bounced light is looked up anew in each picture and at each place: rows of functions, as `display` keeps them for
//! the G-buffer, would be needed for every layer.

use crate::bindings::{Draw, Slot, attachment, blended, depth_attachment, group, layout, target, view};
use crate::draw_batch::VERTEX_BUFFERS;
use crate::gpu::Gpu;
use crate::scene::GpuScene;
use crate::scope::Scope;
use crate::shaders;
use crate::timing::Stamps;
use std::cell::OnceCell;
use wgpu::{BlendFactor, BlendOperation, CompareFunction, ShaderStages, TextureFormat};

/// Light in so many bits that layers add up without steps; WebGPU blends no wider format.
const VEIL: TextureFormat = TextureFormat::Rgba16Float;

/// The pass that draws all layers.
pub struct BlendedPass {
    materials: wgpu::BindGroupLayout,
    lights: wgpu::BindGroupLayout,
    /// Without colours and with them, made when a scene first has blended surfaces.
    layouts: [OnceCell<wgpu::BindGroupLayout>; 2],
    /// The same, each with backs and without.
    made: [[OnceCell<Made>; 2]; 2],
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
    /// Where layers have colours.
    pub tints: Option<Tints>,
    /// Reversed depth of two layers, in turns; 0 where there is none.
    depths: [wgpu::TextureView; 2],
}

/// What layers with colours need besides: linear RGB.
pub struct Tints {
    /// The share of light that goes through all layers.
    pub through: (wgpu::Texture, wgpu::TextureView),
    /// The same without the last layer: no pass reads what it writes.
    before: (wgpu::Texture, wgpu::TextureView),
    /// What they show whatever the light.
    pub shine: (wgpu::Texture, wgpu::TextureView),
}

/// Blended surfaces of a picture of one size.
pub struct BlendedTarget {
    veil: Veil,
    /// Each with one of the depths to read.
    groups: [wgpu::BindGroup; 2],
}

impl Veil {
    /// Of this size, pixels; for layers that are `tinted` or not.
    pub fn new(scope: &Scope, [width, height]: [u32; 2], tinted: bool) -> Self {
        let make = |label, format| {
            let texture = target(scope, label, format, width, height);
            let view = texture.create_view(&Default::default());
            (texture, view)
        };
        let depth = || make("layer depth", TextureFormat::Depth32Float).1;
        let tints = tinted.then(|| Tints {
            through: make("through", VEIL),
            before: make("through before", VEIL),
            shine: make("shine", VEIL),
        });
        Self { texture: make("veil", VEIL).1, tints, depths: [depth(), depth()] }
    }
}

impl BlendedPass {
    /// Without pipelines yet; from the layouts of a material's bind group and of the lights'.
    pub fn new(materials: &wgpu::BindGroupLayout, lights: &wgpu::BindGroupLayout) -> Self {
        Self {
            materials: materials.clone(),
            lights: lights.clone(),
            layouts: Default::default(),
            made: Default::default(),
        }
    }

    fn layout(&self, gpu: &Gpu, tinted: bool) -> &wgpu::BindGroupLayout {
        self.layouts[tinted as usize].get_or_init(|| {
            let mut slots = vec![
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
            slots.extend(tinted.then_some(Slot::TextureLoad));
            layout(gpu, "blended", ShaderStages::VERTEX_FRAGMENT, &slots)
        })
    }

    fn made(&self, gpu: &Gpu, tinted: bool, one_sided: bool) -> &Made {
        self.made[tinted as usize][one_sided as usize].get_or_init(|| {
            let layouts = [self.layout(gpu, tinted), &self.materials, &self.lights];
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
            let veil = |color| blended(VEIL, wgpu::BlendState { color, alpha: under });
            let by = |src_factor, dst_factor| wgpu::BlendComponent { src_factor, dst_factor, ..under };
            let sum = by(BlendFactor::One, BlendFactor::One);
            let product = by(BlendFactor::Zero, BlendFactor::Src);
            let (fragment, targets) = match tinted {
                false => ("fragment", vec![veil(under)]),
                true => ("tinted_layer", vec![veil(sum), veil(product), veil(sum)]),
            };
            let shade = Draw { fragment: Some(fragment), targets: &targets, ..draw }.pipeline(gpu);
            Made { peel, shade }
        })
    }

    /// For the scene's blended surfaces as `frame` sees them in front of `opaque`, the depth of the others; what is shown
    /// of their light is in the uniform `shading`.
    pub fn target(
        &self,
        gpu: &Gpu,
        veil: Veil,
        scene: &GpuScene,
        frame: &wgpu::Buffer,
        shading: &wgpu::Buffer,
        opaque: &wgpu::TextureView,
    ) -> BlendedTarget {
        let bind = |depth: &wgpu::TextureView| {
            let mut resources = vec![
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
            resources.extend(veil.tints.iter().map(|tints| view(&tints.before.1)));
            group(gpu, "blended", self.layout(gpu, veil.tints.is_some()), &resources)
        };
        BlendedTarget { groups: [bind(&veil.depths[0]), bind(&veil.depths[1])], veil }
    }

    /// Draws all layers: after the G-buffer, whose depth hides them, and the relighting.
    pub fn draw(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &BlendedTarget,
        scene: &GpuScene,
        lights: &wgpu::BindGroup,
        stamps: Option<Stamps<'_>>,
    ) {
        let tints = target.veil.tints.as_ref();
        let made = |one_sided| self.made(gpu, tints.is_some(), one_sided);
        if let Some(tints) = tints {
            drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[cleared(&tints.before.1, wgpu::Color::WHITE)],
                ..Default::default()
            }));
        }
        let count = scene.upload.blended_layers as usize;
        for layer in 0..count {
            let [own, other] = [layer % 2, (layer + 1) % 2];
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("layer depth"),
                depth_stencil_attachment: depth_attachment(&target.veil.depths[own], true),
                timestamp_writes: stamps.filter(|_| layer == 0).map(|s| s.render(true, false)),
                ..Default::default()
            });
            let peel = |one_sided| &made(one_sided).peel[(layer > 0) as usize];
            runs(&mut pass, peel, &target.groups[other], scene, lights);
            drop(pass);
            let mut attachments = vec![attachment(&target.veil.texture, layer == 0)];
            if let Some(tints) = tints {
                attachments.push(match layer {
                    0 => cleared(&tints.through.1, wgpu::Color::WHITE),
                    _ => attachment(&tints.through.1, false),
                });
                attachments.push(attachment(&tints.shine.1, layer == 0));
            }
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("layer"),
                color_attachments: &attachments,
                timestamp_writes: stamps.filter(|_| layer + 1 == count).map(|s| s.render(false, true)),
                ..Default::default()
            });
            let shade = |one_sided| &made(one_sided).shade;
            runs(&mut pass, shade, &target.groups[own], scene, lights);
            drop(pass);
            if let Some(tints) = tints.filter(|_| layer + 1 < count) {
                let [from, to] = [&tints.through.0, &tints.before.0].map(wgpu::Texture::as_image_copy);
                encoder.copy_texture_to_texture(from, to, tints.through.0.size());
            }
        }
    }
}

/// An attachment that is cleared to a colour.
fn cleared(view: &wgpu::TextureView, color: wgpu::Color) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(color), store: wgpu::StoreOp::Store };
    attachment(view, true).map(|attachment| wgpu::RenderPassColorAttachment { ops, ..attachment })
}

/// Draws all blended surfaces of the scene; `pipeline` is told whether they are one-sided.
fn runs<'a>(
    pass: &mut wgpu::RenderPass<'_>,
    pipeline: impl Fn(bool) -> &'a wgpu::RenderPipeline,
    own: &wgpu::BindGroup,
    scene: &GpuScene,
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
