//! The renderer.

use crate::error::ViewerError;
use crate::gpu::Gpu;
use crate::readback::Readback;
use rebounce_shared::{camera::Camera, light::Light, rbn::Scene};

/// Which light the picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Direct and bounced light.
    #[default]
    All,
    /// Direct light alone.
    Direct,
    /// Bounced light alone.
    Indirect,
}

impl Mode {
    /// From its name: `all`, `direct` or `indirect`.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`].
    pub fn parse(name: &str) -> Result<Self, ViewerError> {
        [Self::All, Self::Direct, Self::Indirect].into_iter().find(|m| m.name() == name).ok_or_else(|| {
            ViewerError::BadArgument(format!("mode {name:?}: it must be \"all\", \"direct\" or \"indirect\""))
        })
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Direct => "direct",
            Self::Indirect => "indirect",
        }
    }
}

/// What is drawn over the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overlay {
    /// Nothing.
    #[default]
    None,
    /// The points of the finest level.
    Points,
    /// The points of all levels, each level in its colour.
    Levels,
}

impl Overlay {
    /// From its name: `none`, `points` or `levels`.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`].
    pub fn parse(name: &str) -> Result<Self, ViewerError> {
        [Self::None, Self::Points, Self::Levels].into_iter().find(|m| m.name() == name).ok_or_else(|| {
            ViewerError::BadArgument(format!(
                "overlay {name:?}: it must be \"none\", \"points\" or \"levels\""
            ))
        })
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Points => "points",
            Self::Levels => "levels",
        }
    }
}

/// A scene on the GPU.
pub struct LoadedScene {
    scene: Scene,
}

impl LoadedScene {
    /// Uploads.
    ///
    /// # Errors
    /// Those of [`ViewerError`].
    pub async fn upload(_gpu: &Gpu, scene: Scene) -> Result<Self, ViewerError> {
        Ok(Self { scene })
    }
}

/// Statistics.
#[derive(Debug, Default, serde::Serialize)]
pub struct Stats {
    /// Name of the graphics adapter.
    pub adapter: String,
}

/// The renderer.
pub struct Renderer {
    gpu: Gpu,
    scene: Option<LoadedScene>,
    camera: Camera,
    lights: Vec<Light>,
    exposure: f32,
    mode: Mode,
    overlay: Overlay,
    gizmos: bool,
    dirty: bool,
}

#[allow(missing_docs, clippy::missing_errors_doc)]
impl Renderer {
    pub fn new(gpu: Gpu) -> Result<Self, ViewerError> {
        let camera =
            Camera { position: [0.0, 0.0, 1.0], target: [0.0; 3], up: [0.0, 1.0, 0.0], yfov_deg: 60.0 };
        Ok(Self {
            gpu,
            scene: None,
            camera,
            lights: Vec::new(),
            exposure: 0.0,
            mode: Mode::All,
            overlay: Overlay::None,
            gizmos: true,
            dirty: true,
        })
    }
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }
    pub fn install(&mut self, loaded: LoadedScene) -> Result<(), ViewerError> {
        self.camera = loaded.scene.meta.cameras[0].clone();
        self.lights = loaded.scene.meta.lights.clone();
        self.scene = Some(loaded);
        self.dirty = true;
        Ok(())
    }
    pub fn invalidate(&mut self) {
        self.dirty = true;
    }
    pub fn needs_frame(&self) -> bool {
        self.dirty
    }
    pub fn rekey(&mut self) {}
    pub fn camera(&self) -> &Camera {
        &self.camera
    }
    pub fn set_camera(&mut self, camera: Camera) -> Result<(), ViewerError> {
        self.camera = camera;
        self.dirty = true;
        Ok(())
    }
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }
    pub fn set_lights(&mut self, lights: Vec<Light>) -> Result<(), ViewerError> {
        self.lights = lights;
        self.dirty = true;
        Ok(())
    }
    pub fn exposure(&self) -> f32 {
        self.exposure
    }
    pub fn set_exposure(&mut self, stops: f32) -> Result<(), ViewerError> {
        self.exposure = stops;
        self.dirty = true;
        Ok(())
    }
    pub fn mode(&self) -> Mode {
        self.mode
    }
    pub fn set_mode(&mut self, mode: Mode) {
        self.mode = mode;
        self.dirty = true;
    }
    pub fn overlay(&self) -> Overlay {
        self.overlay
    }
    pub fn set_overlay(&mut self, overlay: Overlay) {
        self.overlay = overlay;
        self.dirty = true;
    }
    pub fn gizmos(&self) -> bool {
        self.gizmos
    }
    pub fn set_gizmos(&mut self, on: bool) {
        self.gizmos = on;
        self.dirty = true;
    }
    pub fn stats(&self) -> Stats {
        Stats { adapter: self.gpu.adapter.clone() }
    }
    pub fn draw(
        &mut self,
        view: &wgpu::TextureView,
        _format: wgpu::TextureFormat,
        _width: u32,
        _height: u32,
    ) -> Result<(), ViewerError> {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r: 0.1, g: 0.2, b: 0.3, a: 1.0 }),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        }));
        self.gpu.queue.submit([encoder.finish()]);
        self.dirty = false;
        Ok(())
    }
    pub fn read_indirect(&mut self, _width: u32, _height: u32) -> Result<Readback, ViewerError> {
        Err(ViewerError::NoScene)
    }
    pub fn read_pixels(&mut self, _width: u32, _height: u32) -> Result<Readback, ViewerError> {
        Err(ViewerError::NoScene)
    }
}
