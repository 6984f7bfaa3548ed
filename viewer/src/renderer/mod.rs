//! The renderer: keeps the results of passes, and runs only the passes whose inputs changed.
//!
//! * here: the renderer itself, its scene, a whole frame;
//! * `state` – settings: camera, exposure, mode, overlay;
//! * `lighting` – lights, environment;
//! * `frame` – the passes;
//! * `gloss` – reflections of glossy surfaces;
//! * `moving` – nodes that move;
//! * `read` – pictures read back;
//! * `pipelines` – the pipelines of all passes, once a device;
//! * `target` – everything of one picture size;
//! * `stats` – counts, bytes and times;
//! * `pace` – one frame at a time.

mod frame;
#[cfg(feature = "radiosity")]
mod gloss;
mod lighting;
#[cfg(feature = "radiosity")]
mod moving;
pub mod pace;
pub mod pipelines;
#[cfg(feature = "radiosity")]
mod posing;
mod read;
mod state;
pub mod stats;
pub mod target;

use crate::controls::gizmo::Marks;
use crate::error::ViewerError;
use crate::gpu::readback::Readback;
use crate::gpu::scope::Scope;
use crate::gpu::{Gpu, LIMITS, MAX_BINDING};
use crate::passes::cached_direct::CachedDirectLight;
use crate::passes::composite;
use crate::passes::display::choice::DisplayChoice;
#[cfg(feature = "radiosity")]
use crate::passes::settings::SolverChoice;
use crate::passes::settings::{Mode, Overlay, ToneMapping, Way};
use crate::passes::shadow::Shadows;
use crate::passes::shadow::fit::LARGEST;
use crate::passes::timing::{Milliseconds, Timing};
use crate::scene::GpuScene;
use crate::scene::relight::Parts;
use lighting::Lit;
use pipelines::Pipelines;
use rebounce_shared::camera::Camera;
use stats::{Bytes, Stats};
use std::rc::Rc;
use target::{Target, Wanted};
use wgpu::TextureFormat;

/// Number of pictures averaged for antialiasing while nothing changes.
const STILL_PICTURES: u32 = 16;
/// Screen pixels across one pixel of a sketch.
const SKETCH: u32 = 2;
/// Screen pixels across one pixel of the first picture of a scene, for a short delay.
const FIRST_SKETCH: u32 = 4;

/// Parts of the frame to draw again.
#[derive(Clone, Copy, Debug, Default)]
struct Dirty {
    lights: bool,
    view: bool,
    display: bool,
    key: bool,
    shade: bool,
    /// Only the presentation to the screen, with the overlay.
    present: bool,
}

impl Dirty {
    const ALL: Self = Self { lights: true, view: true, display: true, key: true, shade: true, present: true };

    fn any(self) -> bool {
        self.lights || self.view || self.display || self.key || self.shade || self.present
    }
}

/// Draws a baked scene under changing lights.
pub struct Renderer {
    gpu: Gpu,
    pipelines: Rc<Pipelines>,
    shadows: Shadows,
    /// Buffer of the automatic exposure, and the scope that owns the buffer.
    key: (wgpu::Buffer, Scope),
    measured: Option<Readback>,
    /// A caller waits for the exposure at the start of the scene.
    key_wanted: bool,
    /// Scope with the resources of the last overlay.
    over: Option<Scope>,
    timing: Option<Timing>,
    scene: Option<Rc<GpuScene>>,
    target: Option<Target>,
    camera: Camera,
    lit: Lit,
    /// Parts of the light that the scene's points hold for display.
    parts: Parts,
    exposure: f32,
    auto_exposure: bool,
    tone_mapping: ToneMapping,
    mode: Mode,
    overlay: Overlay,
    gizmos: bool,
    backdrop: bool,
    /// Metals are GGX conductors of constant reflectance, and nothing else shines.
    #[cfg(feature = "radiosity")]
    conductors: bool,
    detail: bool,
    every_pixel: bool,
    antialias: bool,
    choice: DisplayChoice,
    /// Way of filling the slots of the last picture.
    way: Way,
    /// The current frame has a picture of a new view, whose time counts for the choice.
    viewed: bool,
    marks: Marks,
    dirty: Dirty,
    /// Number of pictures averaged so far, and the number wanted.
    pictures: u32,
    still_pictures: u32,
    /// Draws sketches while the view changes.
    sketching: bool,
    /// No picture of the scene has been shown yet.
    first: bool,
    frames: u64,
    relights: u64,
    lights_evaluated: u64,
    blended_layers: u64,
    still: CachedDirectLight,
    #[cfg(feature = "radiosity")]
    slice: moving::Slice,
    #[cfg(feature = "radiosity")]
    solver: SolverChoice,
}

