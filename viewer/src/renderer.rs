//! The renderer: keeps what was drawn, and draws again only what changed.

use crate::bindings::target as texture_target;
use crate::composite::{CompositePass, Shading};
use crate::controls::Stage;
use crate::controls::gizmo::{self, Handle};
use crate::error::ViewerError;
use crate::gbuffer::GBufferPass;
use crate::gpu::Gpu;
use crate::materials::material_layout;
use crate::overlay::OverlayPass;
use crate::readback::Readback;
use crate::relight::RelightPipelines;
use crate::scene::LoadedScene;
use crate::settings::{Mode, Overlay};
use crate::shadow::Shadows;
use crate::shadow_fit;
use crate::splat::SplatPass;
use crate::stats::{Bytes, Stats};
use crate::target::Target;
use crate::timing::{Milliseconds, Pass, Timing};
use crate::view::{Frame, jitter};
use rebounce_shared::{camera::Camera, light::Light};
use std::rc::Rc;
use std::sync::Arc;
use wgpu::TextureFormat;

/// Pictures averaged while nothing moves: smooth edges and translucent surfaces.
const STILL_PICTURES: u32 = 16;
/// Pixels that [`Renderer::read_indirect`] draws at most to average.
const MOST_PIXELS: u64 = 1 << 20;

/// What must be drawn again.
#[derive(Clone, Copy, Debug, Default)]
struct Dirty {
    lights: bool,
    view: bool,
    splats: bool,
    key: bool,
    shade: bool,
    /// Only what lies over the picture.
    present: bool,
}

impl Dirty {
    const ALL: Self = Self { lights: true, view: true, splats: true, key: true, shade: true, present: true };

    fn any(self) -> bool {
        self.lights || self.view || self.splats || self.key || self.shade || self.present
    }
}

/// Draws a baked scene under changing lights.
pub struct Renderer {
    gpu: Gpu,
    shadows: Shadows,
    relight: Arc<RelightPipelines>,
    gbuffer: GBufferPass,
    splat: SplatPass,
    composite: CompositePass,
    overlay_pass: Option<OverlayPass>,
    timing: Option<Timing>,
    scene: Option<Rc<LoadedScene>>,
    target: Option<Target>,
    camera: Camera,
    lights: Vec<Light>,
    exposure: f32,
    mode: Mode,
    overlay: Overlay,
    gizmos: bool,
    active: Option<Handle>,
    dirty: Dirty,
    /// Pictures averaged so far, and how many are wanted.
    pictures: u32,
    still_pictures: u32,
    splat_scale: f32,
    frames: u64,
    relights: u64,
}

