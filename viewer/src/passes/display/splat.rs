//! Splatting of functions (paper, section 4.1): a quad bounds the pixels that a function may reach; in every pixel
//! of the quad the function's weight and weighted irradiance are summed, by blending of 16-bit floats. The quads
//! are valid while the camera rests; the sums are computed again after every change of the light.
//!
//! The finest level is drawn first; a coarser level is drawn only at places without a finer function. The GPU
//! decides: the draws of the coarser levels are indirect, and have no instances if no place is open.

use super::{SlotBuffers, Sources};
use crate::gpu::bindings::{
    Draw, Slot, WORKGROUP, attachment, blended, buffer, compute, empty_buffer, grid, group, layout, opaque,
    target, view,
};
use crate::gpu::scope::Scope;
use crate::gpu::{Gpu, LIMITS};
use crate::passes::timing::Stamps;
use crate::scene::GpuScene;
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use std::cell::OnceCell;
use wgpu::{BlendFactor, BlendOperation, BufferUsages, CompareFunction, ShaderStages, TextureFormat};

/// Format of the sums: WebGPU blends no wider format without optional features.
const SUMS: TextureFormat = TextureFormat::Rgba16Float;
/// Workgroups of brightest.wgsl.
const BRIGHTEST_GROUPS: u32 = 64;
/// Pixels across a workgroup of resolve.wgsl.
const TILE: u32 = 8;

/// `Level` in level.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Level {
    first: u32,
    count: u32,
    index: u32,
    finest: u32,
    tilts: u32,
    pad: [u32; 3],
}

/// Arguments of a level's indirect draws; quads.wgsl and resolve.wgsl fill in the counts.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Draws {
    /// The level's quads over pixels with their own slots and over blocks, if a place is open.
    quads: [[u32; 4]; 2],
    /// One triangle, if a place is open.
    mask: [u32; 4],
    /// All quads in view, over pixels and over blocks.
    all: [[u32; 4]; 2],
    /// Workgroups of resolve.wgsl, and the number of functions in view.
    resolve: [u32; 4],
}

/// Offsets in [`Draws`], bytes.
const MASK: u64 = 32;
const ALL: u64 = 48;
const RESOLVE: u64 = 80;
const SEEN: u64 = 92;

/// The pipelines.
pub struct SplatPass {
    blocks: wgpu::ComputePipeline,
    edges: wgpu::ComputePipeline,
    quads: (wgpu::ComputePipeline, wgpu::BindGroupLayout),
    brightest: (wgpu::ComputePipeline, wgpu::BindGroupLayout),
    draw_layout: wgpu::BindGroupLayout,
    /// Pipelines of mask and splats, without and with tilts; created on first use.
    drawn: [OnceCell<[wgpu::RenderPipeline; 2]>; 2],
    resolve: (wgpu::ComputePipeline, wgpu::BindGroupLayout),
}

/// Quads and sums of one picture size.
pub struct SplatTarget {
    find: wgpu::BindGroup,
    brightest_bits: wgpu::Buffer,
    brightest: wgpu::BindGroup,
    /// Levels, finest first.
    levels: Vec<LevelTarget>,
    /// Initial [`Draws`] of all levels at the start of every frame.
    template: wgpu::Buffer,
    light: wgpu::TextureView,
    /// Sums of tilts, in scenes with normal maps.
    tilts: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
    pipelines: [wgpu::RenderPipeline; 2],
    own: Scope,
}

struct LevelTarget {
    count: u32,
    draws: wgpu::Buffer,
    quads: wgpu::BindGroup,
    draw: wgpu::BindGroup,
    resolve: wgpu::BindGroup,
}

/// Size of the texture for a picture's sums (atlas.wgsl): one row more than used, for the viewport of the blocks,
/// which begins a quarter of a texel further down.
fn atlas([width, height]: [u32; 2]) -> [u32; 2] {
    [width, height + height.div_ceil(2) + 1]
}