impl Renderer {
    /// Creates a renderer without a scene, with its own pipelines.
    ///
    /// # Errors
    /// [`ViewerError::Internal`] if the device refuses a pipeline immediately.
    pub fn new(gpu: Gpu) -> Result<Self, ViewerError> {
        let pipelines = Rc::new(Pipelines::new(&gpu)?);
        Ok(Self::with(gpu, pipelines))
    }

    /// Creates a renderer without a scene that shares `pipelines`, which must be of the same device.
    pub fn with(gpu: Gpu, pipelines: Rc<Pipelines>) -> Self {
        let shadows = Shadows::new(&gpu, &pipelines.shadow);
        let own = Scope::new(&gpu);
        let timing = Timing::new(&gpu);
        Self {
            choice: DisplayChoice::new(gpu.software),
            antialias: !gpu.software,
            gpu,
            pipelines,
            shadows,
            key: (composite::key(&own), own),
            measured: None,
            key_wanted: false,
            over: None,
            timing,
            scene: None,
            target: None,
            camera: Camera {
                position: [0.0, 0.0, 1.0],
                target: [0.0; 3],
                up: [0.0, 1.0, 0.0],
                yfov_deg: 60.0,
            },
            lit: Lit::default(),
            parts: Parts::ALL,
            exposure: 0.0,
            auto_exposure: true,
            tone_mapping: ToneMapping::default(),
            mode: Mode::All,
            overlay: Overlay::None,
            gizmos: true,
            backdrop: true,
            #[cfg(feature = "radiosity")]
            conductors: false,
            detail: true,
            every_pixel: false,
            way: Way::default(),
            viewed: false,
            marks: Marks::default(),
            dirty: Dirty::ALL,
            pictures: 0,
            still_pictures: STILL_PICTURES,
            sketching: false,
            first: true,
            frames: 0,
            relights: 0,
            lights_evaluated: 0,
            blended_layers: 0,
            still: CachedDirectLight::default(),
            #[cfg(feature = "radiosity")]
            slice: moving::Slice::default(),
            #[cfg(feature = "radiosity")]
            solver: SolverChoice::default(),
        }
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// The pipelines, with the [loaders](Pipelines::loaders).
    pub fn pipelines(&self) -> Rc<Pipelines> {
        self.pipelines.clone()
    }

    /// Replaces the scene; starts with the first camera and the lights of the file.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`] for an invalid camera; the renderer is unchanged then.
    pub fn install(&mut self, scene: GpuScene) -> Result<(), ViewerError> {
        if let Some(camera) = scene.meta.cameras.first() {
            self.set_camera(camera.clone())?;
        }
        self.scene = Some(Rc::new(scene));
        self.target = None;
        self.first = true;
        self.shadows.forget();
        self.still = CachedDirectLight::default();
        self.dirty = Dirty::ALL;
        self.parts = Parts::ALL;
        #[cfg(feature = "radiosity")]
        self.follow_solver();
        self.rekey();
        self.light_scene();
        Ok(())
    }

    /// The scene's metadata.
    pub fn scene(&self) -> Option<&Rc<GpuScene>> {
        self.scene.as_ref()
    }

    /// Draws the picture to the screen again on the next frame, as after a change of the canvas's size.
    pub fn invalidate(&mut self) {
        self.dirty.present = true;
    }

    /// True if [`Renderer::draw`] would change the picture.
    pub fn needs_frame(&self) -> bool {
        #[cfg(feature = "radiosity")]
        if self.is_solving() {
            return true;
        }
        self.dirty.any() || self.sketched() || self.refining()
    }

    /// True if the last picture is a sketch, to be replaced by the next picture.
    fn sketched(&self) -> bool {
        self.target.as_ref().is_some_and(|target| target.enlarge > 1)
    }

    /// True if the next picture is from a new view, at full resolution.
    pub fn draws_view(&self) -> bool {
        let moves = self.dirty.view || self.target.is_none();
        if self.sketching { self.sketched() && !moves } else { moves }
    }

    /// Draws at a fraction of the width and height while the view changes, and at full resolution once the view
    /// rests: for slow devices.
    pub fn set_sketching(&mut self, on: bool) {
        self.sketching = on;
    }

    /// True while nothing moves but the average is not complete.
    pub fn refining(&self) -> bool {
        let complete = self.pictures >= self.still_pictures;
        self.scene.is_some() && !self.dirty.any() && !self.sketched() && !complete
    }

    /// Stops averaging until the next change: for slow devices.
    pub fn stop_refining(&mut self) {
        self.pictures = self.pictures.max(self.still_pictures);
    }

    /// Sets the number of pictures averaged while nothing changes; 1 for no averaging.
    pub fn set_still_pictures(&mut self, count: u32) {
        self.still_pictures = count.max(1);
    }

    /// Gives every pixel a slot of its own for bounced light, without interpolation on continuous surfaces; for
    /// measurements.
    pub fn set_every_pixel(&mut self, on: bool) {
        self.every_pixel = on;
        self.target = None;
        self.dirty.view = true;
    }

    /// Limits the width of shadow maps, texels; for measurements.
    pub fn set_largest_shadow_map(&mut self, texels: u32) {
        self.shadows.largest = texels.clamp(16, LARGEST);
        self.dirty.lights = true;
    }

    /// Way of filling the slots of the last picture: `lookup` or `splat`.
    pub fn displayed(&self) -> &'static str {
        self.way.name()
    }

