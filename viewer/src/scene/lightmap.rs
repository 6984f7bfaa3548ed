//! The lightmap of a fixed solution on the GPU: a texture with a layer for each column of light, and where vertices are in it.

use crate::error::ViewerError;
use crate::gpu::Gpu;
use crate::gpu::bindings::{Slot, bilinear, buffer, empty_buffer, group, layout, view};
use crate::gpu::scope::Scope;
use crate::scene::relight::Parts;
use crate::scene::upload::Upload;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
use rebounce_shared::rbn::lightmap::{ChartOffset, TexelCoordinates};
use std::cell::OnceCell;
use wgpu::{BufferUsages, ShaderStages, TextureDimension, TextureFormat, TextureUsages};

/// Coordinates by vertex, and offsets by instance: locations 6 and 7 of lightmap.wgsl, after those of
/// [`VERTEX_BUFFERS`](crate::scene::draw_batch::VERTEX_BUFFERS).
pub const CHART_BUFFERS: [Option<wgpu::VertexBufferLayout<'static>>; 2] = [
    Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<TexelCoordinates>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![6 => Uint16x2],
    }),
    Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<ChartOffset>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![7 => Uint16x4],
    }),
];

/// The layout of lightmap bind groups; made for the first scene with a lightmap.
pub type LightmapLayoutCell = OnceCell<wgpu::BindGroupLayout>;

/// Texture, coordinates and strengths.
pub struct GpuLightmap {
    /// Whether every triangle has a chart: pixels show no light of the points.
    pub is_whole: bool,
    /// The bind group of lightmap.wgsl.
    pub group: wgpu::BindGroup,
    coordinates: wgpu::Buffer,
    offsets: wgpu::Buffer,
    strengths: wgpu::Buffer,
    /// By layer: its group of light, its scale, and whether it is direct light.
    layers: Vec<(usize, f32, bool)>,
    own: Scope,
}

impl GpuLightmap {
    /// Uploads the lightmap of a scene; `None` without one.
    ///
    /// # Errors
    /// [`ViewerError::TooLarge`] for more layers than the device has.
    pub fn new(
        gpu: &Gpu,
        layouts: &LightmapLayoutCell,
        scene: &BakedScene,
    ) -> Result<Option<Self>, ViewerError> {
        let lightmap = &scene.lightmap;
        if lightmap.is_empty() {
            return Ok(None);
        }
        let own = Scope::new(gpu);
        let groups = scene.light_groups.groups.len();
        let columns = scene.light_groups.column_groups().enumerate();
        let layers: Vec<_> =
            columns.map(|(layer, group)| (group, lightmap.layout.scales[layer], layer >= groups)).collect();
        let [width, height] = lightmap.layout.size;
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: layers.len() as u32 };
        let texture = own.texture(&wgpu::TextureDescriptor {
            label: Some("lightmap"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format: TextureFormat::Rgb9e5Ufloat,
            usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let rows = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * width),
            rows_per_image: Some(height),
        };
        gpu.queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&lightmap.texels), rows, size);
        let all = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        let strengths = empty_buffer(
            &own,
            "lightmap strengths",
            BufferUsages::STORAGE | BufferUsages::COPY_DST,
            16 * layers.len() as u64,
        );
        let made = layouts.get_or_init(|| {
            let slots = [Slot::TextureArray, Slot::Sampler, Slot::Read];
            layout(gpu, "lightmap", ShaderStages::FRAGMENT, &slots)
        });
        let sampler = bilinear(gpu);
        let resources = [view(&all), wgpu::BindingResource::Sampler(&sampler), strengths.as_entire_binding()];
        Ok(Some(Self {
            is_whole: lightmap.coordinates.iter().all(|at| *at != TexelCoordinates::NONE),
            group: group(gpu, "lightmap", made, &resources),
            coordinates: buffer(
                &own,
                "LMUV",
                BufferUsages::VERTEX,
                bytemuck::cast_slice(&lightmap.coordinates),
            ),
            offsets: buffer(&own, "LMOF", BufferUsages::VERTEX, bytemuck::cast_slice(&lightmap.offsets)),
            strengths,
            layers,
            own,
        }))
    }

    /// Sets the strength of each group, linear RGB, and what of the light is displayed.
    pub fn set_strengths(&self, gpu: &Gpu, strengths: &[Vec3], parts: Parts) {
        let of_layer = |&(group, scale, is_direct): &(usize, f32, bool)| {
            let is_shown = if is_direct { parts.from_sources } else { parts.bounced };
            let strength = strengths.get(group).copied().unwrap_or(Vec3::ZERO);
            (strength * scale * f32::from(is_shown)).extend(0.0).to_array()
        };
        let rows: Vec<[f32; 4]> = self.layers.iter().map(of_layer).collect();
        gpu.queue.write_buffer(&self.strengths, 0, bytemuck::cast_slice(&rows));
    }

    /// Binds the buffers of the scene's draw batches and of the charts.
    pub fn bind(&self, pass: &mut wgpu::RenderPass<'_>, upload: &Upload) {
        upload.bind(pass);
        pass.set_vertex_buffer(2, self.coordinates.slice(..));
        pass.set_vertex_buffer(3, self.offsets.slice(..));
        pass.set_bind_group(1, &self.group, &[]);
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes()
    }
}
