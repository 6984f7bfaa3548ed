//! The rows of probes applied on the GPU: [`apply`](super::rows::apply).

use super::grid::Grid;
use super::harmonics::COUNT;
use super::rows::{PLANES, Rows};
use crate::gpu::Gpu;
use crate::gpu::bindings::{
    Slot, WORKGROUP, buffer, compute, empty_buffer, grid as groups, group, layout, target,
};
use crate::gpu::scope::Scope;
use crate::scene::GpuScene;
use crate::shaders;
use glam::Vec3;
use wgpu::{BufferUsages, ShaderStages, TextureFormat};

/// Probes in a row of the textures.
pub const PER_ROW: u32 = 64;
/// Format of the textures.
pub const FORMAT: TextureFormat = TextureFormat::Rgba32Float;

/// The pipeline.
pub struct ProbePass {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

/// The probes of a file on the GPU.
pub struct GpuProbes {
    own: Scope,
    /// Where they are.
    pub grid: Grid,
    /// Radiance: RGB by probe and coefficient.
    pub radiance: wgpu::Buffer,
    /// The same: [`PER_ROW`] probes a row, their coefficients side by side.
    pub radiance_texture: wgpu::Texture,
    /// Planes: [`PER_ROW`] maps of [`PLANES`] × [`PLANES`] texels a row.
    pub planes: wgpu::Texture,
    /// How probes are moved, and whether they are in free space: [`PER_ROW`] a row.
    pub moved: wgpu::Texture,
    strengths: wgpu::Buffer,
    /// The rows, once they are there.
    rows: Option<(wgpu::BindGroup, Scope)>,
}

impl ProbePass {
    /// Creates the pipeline.
    pub fn new(gpu: &Gpu) -> Self {
        let slots = [Slot::Read, Slot::Read, Slot::Read, Slot::Read, Slot::Read, Slot::Write];
        let layout = layout(gpu, "probes", ShaderStages::COMPUTE, &slots);
        Self { pipeline: compute(gpu, "probes", shaders::PROBES, &[&layout], &[]), layout }
    }

    /// Textures and buffers of probes that are within something solid, all of them, until they have rows.
    pub fn allocate(&self, gpu: &Gpu, scene: &GpuScene, grid: Grid) -> GpuProbes {
        let own = Scope::new(gpu);
        let height = (grid.len() as u32).div_ceil(PER_ROW);
        let coefficients = PER_ROW * COUNT as u32;
        let texture = |label, width, height| target(&own, label, FORMAT, width, height);
        let radiance_texture = texture("radiance of probes", coefficients, height);
        let side = PLANES as u32;
        let planes = texture("planes of probes", PER_ROW * side, height * side);
        let moved = texture("moves of probes", PER_ROW, height);
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let radiance = empty_buffer(&own, "radiance of probes", usage, 16 * u64::from(coefficients * height));
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let strengths = empty_buffer(&own, "strengths", usage, 16 * scene.sources.count() as u64);
        GpuProbes { own, grid, radiance, radiance_texture, planes, moved, strengths, rows: None }
    }

    /// Uploads the rows of probes.
    pub fn upload(&self, gpu: &Gpu, scene: &GpuScene, probes: &mut GpuProbes, rows: &Rows) {
        let own = Scope::new(gpu);
        let stored = |label, bytes: &[u8]| buffer(&own, label, BufferUsages::STORAGE, bytes);
        write(gpu, &probes.planes, &arranged(&rows.planes, PLANES, PLANES));
        write(gpu, &probes.moved, &arranged(&rows.moved, 1, 1));
        let buffers = [
            &stored("probes", bytemuck::cast_slice(&rows.offsets)),
            &stored("probes", bytemuck::cast_slice(&rows.entries)),
            &scene.upload.points,
            &scene.relight.irradiance,
            &probes.strengths,
            &probes.radiance,
        ];
        let group = group(&own, "probes", &self.layout, &buffers.map(|buffer| buffer.as_entire_binding()));
        probes.rows = Some((group, own));
    }

    /// After a change of the light at the senders: computes the radiance of every probe; none without rows. `strengths` of
    /// sources.
    pub fn fill(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        probes: &GpuProbes,
        strengths: &[Vec3],
    ) {
        let Some((rows, _)) = &probes.rows else { return };
        let strengths: Vec<_> = strengths.iter().map(|strength| strength.extend(0.0)).collect();
        gpu.queue.write_buffer(&probes.strengths, 0, bytemuck::cast_slice(&strengths));
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("probes"),
            timestamp_writes: None,
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, rows, &[]);
        let [x, y] = groups(((probes.grid.len() * COUNT) as u32).div_ceil(WORKGROUP));
        pass.dispatch_workgroups(x, y, 1);
        drop(pass);
        let size = probes.radiance_texture.size();
        encoder.copy_buffer_to_texture(
            wgpu::TexelCopyBufferInfo { buffer: &probes.radiance, layout: rows_of(size.width) },
            probes.radiance_texture.as_image_copy(),
            size,
        );
    }
}

impl GpuProbes {
    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes() + self.rows.as_ref().map_or(0, |(_, own)| own.bytes())
    }
}

/// Texels of maps of `width` by `height` texels, probe by probe, as rows of a texture with [`PER_ROW`] maps side by side.
fn arranged(maps: &[[f32; 4]], width: usize, height: usize) -> Vec<[f32; 4]> {
    let (row, map) = (PER_ROW as usize * width, width * height);
    let rows = (maps.len() / map).div_ceil(PER_ROW as usize) * height;
    let mut out = vec![[0.0; 4]; row * rows];
    for (i, texel) in maps.iter().enumerate() {
        let (probe, x, y) = (i / map, i % width, i % map / width);
        let (column, line) = (probe % PER_ROW as usize, probe / PER_ROW as usize);
        out[(line * height + y) * row + column * width + x] = *texel;
    }
    out
}

fn write(gpu: &Gpu, texture: &wgpu::Texture, texels: &[[f32; 4]]) {
    let size = texture.size();
    let bytes = bytemuck::cast_slice(texels);
    gpu.queue.write_texture(texture.as_image_copy(), bytes, rows_of(size.width), size);
}

fn rows_of(width: u32) -> wgpu::TexelCopyBufferLayout {
    wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(16 * width), rows_per_image: None }
}
