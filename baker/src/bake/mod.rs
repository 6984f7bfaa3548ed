//! The complete bake: from a scene to the contents of a file.
//!
//! * [`observer`] – progress reports and stopping;
//! * `stages` – the stages in order; `assemble` – the file's contents;
//! * `stand_in` – camera and lamp for scenes without, and the ground of an object;
//! * [`budget`] – limits on size and memory; [`judge`] – the error against ground truth; [`aim`] – settings to try
//!   next;
//! * `agree` – check that all processes work on the same points;
//! * [`checkpoint`] – finished work on disk, so that a bake can resume;
//! * `tracker`, `estimate` – progress, and the time left;
//! * `preset`, `report` – settings, and figures.

mod agree;
pub mod aim;
mod assemble;
pub mod budget;
pub mod checkpoint;
mod estimate;
pub mod judge;
pub mod observer;
mod preset;
mod report;
mod stages;
mod stand_in;
mod tracker;

pub use checkpoint::{Checkpoint, CheckpointError, Identity};
pub use observer::{Observer, Preview, Progress, Stage};
pub use preset::{BakeSettings, Preset};
pub use report::{BakeReport, LevelReport, SectionReport, TrafficReport, peak_memory_bytes};

use crate::geometry::mesh::TriangleSurfaces;
use crate::job::communicator::{Communicator, CommunicatorError};
use crate::job::watch::{Stopped, Watch};
use crate::sampling::emitter::{ParticleEmitter, View};
use crate::sampling::{PlaceError, candidates::Candidates};
use crate::scene::Scene;
use estimate::Estimate;
use glam::{DVec3, Vec3};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::RbnError;
use rebounce_shared::rbn::bulk::MAX_ALL_CUTS;
use stages::{Transport, sketch_settings};
use stand_in::Staged;
use tracker::Tracker;

/// Reason for a failed bake.
#[derive(Debug, thiserror::Error)]
pub enum BakeError {
    /// The scene has no triangles.
    #[error("the scene has no triangles to bake")]
    Empty,
    /// No viewpoint was given, and none was found.
    #[error(
        "no place was found, inside the scene or around it, from which any surface's reflecting side can be seen: give one with --viewpoint x,y,z (are the surfaces one-sided and facing away?)"
    )]
    NoViewpoint,
    /// Points could not be placed.
    #[error(transparent)]
    Place(PlaceError),
    /// The observer stopped the bake.
    #[error("the bake was stopped before it was done")]
    Stopped,
    /// The checkpoint cannot be used.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A process of the team has placed other points.
    #[error(
        "process {0} works on another scene, or has come to other points: start all processes from the same program with the same arguments, on processors of one kind"
    )]
    Apart(usize),
    /// A process of the team sent invalid data.
    #[error(transparent)]
    Communicator(CommunicatorError),
    /// More clip planes than a file can hold.
    #[error("supports are cut off by over {MAX_ALL_CUTS} walls: bake with fewer --functions or --levels")]
    TooManyCuts,
    /// The result does not fit the file format.
    #[error(transparent)]
    Format(#[from] RbnError),
}

impl From<Stopped> for BakeError {
    fn from(_: Stopped) -> Self {
        Self::Stopped
    }
}

impl From<CommunicatorError> for BakeError {
    fn from(error: CommunicatorError) -> Self {
        match error {
            CommunicatorError::Stopped(_) => Self::Stopped,
            error => Self::Communicator(error),
        }
    }
}

impl From<PlaceError> for BakeError {
    fn from(error: PlaceError) -> Self {
        match error {
            PlaceError::Stopped(_) => Self::Stopped,
            error => Self::Place(error),
        }
    }
}

/// Bakes a scene. The same scene and settings give the same result at any thread count.
///
/// # Errors
/// [`BakeError`]; [`BakeError::Stopped`] if the observer stopped the bake.
pub fn bake(
    scene: &Scene,
    settings: &BakeSettings,
    observer: &dyn Observer,
) -> Result<(BakedScene, BakeReport), BakeError> {
    // A single process is the first member of its team.
    run(scene, settings, observer, None, &())?.ok_or(BakeError::Stopped)
}

/// Bakes a scene, stores finished work in a checkpoint, and resumes from the checkpoint's records. The result equals
/// the result of [`bake`], to the byte.
///
/// # Errors
/// [`BakeError`]; finished work is then in the checkpoint, on disk.
pub fn bake_with_checkpoint(
    scene: &Scene,
    settings: &BakeSettings,
    observer: &dyn Observer,
    checkpoint: &Checkpoint,
) -> Result<(BakedScene, BakeReport), BakeError> {
    bake_in_team(scene, settings, observer, Some(checkpoint), &())?.ok_or(BakeError::Stopped)
}

/// Bakes a scene together with the other members of a team. All members call this function with the same scene and
/// settings. The first member gets the result, equal to the result of [`bake`] to the byte; the other members get
/// `None`. Only the first member may have a checkpoint; the checkpoint stores the work of all members.
///
/// # Errors
/// [`BakeError`]; the other members then wait until stopped or ended, and finished work is in the checkpoint.
pub fn bake_in_team(
    scene: &Scene,
    settings: &BakeSettings,
    observer: &dyn Observer,
    checkpoint: Option<&Checkpoint>,
    team: &dyn Communicator,
) -> Result<Option<(BakedScene, BakeReport)>, BakeError> {
    let baked = run(scene, settings, observer, checkpoint, team);
    if let Some(checkpoint) = checkpoint {
        // A failed checkpoint ends the bake as stopped; `flush` returns the cause.
        checkpoint.flush()?;
    }
    baked
}

