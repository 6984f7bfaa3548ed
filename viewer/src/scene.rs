//! A baked scene on the GPU.

use crate::error::ViewerError;
use crate::gpu::Gpu;
use crate::materials::Materials;
use crate::pipelines::Pipelines;
use crate::relight::Relight;
use crate::shadow_fit::Extent;
use crate::upload::Upload;
use glam::Vec3;
use rebounce_shared::rbn::Scene;
use rebounce_shared::rbn::meta::Meta;
use std::ops::Range;

/// A scene on the GPU; what the CPU still needs is its metadata.
pub struct LoadedScene {
    /// Metadata.
    pub meta: Meta,
    /// Bulk sections.
    pub upload: Upload,
    /// Materials and textures.
    pub materials: Materials,
    /// Relighting.
    pub relight: Relight,
    /// Points of each level.
    pub levels: Vec<Range<u32>>,
    /// Number of links, page marks included.
    pub link_count: usize,
    /// Number of triangles, those of each copy counted.
    pub triangles: usize,
    /// Support radius of the finest functions, scene units: that which a tenth of them fall short of.
    pub finest_radius: f32,
    /// Distance of the near plane, scene units.
    pub near: f32,
    /// Where it lies.
    pub extent: Extent,
}

impl LoadedScene {
    /// Uploads a scene. Textures are decoded meanwhile, so this is not done at once.
    ///
    /// # Errors
    /// [`ViewerError::TooLarge`] before anything is uploaded, [`ViewerError::Texture`], [`ViewerError::OutOfMemory`], or
    /// [`ViewerError::Internal`] where the device refuses something else.
    pub async fn upload(gpu: &Gpu, pipelines: &Pipelines, scene: Scene) -> Result<Self, ViewerError> {
        let (upload, relight) = gpu.watch(|| {
            let upload = Upload::new(gpu, &scene)?;
            let relight = Relight::new(gpu, &pipelines.relight, &upload, &scene);
            Ok::<_, ViewerError>((upload, relight))
        })?;
        let materials = Materials::new(gpu, pipelines, &scene).await?;
        gpu.settle().await;
        gpu.check()?;
        let bounds = [Vec3::from(scene.meta.bounds_min), Vec3::from(scene.meta.bounds_max)];
        let extent = Extent::new(bounds, finest(&scene));
        let diagonal = (bounds[1] - bounds[0]).length().max(f32::MIN_POSITIVE);
        // Near enough that the eye can go close to the finest functions.
        let finest_support = scene.meta.levels.last().map_or(f32::MAX, |l| l.support_radius);
        let mut radii: Vec<f32> = scene.points[scene.display()].iter().map(|p| p.radius).collect();
        let tenth = radii.len() / 10;
        let finest_radius =
            if radii.is_empty() { 0.0 } else { *radii.select_nth_unstable_by(tenth, f32::total_cmp).1 };
        let near = (1e-3 * diagonal).min(0.1 * finest_support).max(1e-6 * diagonal);
        Ok(Self {
            levels: (0..scene.meta.levels.len())
                .map(|l| scene.level(l).start as u32..scene.level(l).end as u32)
                .collect(),
            link_count: scene.link_count() + scene.later.links.len(),
            triangles: scene.triangles_placed() as usize,
            meta: scene.meta,
            upload,
            materials,
            relight,
            finest_radius,
            near,
            extent,
        })
    }
}

/// Least and greatest corner of the supports of the two finest levels, local space.
fn finest(scene: &Scene) -> [Vec3; 2] {
    let levels = scene.meta.levels.len();
    let points = (levels.saturating_sub(2)..levels).flat_map(|l| &scene.points[scene.level(l)]);
    let start = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    points.fold(start, |[low, high], p| [low.min(p.position() - p.radius), high.max(p.position() + p.radius)])
}
