//! A baked scene on the GPU, and what it takes on the CPU; knows no pass of a picture.
//!
//! * here: the scene;
//! * `upload` – the file's sections in buffers;
//! * `relight` – one frame of bounced light at its points;
//! * `moving`, `radiosity`, `reclip` – nodes that move, and the bounced light that follows them;
//! * `rig`, `rest_picture` – meshes that deform, and where the file has them;
//! * `antiradiance` – bounced light without visibility, for things that deform;
//! * `lightmap` – the light of a fixed solution as a texture; `gloss` – light that arrives at glossy surfaces;
//! * `materials`, `textures` – a bind group per material, mip levels;
//! * `draw_batch`, `fronts` – draw calls, and the winding of their triangles;
//! * `triangles` – the surfaces on the CPU, for ray casts;
//! * `extent`, `blended_fit` – bounds, and properties of the blended surfaces;
//! * `sky` – the environment behind it;
//! * `ground` – the ground under an object;
//! * `view` – the camera that looks at it.

#[cfg(feature = "antiradiance")]
pub mod antiradiance;
pub mod blended_fit;
#[cfg(feature = "radiosity")]
pub mod cube_maps;
pub mod draw_batch;
pub mod extent;
mod fronts;
#[cfg(feature = "radiosity")]
pub mod gloss;
pub(crate) mod ground;
#[cfg(feature = "radiosity")]
pub mod lightmap;
pub mod materials;
#[cfg(feature = "radiosity")]
pub mod moving;
#[cfg(feature = "radiosity")]
pub mod radiosity;
#[cfg(feature = "radiosity")]
mod reclip;
pub mod relight;
#[cfg(feature = "radiosity")]
pub mod rest_picture;
#[cfg(feature = "radiosity")]
pub mod rig;
pub mod sky;
pub mod textures;
pub mod triangles;
pub mod upload;
pub mod view;

use crate::error::ViewerError;
use crate::gpu::Gpu;
#[cfg(feature = "radiosity")]
use crate::gpu::scope::Scope;
#[cfg(feature = "antiradiance")]
use antiradiance::{Preparation, SceneAntiradiance};
#[cfg(feature = "radiosity")]
use cube_maps::{CubeMapKernels, GpuCubeMaps};
use extent::Extent;
use glam::Vec3;
#[cfg(feature = "radiosity")]
use gloss::{GlossKernels, GpuGloss};
#[cfg(feature = "radiosity")]
use lightmap::{GpuLightmap, LightmapLayoutCell};
use materials::Materials;
#[cfg(feature = "radiosity")]
use moving::Moving;
#[cfg(feature = "radiosity")]
use radiosity::RadiosityPipelines;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::light::Light;
use rebounce_shared::openness::REACH;
use rebounce_shared::rbn::meta::Meta;
use rebounce_shared::rbn::sources::Sources;
use relight::{Relight, RelightPipelines};
#[cfg(feature = "radiosity")]
use rig::{GpuRig, RigPipelines};
#[cfg(feature = "radiosity")]
use std::cell::OnceCell;
#[cfg(feature = "antiradiance")]
use std::cell::{Cell, RefCell};
use std::ops::Range;
use textures::Mips;
use upload::Upload;

/// Layouts and pipelines for loading scenes.
pub struct Loaders<'a> {
    /// The layout of a material's bind group.
    pub material: &'a wgpu::BindGroupLayout,
    /// Mip levels.
    pub mips: &'a Mips,
    /// Relighting.
    pub relight: &'a RelightPipelines,
    /// Radiosity; made for the first scene that takes it.
    #[cfg(feature = "radiosity")]
    pub radiosity: &'a OnceCell<RadiosityPipelines>,
    /// The layout of lightmaps.
    #[cfg(feature = "radiosity")]
    pub lightmap: &'a LightmapLayoutCell,
    /// Glossy transfer; made for the first scene with it.
    #[cfg(feature = "radiosity")]
    pub gloss: &'a OnceCell<GlossKernels>,
    /// Rigs; made for the first scene with one.
    #[cfg(feature = "radiosity")]
    pub rig: &'a OnceCell<RigPipelines>,
}

