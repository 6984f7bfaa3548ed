//! Animations of what deforms.

use super::Renderer;
use crate::error::ViewerError;
use crate::scene::rig::GpuRig;
use rebounce_shared::rig::RigAnimation;

impl Renderer {
    fn rig(&self) -> Option<&GpuRig> {
        self.scene.as_ref()?.rig.as_ref()
    }

    /// Animations of the scene's rig; empty without one.
    pub fn rig_animations(&self) -> &[RigAnimation] {
        self.rig().map_or(&[], GpuRig::animations)
    }

    /// Animation of the rig that it is posed by, and its time in seconds; `None` at rest.
    pub fn posed(&self) -> Option<(usize, f64)> {
        self.rig().and_then(GpuRig::moment)
    }

    /// Poses what deforms as an animation of the rig has it at a time, seconds; `None` for the pose at rest.
    ///
    /// # Errors
    /// [`ViewerError::NoScene`]; [`ViewerError::BadArgument`] for an animation that the rig has not, or a time that is not finite.
    pub fn pose(&mut self, animation: Option<usize>, time: f64) -> Result<(), ViewerError> {
        let scene = self.scene.clone().ok_or(ViewerError::NoScene)?;
        let count = self.rig_animations().len();
        if animation.is_some_and(|number| number >= count) || !time.is_finite() {
            return Err(ViewerError::BadArgument(format!(
                "a pose is that of an animation of the file's rig, which has {count}, at a finite time"
            )));
        }
        if scene.rig.as_ref().is_some_and(|rig| rig.pose(animation, time)) {
            #[cfg(feature = "antiradiance")]
            if let Some(own) = scene.own_antiradiance() {
                own.moved();
            }
            #[cfg(feature = "antiradiance")]
            self.follow_solver();
            self.shadows.forget();
            self.still.forget();
            self.dirty.lights = true;
            self.dirty.view = true;
        }
        Ok(())
    }
}
