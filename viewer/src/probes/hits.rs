//! Reflectance and emission where rays have met surfaces: textures are on the GPU alone.

use super::caster::SurfaceHit;
use super::rows::{HitSurface, RAYS};
use crate::error::ViewerError;
use crate::gpu::Gpu;
use crate::gpu::bindings::{Draw, attachment, buffer, opaque, target};
use crate::gpu::readback::Readback;
use crate::gpu::scope::Scope;
use crate::scene::materials::Materials;
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::collections::BTreeMap;
use wgpu::{BufferUsages, TextureFormat};

/// Probes whose hits are looked up together: a row of the target each.
pub const BATCH: usize = 64;
const FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;

/// A hit, as the shader takes it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct HitRecord {
    uv: [f32; 2],
    texel: u32,
}

/// The pipeline.
pub struct HitPass(wgpu::RenderPipeline);

/// What surfaces do at hits, by row and ray.
pub struct HitSurfaces([Vec<u8>; 2]);

impl HitPass {
    /// Creates the pipeline; `material` is the layout of a material's bind group.
    pub fn new(gpu: &Gpu, material: &wgpu::BindGroupLayout) -> Self {
        let buffers = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<HitRecord>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &wgpu::vertex_attr_array![0 => Float32x2, 1 => Uint32],
        })];
        let empty = crate::gpu::bindings::layout(gpu, "none", wgpu::ShaderStages::FRAGMENT, &[]);
        Self(
            Draw {
                label: "hit surfaces",
                source: shaders::HIT_SURFACE,
                targets: &[opaque(FORMAT), opaque(FORMAT)],
                layouts: &[&empty, material],
                buffers: &buffers,
                ..Default::default()
            }
            .pipeline(gpu),
        )
    }

    /// Looks up the hits of at most [`BATCH`] probes.
    ///
    /// # Errors
    /// [`ViewerError::DeviceLost`], [`ViewerError::Internal`].
    pub async fn shades(
        &self,
        gpu: &Gpu,
        materials: &Materials,
        hits: &[&[Option<SurfaceHit>]],
    ) -> Result<HitSurfaces, ViewerError> {
        let mut of: BTreeMap<u32, Vec<HitRecord>> = BTreeMap::new();
        for (row, hits) in hits.iter().enumerate() {
            for (ray, hit) in hits.iter().enumerate() {
                if let Some(hit) = hit.filter(|hit| !hit.is_back) {
                    let record = HitRecord { uv: hit.uv.to_array(), texel: (row * RAYS + ray) as u32 };
                    of.entry(hit.material).or_default().push(record);
                }
            }
        }
        let begun = gpu.watch(|| {
            let own = Scope::new(gpu);
            let targets = [0, 1].map(|_| target(&own, "hit surfaces", FORMAT, RAYS as u32, BATCH as u32));
            let views = targets.each_ref().map(|texture| texture.create_view(&Default::default()));
            let records: Vec<HitRecord> = of.values().flatten().copied().collect();
            let records = buffer(&own, "hits", BufferUsages::VERTEX, bytemuck::cast_slice(&records));
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("hit surfaces"),
                color_attachments: &[attachment(&views[0], true), attachment(&views[1], true)],
                ..Default::default()
            });
            pass.set_pipeline(&self.0);
            pass.set_vertex_buffer(0, records.slice(..));
            let mut first = 0;
            for (material, hits) in &of {
                let end = first + hits.len() as u32;
                pass.set_bind_group(1, &materials.groups[*material as usize], &[]);
                pass.draw(0..3, first..end);
                first = end;
            }
            drop(pass);
            gpu.queue.submit([encoder.finish()]);
            targets.each_ref().map(|texture| Readback::texture(gpu, texture, 4))
        });
        let [albedo, emission] = begun;
        Ok(HitSurfaces([albedo.wait().await?, emission.wait().await?]))
    }
}

impl HitSurfaces {
    /// What the surface does at the hit of a ray of the probe in this row.
    pub fn at(&self, row: usize, ray: usize) -> HitSurface {
        let texel =
            |bytes: &[u8]| bytes[4 * (row * RAYS + ray)..].first_chunk::<4>().copied().unwrap_or_default();
        let color = |[r, g, b, _]: [u8; 4]| Vec3::from([r, g, b].map(linear));
        let [albedo, emission] = self.0.each_ref().map(|bytes| texel(bytes));
        HitSurface { albedo: color(albedo), emission: color(emission), is_solid: albedo[3] > 127 }
    }
}

/// Linear value of an sRGB byte.
fn linear(byte: u8) -> f32 {
    let x = f32::from(byte) / 255.0;
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}
