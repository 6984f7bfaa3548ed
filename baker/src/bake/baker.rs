//! A bake with all its options.

use super::estimate::Estimate;
use super::stages::{Recipe, sketch_settings};
use super::stand_in::Staged;
use super::tracker::Tracker;
use super::{BakeError, BakeReport, BakeSettings, BakeSolver, Checkpoint, Observer, Stage, choose_emitter};
use crate::geometry::{SceneSurfaces, Surfaces, Tessellate};
use crate::job::Job;
use crate::job::communicator::{Communicator, CommunicatorError, run_blocking};
use crate::job::watch::Watch;
use crate::scene::Scene;
use crate::transport::{Operator, Solver};
use glam::{DVec3, Vec3};
use rebounce_shared::baked::BakedScene;
use std::ops::Deref;

/// Greatest distance between curved surfaces and their triangles in pictures, as a share of the diagonal.
const TOLERANCE: f32 = 5e-4;

/// The result of a bake: the file's contents and the figures, on process 0; `None` on other processes.
pub type Baked = Result<Option<(BakedScene, BakeReport)>, BakeError>;

/// A bake with all its options: observer, checkpoint, processes, surfaces, solver.
pub struct Baker<'a> {
    settings: &'a BakeSettings,
    observer: &'a dyn Observer,
    checkpoint: Option<&'a Checkpoint>,
    communicator: &'a dyn Communicator,
}

/// Surfaces for rays, with their number of triangles (a model counts once) and of primitives (every copy counts).
pub(super) struct Built<B> {
    surfaces: B,
    triangles: u64,
    primitives: u64,
    /// Mean share of light that goes through each material; empty where none does.
    transmittance: Vec<f32>,
}

impl Built<Box<SceneSurfaces>> {
    /// The simplified triangles of a scene, and its exact faces.
    pub(super) fn of_scene(scene: &Scene) -> Self {
        let surfaces = Box::new(SceneSurfaces::simplified(scene));
        let (triangles, primitives) =
            (surfaces.triangles().triangle_count() as u64, surfaces.primitive_count());
        let has_groups = !scene.groups.is_empty();
        let transmittance = if has_groups { surfaces.triangles().mean_transmittance() } else { Vec::new() };
        Self { surfaces, triangles, primitives, transmittance }
    }
}

impl<'a> Baker<'a> {
    /// A bake by this process alone, without observer and checkpoint.
    pub fn new(settings: &'a BakeSettings) -> Self {
        Self { settings, observer: &(), checkpoint: None, communicator: &() }
    }

    /// Reports progress to an observer, which may stop the bake.
    pub fn observer(self, observer: &'a dyn Observer) -> Self {
        Self { observer, ..self }
    }

    /// Stores finished work in a checkpoint, and resumes from the checkpoint's records; the result is the same, to the
    /// byte. Of several processes only process 0 may have a checkpoint; it stores the work of all.
    pub fn checkpoint(self, checkpoint: Option<&'a Checkpoint>) -> Self {
        Self { checkpoint, ..self }
    }

    /// Bakes together with other processes. All of them bake the same scene with the same settings; the result is the
    /// same, to the byte.
    pub fn communicator(self, communicator: &'a dyn Communicator) -> Self {
        Self { communicator, ..self }
    }

    /// Bakes a scene.
    ///
    /// # Errors
    /// [`BakeError`]; finished work is in the checkpoint.
    pub fn bake(&self, scene: &Scene) -> Baked {
        self.bake_with(scene, &self.settings.solver)
    }

    /// Bakes a scene with members that do not block: the workers of a web page. The future waits for nothing
    /// but their messages.
    ///
    /// # Errors
    /// [`BakeError`]; finished work is in the checkpoint.
    pub async fn bake_async(&self, scene: &Scene) -> Baked {
        self.run(scene, || Built::of_scene(scene), &self.settings.solver).await
    }

    /// Bakes a scene with a solver.
    ///
    /// # Errors
    /// [`BakeError`]; finished work is in the checkpoint.
    pub fn bake_with<V>(&self, scene: &Scene, solver: &V) -> Baked
    where
        V: Solver<SceneSurfaces, Solution = Operator>,
    {
        blocking(self.run(scene, || Built::of_scene(scene), solver))
    }

