//! Settings of the renderer: camera, exposure, mode, overlay.

use super::Renderer;
use crate::controls::Stage;
use crate::controls::gizmo::Marks;
use crate::error::ViewerError;
use crate::gpu::readback::Readback;
use crate::passes::composite::FIRST_KEY;
use crate::passes::settings::{Display, Mode, Overlay, ToneMapping};
use rebounce_shared::camera::Camera;

impl Renderer {
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
        let moves = self.camera != camera;
        self.dirty.view |= moves;
        self.dirty.key |= moves;
        self.camera = camera;
        Ok(())
    }

    /// Exposure in stops on top of the automatic one.
    pub fn exposure(&self) -> f32 {
        self.exposure
    }

    /// Sets the exposure.
    ///
    /// # Errors
    /// [`ViewerError::BadArgument`] outside of -32 to 32.
    pub fn set_exposure(&mut self, stops: f32) -> Result<(), ViewerError> {
        if !(-32.0..=32.0).contains(&stops) {
            return Err(ViewerError::BadArgument("exposure: it must be between -32 and 32 stops".into()));
        }
        self.dirty.shade |= self.exposure != stops;
        self.exposure = stops;
        Ok(())
    }

    /// Whether the exposure is measured and follows the picture (key.wgsl); if not, radiance 1 is white at 0 stops.
    pub fn auto_exposure(&self) -> bool {
        self.auto_exposure
    }

    /// Turns the measured exposure on or off.
    pub fn set_auto_exposure(&mut self, on: bool) {
        let turns = self.auto_exposure != on;
        self.dirty.shade |= turns;
        self.dirty.key |= turns;
        self.auto_exposure = on;
    }

    /// Measures the scene's initial exposure again on the next frame.
    pub fn rekey(&mut self) {
        self.begin_with_key(0.0);
    }

    /// Sets the factor on radiance of the first picture of the scene, replacing a measurement on the next frame.
    /// Values not above 0 are ignored.
    pub fn set_key(&mut self, key: f32) {
        if key > 0.0 {
            self.begin_with_key(key);
        }
    }

    fn begin_with_key(&mut self, key: f32) {
        self.gpu.queue.write_buffer(&self.key.0, FIRST_KEY, bytemuck::bytes_of(&key));
        self.dirty.key = true;
    }

    /// Sets whether [`Self::take_measured`] returns the scene's initial exposure after every measurement. Needed
    /// until the exposure is known, as a scene may begin in the dark.
    pub fn want_key(&mut self, wanted: bool) {
        self.key_wanted = wanted;
    }

    /// Readback of the buffer [`crate::passes::composite::key`].
    pub fn take_measured(&mut self) -> Option<Readback> {
        self.measured.take()
    }

    /// The tone mapping from radiance to display values.
    pub fn tone_mapping(&self) -> ToneMapping {
        self.tone_mapping
    }

    /// Sets the tone mapping.
    pub fn set_tone_mapping(&mut self, tone_mapping: ToneMapping) {
        self.dirty.shade |= self.tone_mapping != tone_mapping;
        self.tone_mapping = tone_mapping;
    }

    /// The displayed part of the light.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// Sets the displayed part of the light.
    pub fn set_mode(&mut self, mode: Mode) {
        self.dirty.shade |= self.mode != mode;
        self.mode = mode;
    }

    /// The overlay.
    pub fn overlay(&self) -> Overlay {
        self.overlay
    }

    /// Sets the overlay.
    pub fn set_overlay(&mut self, overlay: Overlay) {
        self.dirty.present |= self.overlay != overlay;
        self.overlay = overlay;
    }

    /// The display method from functions to pixels.
    pub fn display(&self) -> Display {
        self.choice.wanted()
    }

    /// Sets the display method.
    pub fn set_display(&mut self, display: Display) {
        self.dirty.view |= self.choice.set(display);
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

    /// Whether lights have handles: those of a fixed solution stay in place.
    pub(super) fn has_handles(&self) -> bool {
        self.gizmos && self.scene.as_ref().is_none_or(|scene| !scene.relight.is_solved())
    }

    /// Turns detail on or off: modulation of bounced light by the openness of pixels.
    pub fn set_detail(&mut self, on: bool) {
        self.dirty.view |= self.detail != on;
        self.detail = on;
    }

    /// Whether a backdrop is drawn behind an object; otherwise the background is black.
    pub fn backdrop(&self) -> bool {
        self.backdrop
    }

    /// Turns an object's backdrop on or off.
    pub fn set_backdrop(&mut self, on: bool) {
        self.dirty.shade |= self.backdrop != on;
        self.backdrop = on;
    }

    /// Turns edge smoothing of pictures without averaging (for example moving pictures) on or off. Initially on,
    /// except on software adapters, where the cost exceeds the benefit.
    pub fn set_antialias(&mut self, on: bool) {
        self.dirty.shade |= self.antialias != on;
        self.antialias = on;
    }

    /// Highlights handles.
    pub fn set_marks(&mut self, marks: Marks) {
        self.dirty.present |= self.marks != marks;
        self.marks = marks;
    }

    /// Scene state for the controls, for a picture of this size; [`Renderer::apply`] writes changes back.
    pub fn stage(&self, size: [u32; 2]) -> Stage {
        let (camera, lights, handles) = (self.camera.clone(), self.lights().to_vec(), self.has_handles());
        let scene = self.scene.as_deref();
        let extent = scene.map_or(1.0, |scene| (scene.extent.all[1] - scene.extent.all[0]).length());
        // A person's clearance in metres, or a share of the extent in scenes of another unit; greater than the near
        // plane.
        let near = scene.map_or(0.0, |scene| scene.near);
        Stage {
            camera,
            lights,
            #[cfg(feature = "radiosity")]
            nodes: self.stage_nodes(),
            handles,
            size,
            extent: extent as f64,
            origin: scene.map_or([0.0; 3], |scene| scene.meta.origin),
            clearance: 0.2f32.min(0.02 * extent).max(4.0 * near),
            triangles: scene.map_or(Default::default(), |scene| scene.upload.triangles.clone()),
        }
    }

    /// Applies the changes of the controls; invalid values are dropped.
    pub fn apply(&mut self, stage: Stage) {
        // Controls only ever make small steps from a valid state.
        let _ = self.set_camera(stage.camera);
        let _ = self.set_lights(stage.lights);
        #[cfg(feature = "radiosity")]
        self.apply_nodes(&stage.nodes);
    }
}