/// Whether a picture of this size can be splatted: a splat does not know the group of the pixels that it covers.
pub fn fits(scene: &GpuScene, size: [u32; 2]) -> bool {
    !scene.needs_lookup && atlas(size)[1] <= LIMITS.max_texture_dimension_2d
}

impl SplatPass {
    /// Creates the pipelines; `find` is the layout of find.wgsl.
    pub fn new(gpu: &Gpu, find: &wgpu::BindGroupLayout) -> Self {
        let kernel = |entry, source, slots: &[Slot]| {
            let layout = layout(gpu, entry, ShaderStages::COMPUTE, slots);
            (compute(gpu, entry, source, &[&layout], &[]), layout)
        };
        let draw = [
            Slot::Uniform,
            Slot::Uniform,
            Slot::Depth,
            Slot::TextureUint,
            Slot::Read,
            Slot::Read,
            Slot::Read,
            Slot::Read,
            Slot::Read,
            Slot::Read,
            Slot::Read,
            Slot::Read,
        ];
        let resolve = [
            Slot::Uniform,
            Slot::Uniform,
            Slot::Depth,
            Slot::TextureUint,
            Slot::TextureLoad,
            Slot::TextureLoad,
            Slot::Read,
            Slot::Read,
            Slot::Write,
            Slot::Write,
            Slot::Read,
        ];
        let draw_layout = layout(gpu, "splat", ShaderStages::VERTEX_FRAGMENT, &draw);
        Self {
            blocks: compute(gpu, "blocks", shaders::FIND, &[find], &[("ROWS", 0.0)]),
            edges: compute(gpu, "edges", shaders::FIND, &[find], &[("ROWS", 0.0)]),
            quads: kernel(
                "quads_of_level",
                shaders::QUADS,
                &[
                    Slot::Uniform,
                    Slot::Uniform,
                    Slot::Read,
                    Slot::Write,
                    Slot::Write,
                    Slot::Depth,
                    Slot::Read,
                ],
            ),
            brightest: kernel("brightest", shaders::BRIGHTEST, &[Slot::Read, Slot::Write]),
            drawn: Default::default(),
            resolve: kernel("resolve", shaders::RESOLVE, &resolve),
            draw_layout,
        }
    }

    fn pipelines(&self, gpu: &Gpu, tilts: bool) -> [wgpu::RenderPipeline; 2] {
        let add = wgpu::BlendComponent {
            src_factor: BlendFactor::One,
            dst_factor: BlendFactor::One,
            operation: BlendOperation::Add,
        };
        let sums = blended(SUMS, wgpu::BlendState { color: add, alpha: add });
        let untouched = wgpu::ColorTargetState { write_mask: wgpu::ColorWrites::empty(), ..opaque(SUMS) };
        let make = || {
            let draw = Draw { source: shaders::SPLAT, layouts: &[&self.draw_layout], ..Draw::default() };
            let mask = Draw {
                label: "mask",
                vertex: "fullscreen",
                fragment: Some("mask"),
                targets: &[untouched.clone(), untouched.clone()][..1 + tilts as usize],
                depth: Some((CompareFunction::Always, true)),
                ..draw
            };
            let splat = Draw {
                label: "splat",
                targets: &[sums.clone(), sums.clone()][..1 + tilts as usize],
                depth: Some((CompareFunction::Greater, false)),
                ..draw
            };
            [mask.pipeline(gpu), splat.pipeline(gpu)]
        };
        self.drawn[tilts as usize].get_or_init(make).clone()
    }