    /// Bakes any surfaces with a solver. `scene` has their materials, lights and cameras, and no triangles: pictures
    /// show the surfaces' [tessellation](Tessellate), rays meet the surfaces themselves.
    ///
    /// # Errors
    /// [`BakeError`]; finished work is in the checkpoint.
    pub fn bake_surfaces<S, V>(&self, scene: &Scene, surfaces: &S, solver: &V) -> Baked
    where
        S: Tessellate,
        V: Solver<S, Solution = Operator>,
    {
        let (low, high) = surfaces.bounds();
        let scene = scene.with_triangles(surfaces.tessellate(TOLERANCE * (high - low).length()));
        let triangles = scene.triangles.len() as u64;
        let primitives = surfaces.primitives().map_or(triangles, |primitives| primitives.count() as u64);
        blocking(self.run(
            &scene,
            || Built { surfaces, triangles, primitives, transmittance: Vec::new() },
            solver,
        ))
    }

    async fn run<S, B, V>(&self, scene: &Scene, build: impl FnOnce() -> Built<B>, solver: &V) -> Baked
    where
        S: Surfaces,
        B: Deref<Target = S>,
        V: Solver<S, Solution = Operator>,
    {
        let settings = self.settings.clone().normalised();
        // Points without links are a draft by themselves.
        let has_links = settings.solver == BakeSolver::Operator;
        let sketch = sketch_settings(&settings).filter(|_| has_links && self.wants_sketch());
        let baked = self.prepared(scene, build, sketch.is_some(), async |recipe, tracker, report| {
            if let Some(settings) = sketch {
                recipe.sketch(solver, settings, &tracker.task(Stage::Sketch, None)).await?;
            }
            recipe.run(solver, settings.clone(), tracker, report).await
        });
        let baked = baked.await;
        if let Some(checkpoint) = self.checkpoint {
            // A failed checkpoint ends the bake as stopped; `flush` returns the cause.
            checkpoint.flush()?;
        }
        baked
    }

    /// Builds the surfaces, finds viewpoints, lights and cameras, and calls `work`.
    pub(super) async fn prepared<S, B, T>(
        &self,
        scene: &Scene,
        build: impl FnOnce() -> Built<B>,
        has_sketch: bool,
        work: impl AsyncFnOnce(&Recipe<S>, &Tracker, BakeReport) -> Result<T, BakeError>,
    ) -> Result<T, BakeError>
    where
        S: Surfaces,
        B: Deref<Target = S>,
    {
        let settings = self.settings.clone().normalised();
        if scene.triangles.is_empty() {
            return Err(BakeError::Empty);
        }
        let threads = rayon::current_num_threads();
        let estimate = Estimate::new(&settings, scene.triangles.len(), has_sketch, threads);
        let tracker = Tracker::new(self.observer, self.checkpoint, estimate);
        let task = tracker.task(Stage::Bvh, None);
        let Built { surfaces, triangles, primitives, transmittance } = build();
        tracker.expect(|estimate| estimate.found_surfaces(&settings, primitives));
        task.step(0)?;
        let emitter = choose_emitter(scene, &*surfaces, &settings)?;
        task.step(0)?;
        let staged = Staged::new(scene, &emitter, &*surfaces, settings.purpose);
        task.step(0)?;
        drop(task);
        let world = |local: &Vec3| (DVec3::from(scene.origin) + local.as_dvec3()).to_array();
        let report = BakeReport {
            ray_triangles: triangles,
            viewpoints: emitter.viewpoints.iter().map(world).collect(),
            is_open: emitter.is_open,
            lamp_added: scene.all_lights().0.is_empty(),
            camera_added: scene.cameras.is_empty(),
            camera: staged.cameras[0].position,
            ..BakeReport::new(scene, &settings)
        };
        let job = Job {
            reporter: &tracker,
            partial_results: self.checkpoint.map_or(&(), |checkpoint| checkpoint),
            communicator: self.communicator,
        };
        let recipe = Recipe {
            scene,
            surfaces: &*surfaces,
            emitter: &emitter,
            staged: &staged,
            transmittance: &transmittance,
            observer: self.observer,
            job,
        };
        work(&recipe, &tracker, report).await
    }

    /// Whether to bake a coarse preview first: not when earlier work is at hand.
    fn wants_sketch(&self) -> bool {
        let is_fresh = self.checkpoint.is_none_or(|checkpoint| checkpoint.records_found() == 0);
        self.observer.wants_previews() && is_fresh
    }
}

/// Runs a bake whose communicator blocks.
fn blocking(bake: impl Future<Output = Baked>) -> Baked {
    run_blocking(bake).unwrap_or(Err(BakeError::Communicator(CommunicatorError::WouldBlock)))
}
