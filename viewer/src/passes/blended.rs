//! Blended surfaces: glass, curtains, decals (`alphaMode` BLEND), in the right order at every pixel.
//!
//! Depth peeling: the nearest layer first, then the nearest layer behind, and so on; each new layer is blended
//! under the layers in front. Two passes a layer: the first finds the layer's depth, the second draws its light as
//! for opaque surfaces: direct light with shadow maps, bounced light from the functions that cover the place. The
//! result, the *veil*, holds radiance and coverage; the composite pass blends the veil over the opaque picture,
//! before tone mapping.
//!
//! Sorting triangles fails here: a pane is two large triangles without a single right distance, and the faces of a
//! glass box are a hand's breadth behind; a wrong order shows as triangles and flips while the camera moves. Layers
//! are exact for boxes, folds of curtains and crossing panes, and need no sorting. The cost is two passes a layer,
//! at most twice [`MOST_LAYERS`](crate::scene::blended_fit::MOST_LAYERS). Deeper layers, the least visible, are left out.
//!
//! Coloured layers (glass) need more than radiance and coverage: the transmittance is a colour. The light of a
//! layer is multiplied by the product of the transmittances in front before the addition, and the product is copied
//! from layer to layer.
//!
//! The bounced light is looked up anew in every picture and at every place: rows of functions, as `display` keeps
//! for the G-buffer, would be needed for every layer.

use super::timing::Stamps;
use crate::gpu::Gpu;
use crate::gpu::bindings::{Draw, Slot, attachment, blended, depth_attachment, group, layout, target, view};
use crate::gpu::scope::Scope;
use crate::scene::GpuScene;
use crate::scene::draw_batch::VERTEX_BUFFERS;
use crate::shaders;
use std::cell::OnceCell;
use wgpu::{BlendFactor, BlendOperation, CompareFunction, ShaderStages, TextureFormat};

/// Format of the veil: 16 bits a channel add up layers without banding; WebGPU blends no wider format.
const VEIL: TextureFormat = TextureFormat::Rgba16Float;

/// Pipelines of all layers.
pub struct BlendedPass {
    materials: wgpu::BindGroupLayout,
    lights: wgpu::BindGroupLayout,
    /// Bind group layouts without and with colours, created for the first scene with blended surfaces.
    layouts: [OnceCell<wgpu::BindGroupLayout>; 2],
    /// Pipelines by `[tinted][one_sided]`.
    made: [[OnceCell<BlendedPipelines>; 2]; 2],
}

struct BlendedPipelines {
    /// Depth pipelines of the first layer, and of the later layers.
    peel: [wgpu::RenderPipeline; 2],
    shade: wgpu::RenderPipeline,
}

/// The textures of one picture size.
pub struct Veil {
    /// RGB: visible radiance times the [`unit`](crate::scene::blended_fit::unit); alpha: covered share.
    pub texture: wgpu::TextureView,
    /// Present if layers have colours.
    pub tints: Option<Tints>,
    /// Reversed depth of two layers, alternating; 0 without a layer.
    depths: [wgpu::TextureView; 2],
}

/// Additional textures for coloured layers: linear RGB.
pub struct Tints {
    /// Transmittance of all layers.
    pub through: (wgpu::Texture, wgpu::TextureView),
    /// Transmittance without the last layer, because a pass cannot read its own attachment.
    before: (wgpu::Texture, wgpu::TextureView),
    /// Radiance independent of the lights (unlit surfaces).
    pub shine: (wgpu::Texture, wgpu::TextureView),
}

/// Blended surfaces of one picture size.
pub struct BlendedTarget {
    veil: Veil,
    /// Bind groups, one for each of the two depth textures.
    groups: [wgpu::BindGroup; 2],
}

impl Veil {
    /// Textures of this size in pixels; with [`Tints`] if `tinted`.
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
    /// Takes the layouts of a material's bind group and of the lights' bind group; creates no pipeline yet.
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
                #[cfg(feature = "radiosity")]
                Slot::Uniform,
            ];
            slots.extend(tinted.then_some(Slot::TextureLoad));
            layout(gpu, "blended", ShaderStages::VERTEX_FRAGMENT, &slots)
        })
    }

    fn made(&self, gpu: &Gpu, tinted: bool, one_sided: bool) -> &BlendedPipelines {
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
            // Blends under the layers in front.
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
            BlendedPipelines { peel, shade }
        })
    }

    /// Binds the scene's blended surfaces for the camera `frame`. `opaque` is the depth of the opaque surfaces; the
    /// uniform `shading` selects direct and bounced light.
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
                #[cfg(feature = "radiosity")]
                scene.upload.rest.as_entire_binding(),
            ];
            resources.extend(veil.tints.iter().map(|tints| view(&tints.before.1)));
            group(gpu, "blended", self.layout(gpu, veil.tints.is_some()), &resources)
        };
        BlendedTarget { groups: [bind(&veil.depths[0]), bind(&veil.depths[1])], veil }
    }

    /// Draws all layers: after the G-buffer (the opaque depth hides layers behind) and after the relighting.
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

/// A color attachment that is cleared to `color`.
fn cleared(view: &wgpu::TextureView, color: wgpu::Color) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let ops = wgpu::Operations { load: wgpu::LoadOp::Clear(color), store: wgpu::StoreOp::Store };
    attachment(view, true).map(|attachment| wgpu::RenderPassColorAttachment { ops, ..attachment })
}

/// Draws all blended surfaces of the scene; `pipeline` maps `one_sided` to the pipeline.
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