    /// Quads and sums for these slots; `find` creates the bind group of find.wgsl.
    pub fn target(
        &self,
        own: Scope,
        slots: &SlotBuffers,
        from: Sources<'_>,
        find: impl Fn(&Scope, &wgpu::Buffer) -> wgpu::BindGroup,
    ) -> SplatTarget {
        let (scene, gbuffer) = (from.scene, from.gbuffer);
        let [width, height] = atlas(slots.size);
        let texture =
            |label, format| target(&own, label, format, width, height).create_view(&Default::default());
        let light = texture("splats", SUMS);
        let bumpy = scene.meta.is_bumpy();
        let tilts = bumpy.then(|| texture("tilts", SUMS));
        let points: u32 = scene.levels.iter().map(|level| level.len() as u32).sum();
        let storage = BufferUsages::STORAGE;
        let quads = empty_buffer(&own, "quads", storage, 32 * points as u64);
        let usage = storage | BufferUsages::COPY_DST;
        let brightest_bits = empty_buffer(&own, "brightest", usage, 4);
        let usage = usage | BufferUsages::INDIRECT | BufferUsages::COPY_SRC;
        let draws: Vec<_> = scene
            .levels
            .iter()
            .map(|_| empty_buffer(&own, "draws", usage, size_of::<Draws>() as u64))
            .collect();
        let spare = empty_buffer(&own, "no draws", usage, size_of::<Draws>() as u64);
        let mut template = Vec::new();
        let mut levels = Vec::new();
        for (index, level) in scene.levels.iter().enumerate().rev() {
            let finest = index + 1 == scene.levels.len();
            let of = Level {
                first: level.start,
                count: level.len() as u32,
                index: index as u32,
                finest: finest as u32,
                tilts: bumpy as u32,
                pad: [0; 3],
            };
            let of = buffer(&own, "level", BufferUsages::UNIFORM, bytemuck::bytes_of(&of));
            let one = finest as u32;
            let none = [[0, 1, 0, 0], [0, 1, 6 * points, 0]];
            template.push(Draws {
                quads: none,
                mask: [3 * one, 1, 0, 0],
                all: none,
                resolve: [one * width.div_ceil(TILE), height.div_ceil(TILE), 1, 0],
            });
            let common = [
                from.frame.as_entire_binding(),
                of.as_entire_binding(),
                view(&gbuffer.depth),
                view(&gbuffer.surface),
            ];
            let bind = |label, layout, more: &[wgpu::BindingResource<'_>]| {
                group(&own, label, layout, &[&common[..], more].concat())
            };
            let own_quads = [
                from.frame.as_entire_binding(),
                of.as_entire_binding(),
                scene.upload.points.as_entire_binding(),
                quads.as_entire_binding(),
                draws[index].as_entire_binding(),
                view(&gbuffer.depth),
                slots.by_pixel.as_entire_binding(),
            ];
            let coarser = index.checked_sub(1).map_or(&spare, |coarser| &draws[coarser]);
            levels.push(LevelTarget {
                count: level.len() as u32,
                draws: draws[index].clone(),
                quads: group(&own, "quads", &self.quads.1, &own_quads),
                draw: bind(
                    "splat",
                    &self.draw_layout,
                    &[
                        scene.upload.points.as_entire_binding(),
                        scene.upload.cuts.as_entire_binding(),
                        slots.by_pixel.as_entire_binding(),
                        brightest_bits.as_entire_binding(),
                        slots.light.as_entire_binding(),
                        quads.as_entire_binding(),
                        scene.relight.display.as_entire_binding(),
                        scene.upload.gains.as_entire_binding(),
                    ],
                ),
                resolve: bind(
                    "resolve",
                    &self.resolve.1,
                    &[
                        view(&light),
                        // Placeholder: not read without normal maps.
                        view(tilts.as_ref().unwrap_or(&light)),
                        slots.by_pixel.as_entire_binding(),
                        brightest_bits.as_entire_binding(),
                        slots.light.as_entire_binding(),
                        coarser.as_entire_binding(),
                        slots.open.as_entire_binding(),
                    ],
                ),
            });
        }
        let brightest = [scene.relight.display.as_entire_binding(), brightest_bits.as_entire_binding()];
        SplatTarget {
            find: find(&own, &empty_buffer(&own, "no rows", storage, 0)),
            brightest: group(&own, "brightest", &self.brightest.1, &brightest),
            brightest_bits,
            levels,
            template: buffer(&own, "draws", BufferUsages::COPY_SRC, bytemuck::cast_slice(&template)),
            light,
            tilts,
            depth: texture("open", TextureFormat::Depth32Float),
            pipelines: self.pipelines(&own, bumpy),
            own,
        }
    }

