//! Cube maps on the GPU, lit after changes of the lights: the reflections of metals in rooms.
//!
//! * here: textures, kernels and their order;
//! * `rows` – the functions that light what texels see.

mod rows;

use super::relight::RelightPipelines;
use super::relight::elsewhere::DirectElsewhere;
use super::sky::{MOST_SKIES, ReflectedTexture};
use crate::gpu::Gpu;
use crate::gpu::bindings::{
    Slot, WORKGROUP, around, buffer, compute, empty_buffer, grid, group, layout, view,
};
use crate::gpu::scope::Scope;
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::cube_map::least_roughness;
use rebounce_shared::rbn::bulk::Point;
use rebounce_shared::rbn::cube_maps::CubeMaps;
use rows::FUNCTIONS;
use wgpu::{BufferUsages, ShaderStages, TextureFormat, TextureUsages, TextureViewDimension};

/// Format of the radiance.
const LIGHT: TextureFormat = TextureFormat::Rgba16Float;
/// Distance in place of infinity: `FAR` of cube_march.wgsl.
const FAR: f32 = 1e30;
/// Threads along an edge of a workgroup of cube_mips.wgsl.
const TILE: u32 = 8;
/// Faces of a cube.
const FACES: u32 = 6;

/// `CubeLight` in cube_light.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct CubeUniform {
    sky: [[f32; 4]; MOST_SKIES],
    skies: u32,
    side: u32,
    count: u32,
    groups: u32,
    unit: f32,
    pad: [u32; 3],
}

/// The kernels, independent of a scene.
pub struct CubeMapKernels {
    light: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
    mips: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
    sampler: wgpu::Sampler,
}

impl CubeMapKernels {
    /// Creates the pipelines.
    pub fn new(gpu: &Gpu) -> Self {
        let made = |entry: &str, source: shaders::Source, slots: &[Slot]| {
            let layout = layout(gpu, entry, ShaderStages::COMPUTE, slots);
            let pipeline = compute(gpu, entry, source, &[&layout], &[]);
            (layout, pipeline)
        };
        let mut slots = vec![Slot::Uniform];
        slots.extend([Slot::Read; 7]);
        slots.extend([Slot::Texture, Slot::Sampler, Slot::WriteArray(LIGHT)]);
        Self {
            light: made("cube_light", shaders::CUBE_LIGHT, &slots),
            mips: made("cube_mips", shaders::CUBE_MIPS, &[Slot::TextureArray, Slot::WriteArray(LIGHT)]),
            sampler: around(gpu),
        }
    }
}

/// What pictures read of the maps.
pub struct CubeMapTextures {
    /// Places of the maps, four floats each.
    pub places: wgpu::Buffer,
    /// Distances.
    pub distances: wgpu::TextureView,
    /// Radiance and coverage, all levels.
    pub radiance: wgpu::TextureView,
}

/// Cube maps of a scene.
pub struct GpuCubeMaps {
    /// Number of maps.
    pub count: u32,
    /// Texels along an edge of a face.
    pub side: u32,
    /// Roughness of the smoothest metals that reflect them.
    pub least_roughness: f32,
    /// What pictures read.
    pub textures: CubeMapTextures,
    /// Light of lamps at what the texels see.
    pub direct: DirectElsewhere,
    texels: wgpu::Buffer,
    uniform: wgpu::Buffer,
    /// A view of each level of the radiance.
    levels: Vec<wgpu::TextureView>,
    mips: Vec<wgpu::BindGroup>,
    /// A texture that is not read, where there is no sky.
    no_sky: wgpu::TextureView,
    own: Scope,
}

/// Distant light and the scene's, for [`GpuCubeMaps::light`].
pub struct CubeMapLight<'a> {
    /// By sky: factor of the texture, RGB, and rotation in radians.
    pub skies: &'a [[f32; 4]],
    /// The environment.
    pub sky: Option<&'a ReflectedTexture>,
    /// Irradiance of the points; radiance of groups; numbers of points in the glossy transfer; what arrives there.
    pub buffers: [&'a wgpu::Buffer; 4],
    /// Factor of radiance in the textures.
    pub unit: f32,
}

