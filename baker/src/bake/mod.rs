//! The complete bake: from a scene to the contents of a file.
//!
//! * [`Baker`] – a bake with all its options; [`bake`] – with the usual ones;
//! * `stages` – the stages in order; `assemble` – the file's contents; `rig`, `nearest` – those that animations deform;
//! * [`solve()`] – a fixed solution, for lights that stay in place; `solve_report` – its figures;
//! * [`observer`] – progress reports and stopping; `tracker`, `estimate` – progress, and the time left;
//! * `stand_in` – camera and lamp for scenes without, and the ground of an object;
//! * [`budget`] – limits on size and memory; [`judge`] – the error against ground truth; [`aim`] – settings to try
//!   next;
//! * `identity` – the inputs of the result; `placed` – points as partial results;
//! * `preset`, `report` – settings, and figures.

pub mod aim;
mod assemble;
mod baker;
pub mod budget;
mod estimate;
mod identity;
pub mod judge;
pub mod observer;
mod placed;
mod preset;
mod report;
mod rig;
mod solve;
mod solve_report;
mod stages;
mod stand_in;
mod tracker;

pub use crate::job::checkpoint::{Checkpoint, CheckpointError, Identity};
pub use crate::job::stage::Stage;
pub use baker::Baker;
pub use observer::{Observer, Preview, Progress};
pub use preset::{BakeSettings, BakeSolver, Preset, Purpose};
pub use report::{BakeReport, LevelReport, SectionReport, TrafficReport, peak_memory_bytes};
pub use solve::{FixedSolver, SolveSettings, solve};
pub use solve_report::{AntiradianceReport, SolveReport, WaveletReport};

use crate::geometry::SceneSurfaces;
use crate::geometry::Surfaces;
use crate::job::communicator::CommunicatorError;
use crate::job::watch::Stopped;
use crate::sampling::emitter::{ParticleEmitter, View};
use crate::sampling::{PlaceError, candidates::Candidates};
use crate::scene::Scene;
#[cfg(feature = "antiradiance")]
use crate::transport::antiradiance::AntiradianceError;
#[cfg(feature = "exact-faces")]
use crate::transport::wavelet::{WaveletError, WaveletRadiosityError};
use glam::{DVec3, Vec3};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::RbnError;
use rebounce_shared::rbn::bulk::MAX_ALL_CUTS;
use stand_in::Staged;

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
    /// No light of the sky arrives, where the file is for an environment.
    #[error(
        "no light from around reaches the scene, so it cannot be baked for an environment: leave out `--for environment`, or open the scene to the sky"
    )]
    NoSky,
    /// Points could not be placed.
    #[error(transparent)]
    Place(PlaceError),
    /// The observer stopped the bake.
    #[error("the bake was stopped before it was done")]
    Stopped,
    /// The checkpoint cannot be used.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// Another process works on other data.
    #[error("{}", CommunicatorError::Apart(*.0))]
    Apart(usize),
    /// Another process sent invalid data.
    #[error(transparent)]
    Communicator(CommunicatorError),
    /// More clip planes than a file can hold.
    #[error("supports are cut off by over {MAX_ALL_CUTS} walls: bake with fewer --functions or --levels")]
    TooManyCuts,
    /// Wavelet radiosity cannot take the scene.
    #[cfg(feature = "exact-faces")]
    #[error(transparent)]
    Wavelet(WaveletError),
    /// There is nothing to make patches of.
    #[cfg(feature = "antiradiance")]
    #[error("{}", AntiradianceError::Empty)]
    NoPatches,
    /// The result does not fit the file format.
    #[error(transparent)]
    Format(#[from] RbnError),
}

#[cfg(feature = "antiradiance")]
impl From<AntiradianceError> for BakeError {
    fn from(error: AntiradianceError) -> Self {
        match error {
            AntiradianceError::Empty => Self::NoPatches,
            AntiradianceError::Stopped(_) => Self::Stopped,
            AntiradianceError::Job(error) => error.into(),
        }
    }
}

#[cfg(feature = "exact-faces")]
impl From<WaveletRadiosityError> for BakeError {
    fn from(error: WaveletRadiosityError) -> Self {
        match error {
            WaveletRadiosityError::Stopped(_) | WaveletRadiosityError::Wavelet(WaveletError::Stopped(_)) => {
                Self::Stopped
            }
            WaveletRadiosityError::Wavelet(error) => Self::Wavelet(error),
            WaveletRadiosityError::Job(error) => error.into(),
        }
    }
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
            CommunicatorError::Apart(member) => Self::Apart(member),
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
    // A single process is process 0.
    Baker::new(settings).observer(observer).bake(scene)?.ok_or(BakeError::Stopped)
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
    let (lights, _) = scene.all_lights();
    if !lights.is_empty() && !scene.cameras.is_empty() {
        return Ok((lights, scene.cameras.clone()));
    }
    if scene.triangles.is_empty() {
        return Err(BakeError::Empty);
    }
    let surfaces = SceneSurfaces::simplified(scene);
    let emitter = choose_emitter(scene, &surfaces, settings)?;
    let staged = Staged::new(scene, &emitter, &surfaces, settings.purpose);
    Ok((staged.lights, staged.cameras))
}

/// Chooses where points are placed from, and for which views: the given viewpoints, or the cameras that see surfaces,
/// or a search of the scene.
///
/// # Errors
/// [`BakeError::NoViewpoint`].
pub fn choose_emitter<S: Surfaces + ?Sized>(
    scene: &Scene,
    surfaces: &S,
    settings: &BakeSettings,
) -> Result<ParticleEmitter, BakeError> {
    let local = |world: [f64; 3]| (DVec3::from(world) - DVec3::from(scene.origin)).as_vec3();
    let seed = settings.place.seed;
    // What faces only the sky is lit by its points.
    let emitter = |views, found| ParticleEmitter { views, faces_sky: settings.sources.sky, ..found };
    if settings.purpose == Purpose::Environment {
        let around = emitter(Vec::new(), ParticleEmitter { is_open: true, ..ParticleEmitter::default() });
        let sees_any = !Candidates::new(surfaces, &around, seed).batch().is_empty();
        return sees_any.then_some(around).ok_or(BakeError::NoSky);
    }
    if !settings.viewpoints.is_empty() {
        let viewpoints: Vec<Vec3> = settings.viewpoints.iter().copied().map(local).collect();
        let views = viewpoints.iter().copied().map(View::around).collect();
        return Ok(emitter(views, ParticleEmitter::at(surfaces, viewpoints, seed)));
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
        return Ok(emitter(views, ParticleEmitter::at(surfaces, viewpoints, seed)));
    }
    let lamps: Vec<Vec3> = scene.lights.iter().filter_map(Light::position).map(local).collect();
    let found = ParticleEmitter::find(surfaces, &lamps, seed).ok_or(BakeError::NoViewpoint)?;
    Ok(emitter(views, found))
}
