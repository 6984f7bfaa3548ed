//! Nodes that move, and the bounced light that follows them within a few frames.

use super::Renderer;
use crate::error::ViewerError;
use crate::scene::GpuScene;
use rebounce_shared::motion::NodeMotion;

/// Receivers that are looked at in the first slice of a solution.
const FIRST_SLICE: u32 = 256;
/// Fewest and most receivers of a slice.
const SLICES: std::ops::RangeInclusive<u32> = 16..=1 << 16;
/// Receivers of a slice of a solution that nobody watches.
const WHOLE: u32 = 1 << 13;

/// How much of a solution a frame computes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slice {
    receivers: u32,
    /// Whether the present frame has a slice and no new picture: its time counts.
    is_timed: bool,
}

impl Default for Slice {
    fn default() -> Self {
        Self { receivers: FIRST_SLICE, is_timed: false }
    }
}

impl Renderer {
    /// Names of the nodes that may move.
    pub fn node_names(&self) -> Vec<String> {
        let moving = self.scene.as_ref().and_then(|scene| scene.moving.as_ref());
        moving.map_or(Vec::new(), |moving| moving.names().map(str::to_owned).collect())
    }

    /// Motions of these nodes, in their order.
    pub fn node_motions(&self) -> Vec<NodeMotion> {
        let moving = self.scene.as_ref().and_then(|scene| scene.moving.as_ref());
        moving.map_or(Vec::new(), |moving| moving.nodes())
    }

    /// Moves the nodes that may move, in the order of their names.
    ///
    /// # Errors
    /// [`ViewerError::NoScene`]; [`ViewerError::BadArgument`] for a motion that is none; nothing moves then.
    pub fn move_nodes(&mut self, motions: &[NodeMotion]) -> Result<(), ViewerError> {
        let scene = self.scene.clone().ok_or(ViewerError::NoScene)?;
        let Some(moving) = &scene.moving else {
            return Err(ViewerError::BadArgument(
                "nothing of this file can move: bake it with --solver radiosity".into(),
            ));
        };
        if !motions.iter().all(NodeMotion::is_usable) {
            return Err(ViewerError::BadArgument("a node's motion has a number that is not finite".into()));
        }
        if moving.nodes() == motions {
            return Ok(());
        }
        moving.place(&self.gpu, &scene.upload, motions);
        self.shadows.forget();
        self.still.forget();
        self.dirty.lights = true;
        self.dirty.view = true;
        Ok(())
    }

    /// Moves the nodes of these names; others stay where the file has them.
    ///
    /// # Errors
    /// As [`Self::move_nodes`], and for a name that no node has.
    pub fn move_named(&mut self, moves: &[(String, NodeMotion)]) -> Result<(), ViewerError> {
        let names = self.node_names();
        let mut motions = vec![NodeMotion::default(); names.len()];
        for (name, motion) in moves {
            let place = names.iter().position(|other| other == name);
            let place = place.ok_or_else(|| {
                ViewerError::BadArgument(format!(
                    "no node {name:?} can move; these can: {}",
                    names.join(", ")
                ))
            })?;
            motions[place] = *motion;
        }
        self.move_nodes(&motions)
    }

    /// Whether bounced light is on its way.
    pub fn is_solving(&self) -> bool {
        self.scene.as_ref().and_then(|scene| scene.moving.as_ref()).is_some_and(|moving| moving.is_solving())
    }

    /// Computes the next slice of bounced light.
    pub(super) fn solve(&mut self, encoder: &mut wgpu::CommandEncoder, scene: &GpuScene) {
        let (Some(moving), Some(pipelines)) = (&scene.moving, self.pipelines.radiosity.get()) else { return };
        self.slice.is_timed = moving.is_solving() && !self.dirty.view && !self.dirty.display;
        if moving.solve(&self.gpu, encoder, pipelines, &scene.relight, self.slice.receivers) {
            self.dirty.display = true;
        }
    }

    /// Computes all of the bounced light, slice by slice.
    pub(super) fn solve_all(&mut self, encoder: &mut wgpu::CommandEncoder, scene: &GpuScene) {
        let (Some(moving), Some(pipelines)) = (&scene.moving, self.pipelines.radiosity.get()) else { return };
        while moving.is_solving() {
            moving.solve(&self.gpu, encoder, pipelines, &scene.relight, WHOLE);
            let fresh = self.gpu.device.create_command_encoder(&Default::default());
            self.gpu.queue.submit([std::mem::replace(encoder, fresh).finish()]);
            self.dirty.display = true;
        }
    }

    /// Takes the milliseconds of the last frame, and adapts the slices to the `budget` of a frame.
    pub fn add_solving_time(&mut self, milliseconds: f64, budget: f64) {
        if std::mem::take(&mut self.slice.is_timed) {
            let wanted =
                f64::from(self.slice.receivers) * (0.8 * budget / milliseconds.max(0.1)).clamp(0.25, 2.0);
            self.slice.receivers = (wanted as u32).clamp(*SLICES.start(), *SLICES.end());
        }
    }
}