impl GpuCubeMaps {
    /// Uploads the maps of a scene; `None` without any.
    pub fn new(
        gpu: &Gpu,
        kernels: &CubeMapKernels,
        relight: (&RelightPipelines, &super::relight::Relight),
        scene: &BakedScene,
    ) -> Option<Self> {
        let maps = &scene.cube_maps;
        if maps.is_empty() {
            return None;
        }
        let own = Scope::new(gpu);
        let (points, texels) = seen(scene, maps);
        let (count, side) = (maps.layout.places.len() as u32, maps.layout.side);
        let storage = BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let texels = buffer(&own, "CMTX", storage, bytemuck::cast_slice(&texels));
        let places: Vec<[f32; 4]> = maps.layout.places.iter().map(|[x, y, z]| [*x, *y, *z, 0.0]).collect();
        let places = buffer(&own, "CMLY", storage, bytemuck::cast_slice(&places));
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let uniform = empty_buffer(&own, "cube light", usage, size_of::<CubeUniform>() as u64);
        let size =
            |side: u32, layers| wgpu::Extent3d { width: side, height: side, depth_or_array_layers: layers };
        let cubes = |label, format, mip_level_count, usage| {
            own.texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: size(side, FACES * count),
                mip_level_count,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: TextureUsages::TEXTURE_BINDING | usage,
                view_formats: &[],
            })
        };
        let as_cubes = |texture: &wgpu::Texture| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(TextureViewDimension::CubeArray),
                ..Default::default()
            })
        };
        let far = cubes("distances", TextureFormat::R32Float, 1, TextureUsages::COPY_DST);
        let distances: Vec<f32> =
            maps.texels.iter().map(|texel| texel.distance(&maps.layout).min(FAR)).collect();
        own.queue.write_texture(
            far.as_image_copy(),
            bytemuck::cast_slice(&distances),
            wgpu::TexelCopyBufferLayout {
                bytes_per_row: Some(4 * side),
                rows_per_image: Some(side),
                ..Default::default()
            },
            size(side, FACES * count),
        );
        let lit = cubes("cube maps", LIGHT, side.ilog2() + 1, TextureUsages::STORAGE_BINDING);
        let level = |level| {
            lit.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(TextureViewDimension::D2Array),
                base_mip_level: level,
                mip_level_count: Some(1),
                ..Default::default()
            })
        };
        let levels: Vec<wgpu::TextureView> = (0..lit.mip_level_count()).map(level).collect();
        let mips = levels
            .windows(2)
            .map(|pair| group(gpu, "cube mips", &kernels.mips.0, &[view(&pair[0]), view(&pair[1])]));
        let none = own.texture(&wgpu::TextureDescriptor {
            label: Some("no sky"),
            size: size(1, 1),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: TextureFormat::Rgb9e5Ufloat,
            usage: TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let (pipelines, relight) = relight;
        Some(Self {
            count,
            side,
            least_roughness: least_roughness(maps.cube()),
            textures: CubeMapTextures { places, distances: as_cubes(&far), radiance: as_cubes(&lit) },
            direct: DirectElsewhere::new(&own, pipelines, relight, &points),
            texels,
            uniform,
            mips: mips.collect(),
            levels,
            no_sky: none.create_view(&Default::default()),
            own,
        })
    }

    /// Lights the maps: after direct light at what they see, light at the points and the glossy transfer.
    pub fn light(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        kernels: &CubeMapKernels,
        light: &CubeMapLight<'_>,
    ) {
        let count = FACES * self.count * self.side * self.side;
        let groups = grid(count.div_ceil(WORKGROUP));
        let uniform = CubeUniform {
            sky: std::array::from_fn(|i| light.skies.get(i).copied().unwrap_or_default()),
            skies: light.skies.len().min(MOST_SKIES) as u32,
            side: self.side,
            count,
            groups: groups[0],
            unit: light.unit,
            pad: [0; 3],
        };
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
        let [display, emission, places, arriving] = light.buffers.map(|buffer| buffer.as_entire_binding());
        let resources = [
            self.uniform.as_entire_binding(),
            self.direct.points.as_entire_binding(),
            self.texels.as_entire_binding(),
            display,
            self.direct.irradiance.as_entire_binding(),
            emission,
            places,
            arriving,
            view(light.sky.map_or(&self.no_sky, |sky| &sky.view)),
            wgpu::BindingResource::Sampler(&kernels.sampler),
            view(&self.levels[0]),
        ];
        // The environment may be another one each time.
        let bound = group(gpu, "cube light", &kernels.light.0, &resources);
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&kernels.light.1);
        pass.set_bind_group(0, &bound, &[]);
        pass.dispatch_workgroups(groups[0], groups[1], 1);
        pass.set_pipeline(&kernels.mips.1);
        let mut side = self.side;
        for bound in &self.mips {
            side /= 2;
            let tiles = side.div_ceil(TILE);
            pass.set_bind_group(0, bound, &[]);
            pass.dispatch_workgroups(tiles, tiles, FACES * self.count);
        }
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes()
    }
}

/// What texels see: points for direct light, and the words of cube_light.wgsl.
fn seen(scene: &BakedScene, maps: &CubeMaps) -> (Vec<Point>, Vec<u32>) {
    let mut points = Vec::with_capacity(maps.texels.len());
    let mut words = Vec::with_capacity((2 + FUNCTIONS) * maps.texels.len());
    for (i, texel) in maps.texels.iter().enumerate() {
        let point = maps.point(i);
        words.extend([texel.reflectance, texel.groups & 0xffff]);
        words.extend(match &point {
            Some(point) => rows::row(scene, point.position(), point.normal(), texel.group()),
            None => [0; FUNCTIONS],
        });
        points.push(point.unwrap_or_default());
    }
    (points, words)
}
