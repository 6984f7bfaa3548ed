//! The renderer: keeps what was drawn, and draws again only what changed.
//!
//! * here: the renderer itself, its scene, a whole frame;
//! * `state` – what it is told: camera, lights, exposure, what to show;
//! * `frame` – the passes;
//! * `read` – pictures read back.

mod frame;
mod read;
mod state;

use crate::composite;
use crate::controls::gizmo::Marks;
use crate::display::choice::Choice;
use crate::error::ViewerError;
use crate::gpu::MAX_BINDING;
use crate::gpu::{Gpu, LIMITS};
use crate::pipelines::Pipelines;
use crate::readback::Readback;
use crate::scene::GpuScene;
use crate::scope::Scope;
use crate::settings::Way;
use crate::settings::{Mode, Overlay, ToneMapping};
use crate::shadow::Shadows;
use crate::shadow_fit;
use crate::stats::{Bytes, Stats};
use crate::still::StillLights;
use crate::target::{Target, Wanted};
use crate::timing::{Milliseconds, Timing};
use rebounce_shared::{camera::Camera, light::Light};
use state::check_lights;
use std::rc::Rc;
use wgpu::TextureFormat;

/// Pictures averaged while nothing moves: smooth edges.
const STILL_PICTURES: u32 = 16;
/// Pixels of the screen across one of a sketch.
const SKETCH: u32 = 2;
/// The same of the first picture of a scene, which is there soonest.
const FIRST_SKETCH: u32 = 4;

/// What must be drawn again.
#[derive(Clone, Copy, Debug, Default)]
struct Dirty {
    lights: bool,
    view: bool,
    display: bool,
    key: bool,
    shade: bool,
    /// Only what lies over the picture.
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
    /// The automatic exposure, and who owns it.
    key: (wgpu::Buffer, Scope),
    measured: Option<Readback>,
    /// Somebody waits for the exposure that the scene begins with.
    key_wanted: bool,
    /// Owns what the last overlay was drawn with.
    over: Option<Scope>,
    timing: Option<Timing>,
    scene: Option<Rc<GpuScene>>,
    target: Option<Target>,
    camera: Camera,
    lights: Vec<Light>,
    exposure: f32,
    auto_exposure: bool,
    tone_mapping: ToneMapping,
    mode: Mode,
    overlay: Overlay,
    gizmos: bool,
    backdrop: bool,
    detail: bool,
    every_pixel: bool,
    antialias: bool,
    choice: Choice,
    /// How the last picture's slots were filled.
    way: Way,
    /// The frame that is being drawn has a picture of a view, whose time counts for the choice.
    viewed: bool,
    marks: Marks,
    dirty: Dirty,
    /// Pictures averaged so far, and how many are wanted.
    pictures: u32,
    still_pictures: u32,
    /// Draws sketches while the view changes.
    sketching: bool,
    /// Nothing of the scene has been shown.
    first: bool,
    frames: u64,
    relights: u64,
    lights_evaluated: u64,
    blended_layers: u64,
    still: StillLights,
}

impl Renderer {
    /// A renderer without a scene, with pipelines of its own.
    ///
    /// # Errors
    /// [`ViewerError::Internal`] where the device refuses a pipeline at once.
    pub fn new(gpu: Gpu) -> Result<Self, ViewerError> {
        let pipelines = Rc::new(Pipelines::new(&gpu)?);
        Ok(Self::with(gpu, pipelines))
    }