    /// Finds the pixels with their own slots, and the quads of all functions.
    pub fn find(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &SplatTarget,
        slots: &SlotBuffers,
        stamps: Option<Stamps<'_>>,
    ) {
        let bytes = size_of::<Draws>() as u64;
        for (i, level) in (0..).zip(&target.levels) {
            encoder.copy_buffer_to_buffer(&target.template, i * bytes, &level.draws, 0, bytes);
        }
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("find"),
            timestamp_writes: stamps.map(|s| s.compute(true, true)),
        });
        let [width, height] = slots.size;
        pass.set_bind_group(0, &target.find, &[]);
        pass.set_pipeline(&self.blocks);
        pass.dispatch_workgroups(width.div_ceil(16), height.div_ceil(16), 1);
        pass.set_pipeline(&self.edges);
        pass.dispatch_workgroups(width.div_ceil(8), height.div_ceil(8), 1);
        pass.set_pipeline(&self.quads.0);
        for level in &target.levels {
            pass.set_bind_group(0, &level.quads, &[]);
            let [x, y] = grid(level.count.div_ceil(WORKGROUP));
            pass.dispatch_workgroups(x, y, 1);
        }
        drop(pass);
        if let Some(finest) = target.levels.first() {
            encoder.copy_buffer_to_buffer(&finest.draws, SEEN, &slots.counts, 4, 4);
        }
    }

    /// Splats the functions' light, level by level.
    pub fn gather(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &SplatTarget,
        slots: &SlotBuffers,
        stamps: Option<Stamps<'_>>,
    ) {
        encoder.clear_buffer(&target.brightest_bits, 0, None);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("brightest"),
            timestamp_writes: stamps.map(|s| s.compute(true, false)),
        });
        pass.set_pipeline(&self.brightest.0);
        pass.set_bind_group(0, &target.brightest, &[]);
        pass.dispatch_workgroups(BRIGHTEST_GROUPS, 1, 1);
        drop(pass);
        let [width, height] = slots.size.map(|side| side as f32);
        for (i, level) in target.levels.iter().enumerate() {
            let finest = i == 0;
            let mut attachments = vec![attachment(&target.light, finest)];
            attachments.extend(target.tilts.iter().map(|tilts| attachment(tilts, finest)));
            let load = if finest { wgpu::LoadOp::Clear(1.0) } else { wgpu::LoadOp::Load };
            let depth_ops = Some(wgpu::Operations { load, store: wgpu::StoreOp::Store });
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("splat"),
                color_attachments: &attachments,
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &target.depth,
                    depth_ops,
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            pass.set_bind_group(0, &level.draw, &[]);
            pass.set_pipeline(&target.pipelines[0]);
            pass.draw_indirect(&level.draws, MASK);
            pass.set_pipeline(&target.pipelines[1]);
            let quads = if finest { ALL } else { 0 };
            pass.set_viewport(0.0, 0.0, width, height, 0.0, 1.0);
            pass.draw_indirect(&level.draws, quads);
            // The centre of a block's texel is the centre of its first pixel.
            pass.set_viewport(0.25, height + 0.25, 0.5 * width, 0.5 * height, 0.0, 1.0);
            pass.draw_indirect(&level.draws, quads + 16);
            drop(pass);
            let last = i + 1 == target.levels.len();
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("resolve"),
                timestamp_writes: stamps.filter(|_| last).map(|s| s.compute(false, true)),
            });
            pass.set_pipeline(&self.resolve.0);
            pass.set_bind_group(0, &level.resolve, &[]);
            pass.dispatch_workgroups_indirect(&level.draws, RESOLVE);
        }
    }
}

impl SplatTarget {
    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes()
    }
}