/// A scene on the GPU, with its metadata on the CPU.
pub struct GpuScene {
    /// Metadata.
    pub meta: Meta,
    /// The sky and groups of emissive surfaces.
    pub sources: Sources,
    /// Bulk sections.
    pub upload: Upload,
    /// Materials and textures.
    pub materials: Materials,
    /// Relighting.
    pub relight: Relight,
    /// Nodes that move, of a scene that radiosity can light.
    #[cfg(feature = "radiosity")]
    pub moving: Option<Moving>,
    /// Antiradiance, once it was prepared; `None` in it where the scene has more links than it can have.
    #[cfg(feature = "antiradiance")]
    pub antiradiance: OnceCell<Option<SceneAntiradiance>>,
    /// Its patches and links, on their way.
    #[cfg(feature = "antiradiance")]
    pub preparing: RefCell<Option<Preparation>>,
    /// Whether bounced light comes from antiradiance.
    #[cfg(feature = "antiradiance")]
    pub is_by_antiradiance: Cell<bool>,
    /// Meshes that deform, if there are any.
    #[cfg(feature = "radiosity")]
    pub rig: Option<GpuRig>,
    /// Lightmap of a fixed solution, if there is one.
    #[cfg(feature = "radiosity")]
    pub lightmap: Option<GpuLightmap>,
    /// Glossy transfer, if there is any.
    #[cfg(feature = "radiosity")]
    pub gloss: Option<GpuGloss>,
    /// Cube maps that metals reflect, if there are any.
    #[cfg(feature = "radiosity")]
    pub cube_maps: Option<GpuCubeMaps>,
    /// Points of each level.
    pub levels: Vec<Range<u32>>,
    /// Number of links, page marks included.
    pub link_count: usize,
    /// Number of triangles, with every instance counted.
    pub triangles: usize,
    /// Support radius of the finest functions, scene units: the tenth percentile.
    pub finest_radius: f32,
    /// Reach of openness, scene units; 0 for a file without openness.
    pub open_reach: f32,
    /// Distance of the near plane, scene units.
    pub near: f32,
    /// Bounds for shadow maps.
    pub extent: Extent,
    /// Whether functions are looked up, never splatted: where there are reconstruction groups, glossy transfer, or a rig.
    pub needs_lookup: bool,
}

impl GpuScene {
    /// The lights of a fixed solution; `None` where lights may move.
    pub fn solved_lights(&self) -> Option<&[Light]> {
        self.relight.is_solved().then_some(&self.meta.lights)
    }

    /// Nodes that move, where radiosity computes bounced light.
    #[cfg(feature = "radiosity")]
    pub fn by_radiosity(&self) -> Option<&Moving> {
        #[cfg(feature = "antiradiance")]
        if self.is_by_antiradiance.get() {
            return None;
        }
        self.moving.as_ref().filter(|_| self.relight.is_by_radiosity())
    }

    /// Whether no node has moved and the rig is in its pose at rest.
    #[cfg(feature = "antiradiance")]
    pub fn is_at_rest(&self) -> bool {
        !self.is_posed() && !self.moving.as_ref().is_some_and(Moving::is_moved)
    }

    /// Whether something deforms.
    #[cfg(feature = "antiradiance")]
    pub fn is_posed(&self) -> bool {
        self.rig.as_ref().is_some_and(|rig| rig.moment().is_some())
    }

    /// Antiradiance, if it is prepared.
    #[cfg(feature = "antiradiance")]
    pub fn own_antiradiance(&self) -> Option<&SceneAntiradiance> {
        self.antiradiance.get()?.as_ref()
    }

    /// Antiradiance, where it computes bounced light.
    #[cfg(feature = "antiradiance")]
    pub fn by_antiradiance(&self) -> Option<&SceneAntiradiance> {
        self.own_antiradiance().filter(|_| self.is_by_antiradiance.get())
    }

    /// The glossy transfer that pictures show; `None` where something else than links computes bounced light.
    #[cfg(feature = "radiosity")]
    pub fn reflecting(&self) -> Option<&GpuGloss> {
        self.gloss.as_ref().filter(|_| self.moving.is_none() || !self.relight.is_by_radiosity())
    }

