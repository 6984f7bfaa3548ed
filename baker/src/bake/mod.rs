//! The whole bake: from a scene to a file's contents.
//!
//! * [`observer`] – what a bake tells, and what it can be told;
//! * `stages` – the stages in order; `assemble` – the file's contents;
//! * `stand_in` – camera and lamp of a scene that has none, and an object's ground;
//! * [`budget`] – what a bake may weigh; [`judge`] – how far its light is from the truth; [`aim`] – what to try next;
//! * `agree` – whether the members of a team work on the same;
//! * [`checkpoint`] – what is kept, so that a bake can go on;
//! * `tracker`, `estimate` – how far it is, and how long the rest takes;
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

use crate::communicator::{Communicator, CommunicatorError};
use crate::geometry::mesh::TriangleSurfaces;
use crate::sampling::emitter::{ParticleEmitter, View};
use crate::sampling::{PlaceError, candidates::Candidates};
use crate::scene::Scene;
use crate::watch::{Stopped, Watch};
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

/// Why a bake failed.
#[derive(Debug, thiserror::Error)]
pub enum BakeError {
    /// No triangle.
    #[error("the scene has no triangles to bake")]
    Empty,
    /// No viewpoint was given and none was found.
    #[error(
        "no place was found, inside the scene or around it, from which any surface's reflecting side can be seen: give one with --viewpoint x,y,z (are the surfaces one-sided and facing away?)"
    )]
    NoViewpoint,
    /// Points could not be placed.
    #[error(transparent)]
    Place(PlaceError),
    /// The observer asked for it.
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
    /// A process of the team sent what cannot be used.
    #[error(transparent)]
    Communicator(CommunicatorError),
    /// More planes at walls than a file can hold.
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
/// [`BakeError`]; [`BakeError::Stopped`] if the observer asked for it.
pub fn bake(
    scene: &Scene,
    settings: &BakeSettings,
    observer: &dyn Observer,
) -> Result<(BakedScene, BakeReport), BakeError> {
    // Who works alone is the first of its team.
    run(scene, settings, observer, None, &())?.ok_or(BakeError::Stopped)
}

/// Bakes a scene, keeps what is done in a checkpoint, and goes on from what the checkpoint has. The result is the one
/// that [`bake`] gives, to the byte.
///
/// # Errors
/// [`BakeError`]; then what was done is in the checkpoint, on the disk.
pub fn bake_with_checkpoint(
    scene: &Scene,
    settings: &BakeSettings,
    observer: &dyn Observer,
    checkpoint: &Checkpoint,
) -> Result<(BakedScene, BakeReport), BakeError> {
    bake_in_team(scene, settings, observer, Some(checkpoint), &())?.ok_or(BakeError::Stopped)
}

/// Bakes a scene together with the other members of a team, all of which call this with the same scene and settings.
/// The first member gets the result, the one that [`bake`] gives, to the byte; the others get nothing. Only the first
/// member may have a checkpoint; it keeps what all have done.
///
/// # Errors
/// [`BakeError`]; then the others wait until they are stopped or ended, and what was done is in the checkpoint.
pub fn bake_in_team(
    scene: &Scene,
    settings: &BakeSettings,
    observer: &dyn Observer,
    checkpoint: Option<&Checkpoint>,
    team: &dyn Communicator,
) -> Result<Option<(BakedScene, BakeReport)>, BakeError> {
    let baked = run(scene, settings, observer, checkpoint, team);
    if let Some(checkpoint) = checkpoint {
        // If this is what ended the bake, it is what went wrong.
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

/// The scene's lights and cameras as its file will have them, world space: where it has none, what a bake adds.
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

/// Where points are placed from, and what for: the viewpoints given, or the cameras that see something, or what is found.
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
