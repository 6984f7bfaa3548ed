//! Nodes that move, and the bounced light that follows them within a few frames.

use super::Renderer;
#[cfg(feature = "antiradiance")]
use super::lighting::Lit;
use super::pipelines::Pipelines;
use crate::controls::node_gizmo::StageNode;
use crate::error::ViewerError;
#[cfg(feature = "antiradiance")]
use crate::gpu::Gpu;
use crate::passes::settings::SolverChoice;
#[cfg(feature = "antiradiance")]
use crate::passes::shadow::Shadows;
#[cfg(feature = "antiradiance")]
use crate::passes::timing::Pass;
use crate::scene::GpuScene;
#[cfg(feature = "antiradiance")]
use crate::scene::antiradiance::{
    AntiradianceCounts, AntiradiancePipelines, Lamps, Preparation, SceneAntiradiance,
};
use crate::scene::moving::Moving;
use crate::scene::radiosity::RadiosityPipelines;
use rebounce_shared::motion::NodeMotion;
use rebounce_shared::rbn::node_tracks::NodeAnimation;

/// Receivers that are looked at in the first slice of a solution.
const FIRST_SLICE: u32 = 256;
/// Fewest and most receivers of a slice.
const SLICES: std::ops::RangeInclusive<u32> = 16..=1 << 16;
/// Receivers of a slice of a solution that nobody watches.
const WHOLE: u32 = 1 << 13;
/// Links of what moves that a frame makes.
#[cfg(feature = "antiradiance")]
const LINKS: usize = 6_000;
/// Work on the first links of antiradiance in a frame.
#[cfg(feature = "antiradiance")]
pub(super) const PIECE: usize = 8_000;

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

/// What computes the bounced light of a scene by radiosity, with its pipelines; `None` where links do.
pub(super) fn solving<'a>(
    pipelines: &'a Pipelines,
    scene: &'a GpuScene,
) -> Option<(&'a Moving, &'a RadiosityPipelines)> {
    Some((scene.by_radiosity()?, pipelines.radiosity.get()?))
}

impl Renderer {
    fn moving(&self) -> Option<&Moving> {
        self.scene.as_ref()?.moving.as_ref()
    }

    fn by_radiosity(&self) -> Option<&Moving> {
        self.scene.as_ref()?.by_radiosity()
    }

    /// Chooses what computes bounced light, of this scene and of those after it.
    pub fn set_solver(&mut self, choice: SolverChoice) {
        self.solver = choice;
        self.follow_solver();
    }