    /// Bytes on the GPU for bounced light.
    pub fn light_bytes(&self) -> u64 {
        #[cfg(feature = "radiosity")]
        let more = self.moving.as_ref().map_or(0, Moving::bytes)
            + self.rig.as_ref().map_or(0, GpuRig::bytes)
            + self.lightmap.as_ref().map_or(0, GpuLightmap::bytes)
            + self.gloss.as_ref().map_or(0, GpuGloss::bytes)
            + self.cube_maps.as_ref().map_or(0, GpuCubeMaps::bytes);
        #[cfg(not(feature = "radiosity"))]
        let more = 0;
        #[cfg(feature = "antiradiance")]
        let more = more + self.own_antiradiance().map_or(0, SceneAntiradiance::bytes);
        self.relight.bytes() + more
    }

    /// Uploads a scene; asynchronous, as textures are decoded meanwhile.
    ///
    /// # Errors
    /// [`ViewerError::TooLarge`] before the first upload, [`ViewerError::Texture`], [`ViewerError::OutOfMemory`],
    /// or [`ViewerError::Internal`] for any other refusal by the device.
    pub async fn upload(gpu: &Gpu, loaders: Loaders<'_>, scene: BakedScene) -> Result<Self, ViewerError> {
        let (upload, relight, moving) = gpu.watch(|| {
            let upload = Upload::new(gpu, &scene)?;
            #[cfg(feature = "radiosity")]
            if moving::is_solvable(&scene) || !scene.rig.is_empty() {
                let moved = moving::is_solvable(&scene).then(|| {
                    let own = Scope::new(gpu);
                    let points = moving::points(&own, &scene);
                    (own, points)
                });
                let placed = moved.as_ref().map_or(&upload.points, |(_, points)| points);
                let pipelines = || loaders.rig.get_or_init(|| RigPipelines::new(gpu)).clone();
                let rig = GpuRig::new(gpu, pipelines, &upload, placed, &scene);
                let lit = rig.as_ref().map_or(placed, |rig| &rig.points);
                let relight = Relight::new(gpu, loaders.relight, &upload, lit, &scene);
                let moving = match moved {
                    Some((own, points)) => {
                        Some(Moving::new(gpu, &loaders, (&upload, &relight), (own, &points), &scene)?)
                    }
                    None => None,
                };
                return Ok::<_, ViewerError>((upload, relight, (moving, rig)));
            }
            let relight = Relight::new(gpu, loaders.relight, &upload, &upload.points, &scene);
            #[cfg(feature = "radiosity")]
            return Ok((upload, relight, (None, None)));
            #[cfg(not(feature = "radiosity"))]
            Ok::<_, ViewerError>((upload, relight, ()))
        })?;
        #[cfg(feature = "radiosity")]
        let (moving, rig) = moving;
        #[cfg(not(feature = "radiosity"))]
        let () = moving;
        #[cfg(feature = "radiosity")]
        let lightmap = gpu.watch(|| GpuLightmap::new(gpu, loaders.lightmap, &scene))?;
        #[cfg(feature = "radiosity")]
        let gloss = gpu.watch(|| match scene.gloss.is_empty() {
            true => Ok(None),
            false => {
                let kernels = loaders.gloss.get_or_init(|| GlossKernels::new(gpu));
                GpuGloss::new(gpu, kernels, (&upload, &relight.sent), &scene)
            }
        })?;
        // Maps show where things stand.
        #[cfg(feature = "radiosity")]
        let cube_maps =
            loaders.gloss.get().filter(|_| gloss.is_some() && !has_nodes(moving.as_ref())).and_then(
                |kernels| {
                    let made = kernels.cube_maps.get_or_init(|| CubeMapKernels::new(gpu));
                    gpu.watch(|| GpuCubeMaps::new(gpu, made, (loaders.relight, &relight), &scene))
                },
            );
        let materials = Materials::new(gpu, loaders.material, loaders.mips, &scene).await?;
        gpu.settle().await;
        gpu.check()?;
        let bounds = [Vec3::from(scene.meta.bounds_min), Vec3::from(scene.meta.bounds_max)];
        #[cfg(feature = "radiosity")]
        let extent = Extent::new(with_poses(bounds, &scene), finest(&scene));
        #[cfg(not(feature = "radiosity"))]
        let extent = Extent::new(bounds, finest(&scene));
        let diagonal = (bounds[1] - bounds[0]).length().max(f32::MIN_POSITIVE);
        // Small enough to move the eye close to the finest functions.
        let finest_support = scene.meta.levels.last().map_or(f32::MAX, |l| l.support_radius);
        let finest_radius = tenth(scene.points[scene.display()].iter().map(|p| p.radius));
        let near = (1e-3 * diagonal).min(0.1 * finest_support).max(1e-6 * diagonal);
        Ok(Self {
            levels: (0..scene.meta.levels.len())
                .map(|l| scene.level(l).start as u32..scene.level(l).end as u32)
                .collect(),
            link_count: scene.link_count() + scene.later.links.len(),
            triangles: scene.triangles_placed() as usize,
            meta: scene.meta,
            sources: scene.sources,
            upload,
            materials,
            relight,
            #[cfg(feature = "radiosity")]
            moving,
            #[cfg(feature = "antiradiance")]
            antiradiance: OnceCell::new(),
            #[cfg(feature = "antiradiance")]
            preparing: None.into(),
            #[cfg(feature = "antiradiance")]
            is_by_antiradiance: false.into(),
            #[cfg(feature = "radiosity")]
            rig,
            #[cfg(feature = "radiosity")]
            lightmap,
            finest_radius,
            open_reach: if scene.openness.is_empty() { 0.0 } else { REACH * finest_support },
            near,
            extent,
            #[cfg(not(feature = "radiosity"))]
            needs_lookup: !scene.groups.is_empty(),
            #[cfg(feature = "radiosity")]
            needs_lookup: !scene.groups.is_empty() || gloss.is_some() || !scene.rig.is_empty(),
            #[cfg(feature = "radiosity")]
            gloss,
            #[cfg(feature = "radiosity")]
            cube_maps,
        })
    }
}