impl Renderer {
    /// A renderer without a scene.
    ///
    /// # Errors
    /// [`ViewerError::Internal`] where the device refuses a pipeline at once.
    pub fn new(gpu: Gpu) -> Result<Self, ViewerError> {
        let material_layout = material_layout(&gpu);
        let shadows = Shadows::new(&gpu, &material_layout);
        let relight = Arc::new(RelightPipelines::new(&gpu, &shadows.layout));
        let gbuffer = GBufferPass::new(&gpu, &material_layout);
        let splat = SplatPass::new(&gpu);
        let composite = CompositePass::new(&gpu, &shadows.layout);
        let timing = Timing::new(&gpu);
        gpu.check()?;
        Ok(Self {
            gpu,
            shadows,
            relight,
            gbuffer,
            splat,
            composite,
            overlay_pass: None,
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
            mode: Mode::All,
            overlay: Overlay::None,
            gizmos: true,
            active: None,
            dirty: Dirty::ALL,
            pictures: 0,
            still_pictures: STILL_PICTURES,
            splat_scale: 1.0,
            frames: 0,
            relights: 0,
        })
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// What [`LoadedScene::upload`] needs.
    pub fn pipelines(&self) -> Arc<RelightPipelines> {
        self.relight.clone()
    }

    /// Shows another scene, from its first camera and with its own lights.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`] for a camera that cannot be used.
    pub fn install(&mut self, scene: LoadedScene) -> Result<(), ViewerError> {
        let camera = scene.meta.cameras.first().cloned().unwrap_or_else(|| self.camera.clone());
        // A file may hold more lights than there can be shadow maps for; the first ones are on.
        let mut lights = scene.meta.lights.clone();
        while check_lights(&lights).is_err() {
            lights.pop();
        }
        self.scene = Some(Rc::new(scene));
        self.target = None;
        self.shadows.forget();
        self.dirty = Dirty::ALL;
        self.set_camera(camera)?;
        self.set_lights(lights)
    }

    /// The scene's metadata.
    pub fn scene(&self) -> Option<&LoadedScene> {
        self.scene.as_deref()
    }

    /// Draws everything again on the next frame, as after a change of the canvas's size.
    pub fn invalidate(&mut self) {
        self.dirty.present = true;
    }

    /// Measures the automatic exposure again on the next frame.
    pub fn rekey(&mut self) {
        self.dirty.key = true;
    }

    /// True when [`Renderer::draw`] would draw something new.
    pub fn needs_frame(&self) -> bool {
        self.dirty.any() || self.refining()
    }

    /// True while nothing moves but the average is not complete.
    pub fn refining(&self) -> bool {
        self.scene.is_some() && !self.dirty.any() && self.pictures < self.still_pictures
    }

    /// Leaves the average as it is until something changes: for slow devices.
    pub fn stop_refining(&mut self) {
        self.pictures = self.pictures.max(self.still_pictures);
    }

    /// Averages so many pictures while nothing moves; 1 for none.
    pub fn set_still_pictures(&mut self, count: u32) {
        self.still_pictures = count.max(1);
    }

    /// Makes shadow maps at most so many texels wide; for measurements.
    pub fn set_largest_shadow_map(&mut self, texels: u32) {
        self.shadows.largest = texels.clamp(16, shadow_fit::LARGEST);
        self.dirty.lights = true;
    }

    /// The camera, world space.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Sets the camera.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`] unless all numbers are finite, position and target differ and the field
    /// of view is between 0 and 180 degrees.
    pub fn set_camera(&mut self, camera: Camera) -> Result<(), ViewerError> {
        let finite = |v: &[f64; 3]| v.iter().all(|x| x.is_finite());
        let good = finite(&camera.position)
            && finite(&camera.target)
            && finite(&camera.up)
            && camera.position != camera.target
            && camera.yfov_deg > 0.0
            && camera.yfov_deg < 180.0;
        if !good {
            return Err(ViewerError::BadArgument(
                "camera: position, target and up must be finite, position and target must differ, and yfov_deg \
                 must be between 0 and 180"
                    .into(),
            ));
        }
        self.dirty.view |= self.camera != camera;
        self.camera = camera;
        Ok(())
    }

    /// The lights, world space.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// Replaces the lights.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`] for numbers that are not finite, negative intensities, or more lights than
    /// there can be shadow maps for.
    pub fn set_lights(&mut self, lights: Vec<Light>) -> Result<(), ViewerError> {
        check_lights(&lights)?;
        self.dirty.lights |= self.lights != lights;
        self.lights = lights;
        Ok(())
    }

    /// Exposure in stops on top of the automatic one.
    pub fn exposure(&self) -> f32 {
        self.exposure
    }

    /// Sets the exposure.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`] unless it lies between -32 and 32.
    pub fn set_exposure(&mut self, stops: f32) -> Result<(), ViewerError> {
        if !(-32.0..=32.0).contains(&stops) {
            return Err(ViewerError::BadArgument(format!("exposure {stops}: it must be between -32 and 32")));
        }
        self.dirty.shade |= self.exposure != stops;
        self.exposure = stops;
        Ok(())
    }

    /// Which light is shown.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Sets which light is shown.
    pub fn set_mode(&mut self, mode: Mode) {
        self.dirty.shade |= self.mode != mode;
        self.mode = mode;
    }

    /// What is drawn over the picture.
    pub fn overlay(&self) -> Overlay {
        self.overlay
    }

    /// Sets what is drawn over the picture.
    pub fn set_overlay(&mut self, overlay: Overlay) {
        self.dirty.present |= self.overlay != overlay;
        self.overlay = overlay;
    }

    /// Whether the lights' handles are drawn.
    pub fn gizmos(&self) -> bool {
        self.gizmos
    }

    /// Shows or hides the lights' handles.
    pub fn set_gizmos(&mut self, on: bool) {
        self.dirty.present |= self.gizmos != on;
        self.gizmos = on;
    }

    /// Highlights a handle.
    pub fn set_active(&mut self, handle: Option<Handle>) {
        self.dirty.present |= self.active != handle;
        self.active = handle;
    }

    /// What the controls act on; give it back with [`Renderer::apply`].
    pub fn stage(&self) -> Stage {
        let (extent, centre) = self.scene.as_ref().map_or((1.0, [0.0; 3]), |scene| {
            let [low, high] = scene.bounds.map(|b| b.as_dvec3());
            let centre = 0.5 * (low + high) + glam::DVec3::from(scene.meta.origin);
            ((high - low).length(), centre.to_array())
        });
        Stage { camera: self.camera.clone(), lights: self.lights.clone(), extent, centre }
    }

    /// Takes over what the controls changed; what cannot be used is dropped.
    pub fn apply(&mut self, stage: Stage) {
        // Controls only ever make small steps from a valid state.
        let _ = self.set_camera(stage.camera);
        let _ = self.set_lights(stage.lights);
    }

    /// Counts, bytes and times.
    pub fn stats(&mut self) -> Stats {
        let milliseconds =
            self.timing.as_mut().map_or(Milliseconds::default(), |timing| timing.collect(&self.gpu));
        let scene = self.scene.as_deref();
        Stats {
            adapter: self.gpu.adapter.clone(),
            scene: scene.map_or(String::new(), |s| s.meta.scene_name.clone()),
            milliseconds,
            frames: self.frames,
            relights: self.relights,
            shadow_layers: self.shadows.drawn,
            shadow_size: self.shadows.size(),
            triangles: scene.map_or(0, |s| s.triangles),
            functions: scene.map_or(Vec::new(), |s| s.levels.iter().map(|l| l.len() as u32).collect()),
            links: scene.map_or(0, |s| s.link_count),
            lights: self.lights.len(),
            bytes: Bytes {
                scene: scene.map_or(0, |s| s.upload.bytes),
                textures: scene.map_or(0, |s| s.materials.bytes),
                relight: scene.map_or(0, |s| s.relight.bytes),
                shadows: self.shadows.bytes(),
                picture: self.target.as_ref().map_or(0, |t| t.bytes),
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
        let target = match self.target.take().filter(|t| t.size == [width, height]) {
            Some(target) => target,
            None => {
                self.dirty.view = true;
                self.new_target(&scene, [width, height])
            }
        };
        if let Some(timing) = &mut self.timing {
            timing.collect(&self.gpu);
        }
        self.update_lights(&mut encoder, &scene);
        self.update_picture(&mut encoder, &scene, &target);
        self.composite.present(&self.gpu, &mut encoder, &target.picture, view, format);
        self.draw_overlay(&mut encoder, &scene, &target, view, format);
        if let Some(timing) = &mut self.timing {
            timing.resolve(&mut encoder);
        }
        self.gpu.queue.submit([encoder.finish()]);
        if let Some(timing) = &mut self.timing {
            timing.submitted();
        }
        self.frames += 1;
        self.target = Some(target);
        self.dirty = Dirty::default();
        Ok(())
    }

    /// Begins to read the bounced light of the present camera and lights at this size: RGBA 32-bit
    /// floats, linear radiance albedo/π·E; each pixel is the mean over up to 4 x 4 places. Alpha is
    /// the share that a surface covers.
    ///
    /// # Errors
    /// [`ViewerError::NoScene`]; [`ViewerError::BadArgument`] for a size that the device cannot draw.
    pub fn read_indirect(&mut self, width: u32, height: u32) -> Result<Readback, ViewerError> {
        let scene = self.scene.clone().ok_or(ViewerError::NoScene)?;
        self.check_size(width, height)?;
        let limit = self.gpu.device.limits().max_texture_dimension_2d;
        let fits = |k: &u32| {
            width.max(height) * k <= limit && width as u64 * height as u64 * (k * k) as u64 <= MOST_PIXELS
        };
        let scale = [4, 3, 2].into_iter().find(fits).unwrap_or(1);
        let size = [width * scale, height * scale];
        let target = self.new_target(&scene, size);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.update_lights(&mut encoder, &scene);
        self.draw_view(&mut encoder, &scene, &target, 0, false);
        let shading = Shading { direct: 0.0, indirect: 1.0, scale, ..self.shading(1.0) };
        self.composite.set_shading(&self.gpu, &target.picture, &shading);
        let out = texture_target(&self.gpu, "indirect", TextureFormat::Rgba32Float, width, height);
        let view = out.create_view(&Default::default());
        self.composite.indirect(&mut encoder, &target.picture, &self.shadows.group, &view);
        self.gpu.queue.submit([encoder.finish()]);
        Ok(Readback::texture(&self.gpu, &out, 16))
    }

    /// Begins to read the tone-mapped picture at this size, without handles: RGBA bytes.
    ///
    /// # Errors
    /// As [`Renderer::read_indirect`].
    pub fn read_pixels(&mut self, width: u32, height: u32) -> Result<Readback, ViewerError> {
        let scene = self.scene.clone().ok_or(ViewerError::NoScene)?;
        self.check_size(width, height)?;
        let target = self.new_target(&scene, [width, height]);
        let format = TextureFormat::Rgba8Unorm;
        let out = texture_target(&self.gpu, "pixels", format, width, height);
        let view = out.create_view(&Default::default());
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.update_lights(&mut encoder, &scene);
        // One submission a picture: their uniforms differ.
        for picture in 0..self.still_pictures {
            self.draw_view(&mut encoder, &scene, &target, picture, false);
            if std::mem::take(&mut self.dirty.key) {
                self.measure_key(&mut encoder, &target);
            }
            self.shade(&mut encoder, &target, picture, false);
            self.gpu.queue.submit([encoder.finish()]);
            encoder = self.gpu.device.create_command_encoder(&Default::default());
        }
        self.composite.present(&self.gpu, &mut encoder, &target.picture, &view, format);
        self.gpu.queue.submit([encoder.finish()]);
        Ok(Readback::texture(&self.gpu, &out, 4))
    }

    fn check_size(&self, width: u32, height: u32) -> Result<(), ViewerError> {
        let limit = self.gpu.device.limits().max_texture_dimension_2d;
        if width == 0 || height == 0 || width > limit || height > limit {
            return Err(ViewerError::BadArgument(format!(
                "a picture of {width} x {height} pixels: both must be between 1 and {limit}"
            )));
        }
        Ok(())
    }

    fn new_target(&self, scene: &LoadedScene, size: [u32; 2]) -> Target {
        Target::new(&self.gpu, &self.gbuffer, &self.splat, &self.composite, scene, size)
    }

    /// Brings shadow maps and bounced light up to date with the lights.
    fn update_lights(&mut self, encoder: &mut wgpu::CommandEncoder, scene: &LoadedScene) {
        if !std::mem::take(&mut self.dirty.lights) {
            return;
        }
        self.dirty.splats = true;
        let sources: Vec<_> = self.lights.iter().map(|light| light.source(scene.meta.origin)).collect();
        let near = 0.1 * scene.near;
        let changed = self.shadows.set_lights(&self.gpu, &sources, scene.bounds, near);
        for (i, &layer) in changed.iter().enumerate() {
            let stamps = self.timing.as_mut().filter(|_| i == 0 || i + 1 == changed.len());
            let stamps = stamps.and_then(|t| t.stamps(Pass::Shadows));
            let stamps = stamps.map(|s| s.render(i == 0, i + 1 == changed.len()));
            self.shadows.draw(encoder, &scene.upload, &scene.materials.groups, layer, stamps);
        }
        if sources.iter().all(|light| light.intensity == glam::Vec3::ZERO) {
            scene.relight.clear(encoder);
            return;
        }
        let extent = (scene.bounds[1] - scene.bounds[0]).length();
        self.splat_scale = splat_scale(&sources, extent);
        self.splat.set_scale(&self.gpu, self.splat_scale);
        scene.relight.set_light_count(&self.gpu, sources.len() as u32);
        let stamps = self.timing.as_mut().and_then(|t| t.stamps(Pass::Relight)).map(|s| s.compute());
        scene.relight.encode(encoder, &self.relight, Some(&self.shadows.group), stamps);
        self.relights += 1;
    }

    /// Draws what changed of the interactive picture, or one more picture for its average.
    fn update_picture(&mut self, encoder: &mut wgpu::CommandEncoder, scene: &LoadedScene, target: &Target) {
        let moved = self.dirty.view || self.dirty.splats;
        if moved || self.dirty.shade || self.dirty.key {
            // After an average the G-buffer holds a shifted picture.
            if self.dirty.view || self.pictures > 1 {
                self.draw_view(encoder, scene, target, 0, true);
            } else if self.dirty.splats {
                self.draw_splats(encoder, scene, target, true);
            }
            if std::mem::take(&mut self.dirty.key) {
                self.measure_key(encoder, target);
            }
            self.shade(encoder, target, 0, true);
            self.pictures = 1;
        } else if !self.dirty.present && self.pictures < self.still_pictures {
            self.draw_view(encoder, scene, target, self.pictures, true);
            self.shade(encoder, target, self.pictures, true);
            self.pictures += 1;
        }
    }

    /// Measures the automatic exposure on what is drawn. Submits what `encoder` holds: the picture's
    /// own settings must come later.
    fn measure_key(&self, encoder: &mut wgpu::CommandEncoder, target: &Target) {
        let shading = Shading { direct: 1.0, indirect: 1.0, ..self.shading(1.0) };
        self.composite.set_shading(&self.gpu, &target.picture, &shading);
        self.composite.measure(encoder, &target.picture, &self.shadows.group);
        let fresh = self.gpu.device.create_command_encoder(&Default::default());
        self.gpu.queue.submit([std::mem::replace(encoder, fresh).finish()]);
    }

    /// G-buffer and splats of picture `sample` of a series.
    fn draw_view(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &LoadedScene,
        target: &Target,
        sample: u32,
        timed: bool,
    ) {
        let camera = self.camera.frame(scene.meta.origin);
        let frame = Frame::new(&camera, scene.near, target.size, jitter(sample), sample);
        self.gpu.queue.write_buffer(&target.frame, 0, bytemuck::bytes_of(&frame));
        let timing = self.timing.as_mut().filter(|_| timed);
        let stamps = timing.and_then(|t| t.stamps(Pass::GBuffer)).map(|s| s.render(true, true));
        self.gbuffer.draw(
            encoder,
            &target.gbuffer,
            &target.frame_group,
            &scene.upload,
            &scene.materials.groups,
            stamps,
        );
        self.draw_splats(encoder, scene, target, timed);
    }

    fn draw_splats(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &LoadedScene,
        target: &Target,
        timed: bool,
    ) {
        let timing = self.timing.as_mut().filter(|_| timed);
        let stamps = timing.and_then(|t| t.stamps(Pass::Splat));
        self.splat.draw(
            encoder,
            &target.splats,
            &target.gbuffer,
            &target.splat_groups,
            &scene.levels,
            stamps,
        );
    }

    fn shade(&mut self, encoder: &mut wgpu::CommandEncoder, target: &Target, picture: u32, timed: bool) {
        let shading = self.shading(1.0 / (picture + 1) as f32);
        self.composite.set_shading(&self.gpu, &target.picture, &shading);
        let timing = self.timing.as_mut().filter(|_| timed);
        let stamps = timing.and_then(|t| t.stamps(Pass::Composite)).map(|s| s.render(true, true));
        self.composite.shade(encoder, &target.picture, &self.shadows.group, stamps);
    }

    fn shading(&self, blend: f32) -> Shading {
        Shading {
            direct: (self.mode != Mode::Indirect) as u32 as f32,
            indirect: (self.mode != Mode::Direct) as u32 as f32,
            lights: self.lights.len() as u32,
            splat_scale: self.splat_scale,
            exposure: self.exposure.exp2(),
            blend,
            scale: 1,
            pad: 0,
        }
    }

    fn draw_overlay(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        scene: &LoadedScene,
        target: &Target,
        view: &wgpu::TextureView,
        format: TextureFormat,
    ) {
        if self.overlay == Overlay::None && !self.gizmos {
            return;
        }
        let stage = self.stage();
        let pass = match self.overlay_pass.take().filter(|pass| pass.format() == format) {
            Some(pass) => pass,
            None => OverlayPass::new(&self.gpu, format),
        };
        if self.overlay != Overlay::None {
            let levels: Vec<_> = scene.levels.iter().cloned().enumerate().collect();
            let first = if self.overlay == Overlay::Points { levels.len().saturating_sub(1) } else { 0 };
            let depth = &target.gbuffer.depth;
            let points = &scene.upload.points;
            pass.draw_points(&self.gpu, encoder, view, depth, &target.frame, points, &levels[first..]);
        }
        if self.gizmos {
            let shapes = gizmo::shapes(&stage, target.size, self.active);
            pass.draw_gizmos(&self.gpu, encoder, view, target.size, &shapes);
        }
        self.overlay_pass = Some(pass);
    }
}

/// The factor that brings bounced irradiance to about 1, whatever the lights' units.
fn splat_scale(lights: &[rebounce_shared::light::LightSource], extent: f32) -> f32 {
    let typical = lights.iter().map(|light| {
        let intensity = light.intensity.max_element();
        match light.kind {
            rebounce_shared::light::LightKind::Directional => intensity,
            _ => intensity / (0.25 * extent).powi(2).max(f32::MIN_POSITIVE),
        }
    });
    let typical: f32 = typical.fold(0.0, f32::max);
    // A power of two, so that only the exponent of sums changes.
    (-typical.clamp(1e-30, 1e30).log2().round()).exp2()
}

fn check_lights(lights: &[Light]) -> Result<(), ViewerError> {
    for (i, light) in lights.iter().enumerate() {
        let source = light.source([0.0; 3]);
        let finite = source.position.is_finite()
            && source.direction.is_finite()
            && source.intensity.is_finite()
            && source.cone_scale.is_finite()
            && source.cone_offset.is_finite();
        if !finite || source.intensity.min_element() < 0.0 {
            return Err(ViewerError::BadArgument(format!(
                "light {i}: all numbers must be finite, intensity and colour not negative"
            )));
        }
    }
    let layers: u32 = lights.iter().map(|light| shadow_fit::layers(&light.source([0.0; 3]))).sum();
    if layers > shadow_fit::MAX_LAYERS {
        return Err(ViewerError::BadArgument(format!(
            "{} lights need {layers} shadow maps, there can be {}: a point light needs six, others one",
            lights.len(),
            shadow_fit::MAX_LAYERS
        )));
    }
    Ok(())
}