    /// What computes bounced light now: `operator`, `radiosity` or `antiradiance`.
    pub fn solver_in_use(&self) -> &'static str {
        #[cfg(feature = "antiradiance")]
        if self.by_antiradiance().is_some() {
            return SolverChoice::Antiradiance.name();
        }
        self.by_radiosity().map_or(SolverChoice::Operator, |_| SolverChoice::Radiosity).name()
    }

    /// Lets the scene follow the choice of a solver, and where its nodes are.
    pub(super) fn follow_solver(&mut self) {
        let Some(scene) = &self.scene else { return };
        let Some(moving) = &scene.moving else { return };
        #[cfg(feature = "antiradiance")]
        let is_by_antiradiance = self.wants_antiradiance(scene) && self.has_antiradiance(scene, moving);
        #[cfg(not(feature = "antiradiance"))]
        let is_by_antiradiance = false;
        let is_by_radiosity = match self.solver {
            _ if !scene.relight.is_linked() => true,
            _ if is_by_antiradiance => false,
            SolverChoice::Auto => moving.is_moved(),
            choice => choice == SolverChoice::Radiosity,
        };
        self.dirty.lights |= scene.relight.set_by_radiosity(is_by_radiosity);
        #[cfg(feature = "antiradiance")]
        {
            self.dirty.lights |= scene.is_by_antiradiance.replace(is_by_antiradiance) != is_by_antiradiance;
        }
    }

    #[cfg(feature = "antiradiance")]
    fn by_antiradiance(&self) -> Option<&SceneAntiradiance> {
        self.scene.as_ref()?.by_antiradiance()
    }

    /// Elements, links and steps of antiradiance; `None` where something else computes bounced light.
    #[cfg(feature = "antiradiance")]
    pub fn antiradiance_counts(&self) -> Option<AntiradianceCounts> {
        Some(self.by_antiradiance()?.counts())
    }

    /// Whether antiradiance is to compute bounced light: where it is chosen, and of itself while something deforms.
    #[cfg(feature = "antiradiance")]
    fn wants_antiradiance(&self, scene: &GpuScene) -> bool {
        match self.solver {
            SolverChoice::Antiradiance => true,
            SolverChoice::Auto => scene.is_posed(),
            SolverChoice::Operator | SolverChoice::Radiosity => false,
        }
    }

    /// Whether antiradiance has what it takes for a scene; it begins to prepare that the first time.
    #[cfg(feature = "antiradiance")]
    fn has_antiradiance(&self, scene: &GpuScene, moving: &Moving) -> bool {
        match scene.antiradiance.get() {
            Some(made) => made.is_some(),
            None => {
                let from = (moving, scene.rig.as_ref());
                let mut preparing = scene.preparing.borrow_mut();
                preparing.get_or_insert_with(|| Preparation::new(from, &scene.upload));
                false
            }
        }
    }

    /// Makes some of the links of antiradiance, if it waits for them, and lets it compute bounced light when they are there.
    #[cfg(feature = "antiradiance")]
    pub(super) fn prepare_antiradiance(&mut self, scene: &GpuScene, work: usize) {
        if !self.is_preparing(scene) {
            return;
        }
        let Some(moving) = &scene.moving else { return };
        let Some(preparing) = scene.preparing.take() else { return };
        match preparing.advance(work) {
            Ok(prepared) => {
                let pipelines =
                    self.pipelines.antiradiance.get_or_init(|| AntiradiancePipelines::new(&self.gpu));
                let (from, to) = ((moving, scene.rig.as_ref()), (&scene.upload, &scene.relight));
                // A scene may have more links than a buffer holds: it goes without, then.
                let made = SceneAntiradiance::new(&self.gpu, pipelines, prepared, from, to).ok();
                let _ = scene.antiradiance.set(made);
                self.follow_solver();
            }
            Err(preparing) => *scene.preparing.borrow_mut() = Some(preparing),
        }
    }

    #[cfg(feature = "antiradiance")]
    fn is_preparing(&self, scene: &GpuScene) -> bool {
        self.wants_antiradiance(scene) && scene.preparing.borrow().is_some()
    }

    /// Takes some steps of antiradiance.
    #[cfg(feature = "antiradiance")]
    fn step_antiradiance(&mut self, encoder: &mut wgpu::CommandEncoder, scene: &GpuScene, timed: bool) {
        let Some((own, moving)) = scene.by_antiradiance().zip(scene.moving.as_ref()) else { return };
        let Some(pipelines) = self.pipelines.antiradiance.get() else { return };
        // What moves has more links than a buffer holds: the light stays that of the places before.
        let lamps = lamps(&self.pipelines, &self.shadows, &self.lit);
        let timing = self.timing.as_mut().filter(|_| timed);
        let stamps = timing.and_then(|timing| timing.stamps(Pass::Antiradiance));
        let both = [true, false].map(|begins| stamps.map(|stamps| stamps.compute(begins, !begins)));
        let from = (moving, scene.rig.as_ref());
        // Frames of software adapters are long.
        let work = if timed && !self.gpu.software { LINKS } else { usize::MAX };
        let _ = own.solve(&self.gpu, encoder, pipelines, from, (&lamps, work), both);
        if !own.is_beside_operator() {
            scene.relight.show_sources(encoder);
        }
        self.dirty.display = true;
    }

    /// Names of the nodes that may move.
    pub fn node_names(&self) -> Vec<String> {
        self.moving().map_or(Vec::new(), |moving| moving.names().map(str::to_owned).collect())
    }

    /// Names of the nodes, and the file's keyframes of them.
    pub fn node_animations(&self) -> (Vec<String>, Vec<NodeAnimation>) {
        (self.node_names(), self.moving().map_or(Vec::new(), |moving| moving.animations().to_vec()))
    }

    /// Motions of these nodes, in their order.
    pub fn node_motions(&self) -> Vec<NodeMotion> {
        self.moving().map_or(Vec::new(), Moving::nodes)
    }

    /// Moves the nodes that may move, in the order of their names; no motion is what a file without such nodes takes.
    ///
    /// # Errors
    /// [`ViewerError::NoScene`]; [`ViewerError::BadArgument`] for a motion that is none; nothing moves then.
    pub fn move_nodes(&mut self, motions: &[NodeMotion]) -> Result<(), ViewerError> {
        let scene = self.scene.clone().ok_or(ViewerError::NoScene)?;
        let Some(moving) = &scene.moving else {
            if motions.is_empty() {
                return Ok(());
            }
            return Err(ViewerError::BadArgument(
                "nothing of this file can move: bake it with --group NODE or --solver radiosity".into(),
            ));
        };
        if !motions.iter().all(NodeMotion::is_usable) {
            return Err(ViewerError::BadArgument("a node's motion has a number that is not finite".into()));
        }
        if moving.nodes() == motions {
            return Ok(());
        }
        moving.place(&scene.upload, motions);
        if let Some(rig) = &scene.rig {
            rig.renew();
        }
        #[cfg(feature = "antiradiance")]
        if let Some(own) = scene.own_antiradiance() {
            own.moved();
        }
        self.follow_solver();
        self.shadows.forget();
        self.still.forget();
        self.dirty.lights = true;
        self.dirty.view = true;
        Ok(())
    }

    /// The nodes as the controls see them.
    pub(super) fn stage_nodes(&self) -> Vec<StageNode> {
        let Some(moving) = self.moving() else { return Vec::new() };
        let placed = moving.places().into_iter().zip(moving.nodes());
        placed.map(|([middle, origin], motion)| StageNode { middle, origin, motion }).collect()
    }

    /// Applies what the controls have done to the nodes.
    pub(super) fn apply_nodes(&mut self, nodes: &[StageNode]) {
        if !nodes.is_empty() {
            let motions: Vec<NodeMotion> = nodes.iter().map(|node| node.motion).collect();
            // Controls only ever make small steps from a valid state.
            let _ = self.move_nodes(&motions);
        }
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
        #[cfg(feature = "antiradiance")]
        if self.scene.as_ref().is_some_and(|scene| self.is_preparing(scene)) {
            return true;
        }
        #[cfg(feature = "antiradiance")]
        if let Some(own) = self.by_antiradiance() {
            return own.is_solving();
        }
        self.by_radiosity().is_some_and(Moving::is_solving)
    }

    /// Computes the next slice of bounced light.
    pub(super) fn solve(&mut self, encoder: &mut wgpu::CommandEncoder, scene: &GpuScene) {
        #[cfg(feature = "antiradiance")]
        if scene.by_antiradiance().is_some_and(SceneAntiradiance::is_solving) {
            return self.step_antiradiance(encoder, scene, true);
        }
        let Some((moving, pipelines)) = solving(&self.pipelines, scene) else { return };
        self.slice.is_timed = moving.is_solving() && !self.dirty.view && !self.dirty.display;
        if moving.solve(&self.gpu, encoder, pipelines, &scene.relight, self.slice.receivers) {
            self.dirty.display = true;
        }
    }

    /// Computes all of the bounced light, slice by slice.
    pub(super) fn solve_all(&mut self, encoder: &mut wgpu::CommandEncoder, scene: &GpuScene) {
        #[cfg(feature = "antiradiance")]
        while scene.by_antiradiance().is_some_and(SceneAntiradiance::is_solving) {
            self.step_antiradiance(encoder, scene, false);
        }
        let Some((moving, pipelines)) = solving(&self.pipelines, scene) else { return };
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

/// The lamps, with their shadow maps.
#[cfg(feature = "antiradiance")]
fn lamps<'a>(pipelines: &'a Pipelines, shadows: &'a Shadows, lit: &Lit) -> Lamps<'a> {
    Lamps { layout: &pipelines.shadow.layout, group: shadows.group(), count: lit.lamps().len() }
}

/// Evaluates lamps and operator where antiradiance adds to its light. Returns whether it does.
#[cfg(feature = "antiradiance")]
pub(super) fn relight_beside(
    gpu: &Gpu,
    encoder: &mut wgpu::CommandEncoder,
    scene: &GpuScene,
    (pipelines, shadows, lit): (&Pipelines, &Shadows, &Lit),
    [begin, end]: [Option<wgpu::ComputePassTimestampWrites<'_>>; 2],
) -> bool {
    let own = scene.by_antiradiance().filter(|own| own.is_beside_operator());
    let Some((own, kernels)) = own.zip(pipelines.antiradiance.get()) else { return false };
    let [direct, bounced] = scene.relight.parts();
    let lights = Some(shadows.group());
    scene.relight.encode_part(encoder, &pipelines.relight, lights, begin, direct);
    own.take_light(gpu, encoder, kernels, &lamps(pipelines, shadows, lit));
    scene.relight.encode_part(encoder, &pipelines.relight, lights, end, bounced);
    own.keep_operator(encoder);
    true
}