fn run(
    scene: &Scene,
    settings: &BakeSettings,
    observer: &dyn Observer,
    checkpoint: Option<&Checkpoint>,
    team: &dyn Communicator,
) -> Result<Option<(BakedScene, BakeReport)>, BakeError> {
    let settings = settings.clone().normalised();
    if scene.triangles.is_empty() {
        return Err(BakeError::Empty);
    }
    let mut report = BakeReport::new(scene, &settings);
    let sketch = sketch_settings(&settings).filter(|_| {
        observer.wants_previews() && checkpoint.is_none_or(|checkpoint| checkpoint.records_found() == 0)
    });
    let threads = rayon::current_num_threads();
    let estimate = Estimate::new(&settings, scene.triangles.len(), sketch.is_some(), threads);
    let tracker = Tracker::new(observer, checkpoint, estimate);
    let task = tracker.task(Stage::Prepare, None);
    let surfaces = TriangleSurfaces::simplified(scene);
    report.ray_triangles = surfaces.triangle_count() as u64;
    tracker.expect(|estimate| estimate.found_surfaces(&settings, surfaces.piece_count()));
    task.step(0)?;
    let vantage = choose_vantage(scene, &surfaces, &settings)?;
    task.step(0)?;
    let staged = Staged::new(scene, &vantage, &surfaces);
    task.step(0)?;
    drop(task);
    let world = |local: &Vec3| (DVec3::from(scene.origin) + local.as_dvec3()).to_array();
    report.viewpoints = vantage.viewpoints.iter().map(world).collect();
    report.is_open = vantage.is_open;
    report.lamp_added = scene.lights.is_empty();
    report.camera_added = scene.cameras.is_empty();
    report.camera = staged.cameras[0].position;
    let bake = Transport { scene, surfaces: &surfaces, vantage: &vantage, staged: &staged, observer, team };
    if let Some(settings) = sketch {
        bake.sketch(settings, &tracker.task(Stage::Sketch, None))?;
    }
    bake.run(settings, &tracker, checkpoint, report)
}

/// Returns the lights and cameras of the scene's file, world space: the scene's own, or the lights and cameras that a
/// bake adds.
///
/// # Errors
/// [`BakeError::NoViewpoint`], [`BakeError::Empty`].
pub fn lights_and_cameras(
    scene: &Scene,
    settings: &BakeSettings,
) -> Result<(Vec<Light>, Vec<Camera>), BakeError> {
    if !scene.lights.is_empty() && !scene.cameras.is_empty() {
        return Ok((scene.lights.clone(), scene.cameras.clone()));
    }
    if scene.triangles.is_empty() {
        return Err(BakeError::Empty);
    }
    let surfaces = TriangleSurfaces::simplified(scene);
    let vantage = choose_vantage(scene, &surfaces, settings)?;
    let staged = Staged::new(scene, &vantage, &surfaces);
    Ok((staged.lights, staged.cameras))
}

/// Chooses where points are placed from, and for which views: the given viewpoints, or the cameras that see surfaces,
/// or a search of the scene.
///
/// # Errors
/// [`BakeError::NoViewpoint`].
pub fn choose_vantage(
    scene: &Scene,
    surfaces: &TriangleSurfaces,
    settings: &BakeSettings,
) -> Result<ParticleEmitter, BakeError> {
    let local = |world: [f64; 3]| (DVec3::from(world) - DVec3::from(scene.origin)).as_vec3();
    let seed = settings.place.seed;
    if !settings.viewpoints.is_empty() {
        let viewpoints: Vec<Vec3> = settings.viewpoints.iter().copied().map(local).collect();
        let views = viewpoints.iter().copied().map(View::around).collect();
        return Ok(ParticleEmitter { views, ..ParticleEmitter::at(surfaces, viewpoints, seed) });
    }
    let cameras = || settings.camera.iter().chain(&scene.cameras);
    let view = |camera: &Camera| {
        let frame = camera.frame(scene.origin);
        View::of_camera(frame.eye, frame.forward, camera.yfov_deg as f32)
    };
    let views = cameras().map(view).collect();
    let mut viewpoints: Vec<Vec3> = cameras().map(|camera| local(camera.position)).collect();
    viewpoints.retain(|point| {
        Candidates::new(surfaces, &ParticleEmitter::within(*point), seed).batch().len() > 1000
    });
    if !viewpoints.is_empty() {
        return Ok(ParticleEmitter { views, ..ParticleEmitter::at(surfaces, viewpoints, seed) });
    }
    let lamps: Vec<Vec3> = scene.lights.iter().filter_map(Light::position).map(local).collect();
    let found = ParticleEmitter::find(surfaces, &lamps, seed).ok_or(BakeError::NoViewpoint)?;
    Ok(ParticleEmitter { views, ..found })
}
