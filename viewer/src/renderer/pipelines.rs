//! Resources of a device, independent of viewers: created once, shared by all viewers of the device.

use crate::error::ViewerError;
use crate::gpu::Gpu;
use crate::passes::blended::BlendedPass;
use crate::passes::composite::CompositePass;
use crate::passes::display::DisplayPass;
use crate::passes::gbuffer::GBufferPass;
#[cfg(feature = "radiosity")]
use crate::passes::lightmap::LightmapPass;
use crate::passes::overlay::OverlayPass;
#[cfg(feature = "radiosity")]
use crate::passes::reflections::ReflectionsPass;
#[cfg(feature = "radiosity")]
use crate::passes::rest_places::RestPlacesPass;
use crate::passes::shadow::ShadowPipelines;
use crate::scene::Loaders;
#[cfg(feature = "antiradiance")]
use crate::scene::antiradiance::AntiradiancePipelines;
#[cfg(feature = "radiosity")]
use crate::scene::gloss::GlossKernels;
use crate::scene::materials::material_layout;
#[cfg(feature = "radiosity")]
use crate::scene::radiosity::RadiosityPipelines;
use crate::scene::relight::RelightPipelines;
#[cfg(feature = "radiosity")]
use crate::scene::rig::RigPipelines;
use crate::scene::textures::Mips;
#[cfg(feature = "radiosity")]
use std::cell::OnceCell;
use std::cell::RefCell;
use std::rc::Rc;
use wgpu::TextureFormat;

/// The pipelines of all passes.
pub struct Pipelines {
    /// The layout of a material's bind group.
    pub material: wgpu::BindGroupLayout,
    /// Shadow maps.
    pub shadow: ShadowPipelines,
    /// Relighting.
    pub relight: RelightPipelines,
    /// G-buffer.
    pub gbuffer: GBufferPass,
    /// From points to pixels.
    pub display: DisplayPass,
    /// Blended surfaces.
    pub blended: BlendedPass,
    /// Shading, exposure, tone mapping.
    pub composite: CompositePass,
    /// Mip levels.
    pub mips: Mips,
    /// Radiosity; made for the first scene that takes it.
    #[cfg(feature = "radiosity")]
    pub radiosity: OnceCell<RadiosityPipelines>,
    /// Antiradiance; made when it is first chosen.
    #[cfg(feature = "antiradiance")]
    pub antiradiance: OnceCell<AntiradiancePipelines>,
    /// Light of lightmaps.
    #[cfg(feature = "radiosity")]
    pub lightmap: LightmapPass,
    /// Glossy transfer; made for the first scene with it.
    #[cfg(feature = "radiosity")]
    pub gloss: OnceCell<GlossKernels>,
    /// Reflections.
    #[cfg(feature = "radiosity")]
    pub reflections: ReflectionsPass,
    /// Rigs; made for the first scene with one.
    #[cfg(feature = "radiosity")]
    pub rig: OnceCell<RigPipelines>,
    /// Where the file has what deforms.
    #[cfg(feature = "radiosity")]
    pub rest_places: RestPlacesPass,
    overlay: RefCell<Vec<Rc<OverlayPass>>>,
}

impl Pipelines {
    /// Creates the pipelines.
    ///
    /// # Errors
    /// [`ViewerError::Internal`] if the device refuses a pipeline immediately.
    pub fn new(gpu: &Gpu) -> Result<Self, ViewerError> {
        let material = material_layout(gpu);
        let shadow = ShadowPipelines::new(gpu, &material);
        let pipelines = Self {
            relight: RelightPipelines::new(gpu, &shadow.layout),
            gbuffer: GBufferPass::new(gpu, &material),
            display: DisplayPass::new(gpu),
            blended: BlendedPass::new(&material, &shadow.layout),
            composite: CompositePass::new(gpu, &shadow.layout),
            mips: Mips::new(gpu),
            #[cfg(feature = "radiosity")]
            radiosity: OnceCell::new(),
            #[cfg(feature = "antiradiance")]
            antiradiance: OnceCell::new(),
            #[cfg(feature = "radiosity")]
            lightmap: LightmapPass::default(),
            #[cfg(feature = "radiosity")]
            gloss: OnceCell::new(),
            #[cfg(feature = "radiosity")]
            reflections: ReflectionsPass::default(),
            #[cfg(feature = "radiosity")]
            rig: OnceCell::new(),
            #[cfg(feature = "radiosity")]
            rest_places: RestPlacesPass::default(),
            overlay: RefCell::default(),
            material,
            shadow,
        };
        gpu.check()?;
        Ok(pipelines)
    }

    /// Layouts and pipelines for loading scenes.
    pub fn loaders(&self) -> Loaders<'_> {
        Loaders {
            material: &self.material,
            mips: &self.mips,
            relight: &self.relight,
            #[cfg(feature = "radiosity")]
            radiosity: &self.radiosity,
            #[cfg(feature = "radiosity")]
            lightmap: &self.lightmap.layout,
            #[cfg(feature = "radiosity")]
            gloss: &self.gloss,
            #[cfg(feature = "radiosity")]
            rig: &self.rig,
        }
    }

    /// Overlay pipelines for this target format; created on first use.
    pub fn overlay(&self, gpu: &Gpu, format: TextureFormat) -> Rc<OverlayPass> {
        let mut made = self.overlay.borrow_mut();
        if let Some(pass) = made.iter().find(|pass| pass.format() == format) {
            return pass.clone();
        }
        let pass = Rc::new(OverlayPass::new(gpu, format));
        made.push(pass.clone());
        pass
    }
}