    /// A renderer without a scene that shares pipelines, which must be of the same device.
    pub fn with(gpu: Gpu, pipelines: Rc<Pipelines>) -> Self {
        let shadows = Shadows::new(&gpu, &pipelines.shadow);
        let own = Scope::new(&gpu);
        let timing = Timing::new(&gpu);
        Self {
            choice: Choice::new(gpu.software),
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
            lights: Vec::new(),
            exposure: 0.0,
            auto_exposure: true,
            tone_mapping: ToneMapping::default(),
            mode: Mode::All,
            overlay: Overlay::None,
            gizmos: true,
            backdrop: true,
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
            still: StillLights::default(),
        }
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Which the [loaders](Pipelines::loaders) are part of.
    pub fn pipelines(&self) -> Rc<Pipelines> {
        self.pipelines.clone()
    }

    /// Shows another scene, from its first camera and with its own lights.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`] for a camera that cannot be used; then all stays as it was.
    pub fn install(&mut self, scene: GpuScene) -> Result<(), ViewerError> {
        if let Some(camera) = scene.meta.cameras.first() {
            self.set_camera(camera.clone())?;
        }
        // A file may hold more lights than there can be shadow maps for; the first ones are on.
        let mut lights = scene.meta.lights.clone();
        lights.truncate(shadow_fit::MAX_LAYERS as usize);
        while check_lights(&lights).is_err() {
            lights.pop();
        }
        self.scene = Some(Rc::new(scene));
        self.target = None;
        self.first = true;
        self.shadows.forget();
        self.still = StillLights::default();
        self.dirty = Dirty::ALL;
        self.rekey();
        self.set_lights(lights)
    }

    /// The scene's metadata.
    pub fn scene(&self) -> Option<&GpuScene> {
        self.scene.as_deref()
    }

    /// Draws everything again on the next frame, as after a change of the canvas's size.
    pub fn invalidate(&mut self) {
        self.dirty.present = true;
    }

    /// True when [`Renderer::draw`] would draw something new.
    pub fn needs_frame(&self) -> bool {
        self.dirty.any() || self.sketched() || self.refining()
    }

    /// True where the last picture is a sketch, which the next one replaces.
    fn sketched(&self) -> bool {
        self.target.as_ref().is_some_and(|target| target.enlarge > 1)
    }

    /// True where the next picture is a whole one from a new view.
    pub fn draws_view(&self) -> bool {
        let moves = self.dirty.view || self.target.is_none();
        if self.sketching { self.sketched() && !moves } else { moves }
    }

    /// Draws with half the width and height whenever the view has changed, and in full when it stands still: for slow
    /// devices.
    pub fn set_sketching(&mut self, on: bool) {
        self.sketching = on;
    }

    /// True while nothing moves but the average is not complete.
    pub fn refining(&self) -> bool {
        let complete = self.pictures >= self.still_pictures;
        self.scene.is_some() && !self.dirty.any() && !self.sketched() && !complete
    }

    /// Leaves the average as it is until something changes: for slow devices.
    pub fn stop_refining(&mut self) {
        self.pictures = self.pictures.max(self.still_pictures);
    }

    /// Averages so many pictures while nothing moves; 1 for none.
    pub fn set_still_pictures(&mut self, count: u32) {
        self.still_pictures = count.max(1);
    }

    /// Gives every pixel bounced light of its own instead of interpolating it where a surface goes on; for
    /// measurements.
    pub fn set_every_pixel(&mut self, on: bool) {
        self.every_pixel = on;
        self.target = None;
        self.dirty.view = true;
    }

    /// Makes shadow maps at most so many texels wide; for measurements.
    pub fn set_largest_shadow_map(&mut self, texels: u32) {
        self.shadows.largest = texels.clamp(16, shadow_fit::LARGEST);
        self.dirty.lights = true;
    }

    /// How the last picture's light got from functions to pixels: `lookup` or `splat`.
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
            lights: self.lights.len(),
            bytes: Bytes {
                scene: scene.map_or(0, |s| s.upload.bytes()),
                textures: scene.map_or(0, |s| s.materials.bytes()),
                relight: scene.map_or(0, |s| s.relight.bytes()),
                shadows: self.shadows.bytes(),
                picture: self.target.as_ref().map_or(0, |t| t.bytes()),
            },
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
                color_attachments: &[crate::bindings::attachment(view, true)],
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
        self.update_lights(&mut encoder, &scene, Some(full));
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

    /// What the GPU took lately, of which the choice hears, too.
    fn collect_times(&mut self) -> Milliseconds {
        let Some(timing) = &mut self.timing else { return Milliseconds::default() };
        let milliseconds = timing.collect(&self.gpu);
        if let Some((way, time)) = timing.take_displayed() {
            self.choice.add(way, time);
        }
        milliseconds
    }

    /// How the frame that was just drawn filled the slots, if that is new and no pass was timed: then give its time to
    /// [`Self::add_time`].
    pub fn untimed(&self) -> Option<Way> {
        (self.viewed && self.timing.is_none()).then_some(self.way)
    }

    /// Milliseconds of a frame that was drawn in this way: see [`Self::untimed`].
    pub fn add_time(&mut self, way: Way, milliseconds: f64) {
        self.choice.add(way, milliseconds);
    }

    fn check_size(&self, width: u32, height: u32) -> Result<(), ViewerError> {
        let limit = LIMITS.max_texture_dimension_2d;
        if width == 0 || height == 0 || width > limit || height > limit {
            return Err(ViewerError::BadArgument(format!(
                "a picture of {width} x {height} pixels: both must be between 1 and {limit}"
            )));
        }
        // A number a pixel must fit one binding.
        let most = MAX_BINDING / 4;
        if width as u64 * height as u64 > most {
            return Err(ViewerError::BadArgument(format!(
                "a picture of {width} x {height} pixels: at most {most} together"
            )));
        }
        Ok(())
    }

    fn new_target(&self, scene: &GpuScene, size: [u32; 2], enlarge: u32) -> Target {
        let (every_pixel, way) = (self.every_pixel, self.choice.way());
        let wanted = Wanted { scene, key: &self.key.0, size, enlarge, every_pixel, way };
        Target::new(&self.gpu, &self.pipelines, &wanted)
    }
}