    /// Counts, bytes and times.
    pub fn stats(&mut self) -> Stats {
        let milliseconds = self.collect_times();
        let scene = self.scene.as_deref();
        Stats {
            adapter: self.gpu.adapter.clone(),
            scene: scene.map_or(String::new(), |s| s.meta.scene_name.clone()),
            display: self.displayed(),
            milliseconds,
            frames: self.frames,
            relights: self.relights,
            lights_evaluated: self.lights_evaluated,
            shadow_layers: self.shadows.drawn,
            shadow_size: self.shadows.size(),
            blended_layers: self.blended_layers,
            triangles: scene.map_or(0, |s| s.triangles),
            functions: scene.map_or(Vec::new(), |s| s.levels.iter().map(|l| l.len() as u32).collect()),
            links: scene.map_or(0, |s| s.link_count),
            lights: self.lights().len(),
            bytes: Bytes {
                scene: scene.map_or(0, |s| s.upload.bytes()),
                textures: scene.map_or(0, |s| s.materials.bytes())
                    + self.lit.sky.as_ref().map_or(0, |sky| sky.bytes()),
                relight: scene.map_or(0, GpuScene::light_bytes),
                shadows: self.shadows.bytes(),
                picture: self.target.as_ref().map_or(0, |t| t.bytes()),
            },
            #[cfg(feature = "antiradiance")]
            antiradiance: self.antiradiance_counts(),
        }
    }