/// Returns the tenth percentile of positive values; 0 without values. A bisection over bit patterns, ordered like
/// the values: less code than a selection.
fn tenth(values: impl ExactSizeIterator<Item = f32> + Clone) -> f32 {
    let rank = values.len() / 10;
    let mut bits = 0u32;
    for bit in (0..31).rev() {
        let trial = bits | 1 << bit;
        let below = values.clone().filter(|value| value.to_bits() < trial).count();
        if below <= rank && rank < values.len() {
            bits = trial;
        }
    }
    f32::from_bits(bits)
}

/// Whether a node may move.
#[cfg(feature = "radiosity")]
fn has_nodes(moving: Option<&Moving>) -> bool {
    moving.is_some_and(|moving| moving.names().next().is_some())
}

/// Bounds of the scene with all poses of what deforms.
#[cfg(feature = "radiosity")]
fn with_poses([low, high]: [Vec3; 2], scene: &BakedScene) -> [Vec3; 2] {
    if scene.rig.is_empty() {
        return [low, high];
    }
    let [least, greatest] = scene.rig.layout.bounds.map(Vec3::from);
    [low.min(least), high.max(greatest)]
}

/// Minimum and maximum corner of the supports of the two finest levels, local space.
fn finest(scene: &BakedScene) -> [Vec3; 2] {
    let levels = scene.meta.levels.len();
    let points = (levels.saturating_sub(2)..levels).flat_map(|l| &scene.points[scene.level(l)]);
    let start = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    points.fold(start, |[low, high], p| [low.min(p.position() - p.radius), high.max(p.position() + p.radius)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tenth_of_the_values_falls_short() {
        let values: Vec<f32> = (0..57u32).map(|i| 0.01 + (i * 7919 % 57) as f32 * 1.5).collect();
        for count in [1, 9, 10, 11, 57] {
            let mut first = values[..count].to_vec();
            first.sort_by(f32::total_cmp);
            assert_eq!(tenth(values[..count].iter().copied()), first[count / 10]);
        }
        assert_eq!(tenth(std::iter::empty()), 0.0);
        assert_eq!(tenth([2.5f32; 20].into_iter()), 2.5);
    }
}