    /// Draws to a target of this format and size, with handles and overlay.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`] for a size that the device cannot draw.
    pub fn draw(
        &mut self,
        view: &wgpu::TextureView,
        format: TextureFormat,
        width: u32,
        height: u32,
    ) -> Result<(), ViewerError> {
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let Some(scene) = self.scene.clone() else {
            drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[crate::gpu::bindings::attachment(view, true)],
                ..Default::default()
            }));
            self.gpu.queue.submit([encoder.finish()]);
            self.dirty = Dirty::default();
            return Ok(());
        };
        self.check_size(width, height)?;
        let full = [width, height];
        let sized = |enlarge: u32| full.map(|side| side.div_ceil(enlarge));
        let before = self.target.take().filter(|t| t.size == sized(t.enlarge));
        let sketches = self.sketching && (self.dirty.view || before.is_none());
        let enlarge = match (sketches, std::mem::take(&mut self.first)) {
            (true, true) => FIRST_SKETCH,
            (true, false) => SKETCH,
            (false, _) => 1,
        };
        let mut target = match before.filter(|t| t.enlarge == enlarge) {
            Some(target) => target,
            None => {
                self.dirty.view = true;
                self.new_target(&scene, sized(enlarge), enlarge)
            }
        };
        self.collect_times();
        self.viewed = false;
        #[cfg(feature = "antiradiance")]
        self.prepare_antiradiance(&scene, moving::PIECE);
        self.update_lights(&mut encoder, &scene, Some(full), self.mode);
        #[cfg(feature = "radiosity")]
        self.solve(&mut encoder, &scene);
        self.update_picture(&mut encoder, &scene, &mut target);
        self.pipelines.composite.present(&self.gpu, &mut encoder, &target.picture.present, view, format);
        self.draw_overlay(&mut encoder, &scene, &target, view, format, full);
        if let Some(timing) = &mut self.timing {
            timing.resolve(&mut encoder);
        }
        self.gpu.queue.submit([encoder.finish()]);
        if let Some(timing) = &mut self.timing {
            timing.submitted(self.viewed.then_some(self.way));
        }
        self.frames += 1;
        self.target = Some(target);
        self.dirty = Dirty::default();
        Ok(())
    }

    /// Updates the bounced light at the points after changes of the lights, without a picture. Returns whether it changed
    /// since the last call.
    #[cfg(feature = "guest")]
    pub fn relight(&mut self) -> bool {
        let Some(scene) = self.scene.clone() else { return false };
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.update_lights(&mut encoder, &scene, None, Mode::All);
        self.gpu.queue.submit([encoder.finish()]);
        std::mem::take(&mut self.dirty.display)
    }

    /// Collects the latest GPU times, and passes the time of the display way to the choice.
    fn collect_times(&mut self) -> Milliseconds {
        let Some(timing) = &mut self.timing else { return Milliseconds::default() };
        let milliseconds = timing.collect(&self.gpu);
        if let Some((way, time)) = timing.take_displayed() {
            self.choice.add(way, time);
        }
        milliseconds
    }

    /// Returns the way of filling slots if the last frame filled the slots anew and the device cannot time passes:
    /// the caller then passes the frame's time to [`Self::add_time`].
    pub fn untimed(&self) -> Option<Way> {
        (self.viewed && self.timing.is_none()).then_some(self.way)
    }

    /// Adds the milliseconds of a frame drawn in this way: see [`Self::untimed`].
    pub fn add_time(&mut self, way: Way, milliseconds: f64) {
        self.choice.add(way, milliseconds);
    }

    fn check_size(&self, width: u32, height: u32) -> Result<(), ViewerError> {
        let limit = LIMITS.max_texture_dimension_2d;
        // A 32-bit value for every pixel must fit one binding.
        let most = MAX_BINDING / 4;
        let sides = 1..=limit;
        if !sides.contains(&width) || !sides.contains(&height) || width as u64 * height as u64 > most {
            return Err(ViewerError::BadArgument(format!(
                "a picture of {width} x {height} pixels: both must be between 1 and {limit}, and their product at most {most}"
            )));
        }
        Ok(())
    }

    fn new_target(&self, scene: &GpuScene, size: [u32; 2], enlarge: u32) -> Target {
        let (every_pixel, way) = (self.every_pixel, self.choice.way());
        let sky = self.lit.sky.as_ref();
        let wanted = Wanted { scene, key: &self.key.0, sky, size, enlarge, every_pixel, way };
        Target::new(&self.gpu, &self.pipelines, &wanted)
    }
}
