//! The whole bake: from a scene to a file's contents.

mod assemble;
mod preset;
mod report;

pub use preset::{BakeSettings, Preset};
pub use report::{BakeReport, LevelReport, SectionReport};

use crate::basis::relate;
use crate::operator::{bounces::add_later_bounces, refine::refine, reflected::reflected_share};
use crate::points::{PlaceError, candidates::Candidates, cut, footprint, place, viewpoint};
use crate::scene::Scene;
use crate::triangles::TriangleSurfaces;
use glam::{DVec3, Vec3};
use rebounce_shared::link::MAX_SENDERS;
use rebounce_shared::rbn::bulk::MAX_ALL_CUTS;
use rebounce_shared::rbn::{self, RbnError};
use std::time::Instant;

/// Why a bake failed.
#[derive(Debug, thiserror::Error)]
pub enum BakeError {
    /// No triangle.
    #[error("the scene has no triangles to bake")]
    Empty,
    /// No viewpoint was given and none was found.
    #[error(
        "no viewpoint was found from which any surface's reflecting side can be seen: give one inside the scene with --viewpoint x,y,z"
    )]
    NoViewpoint,
    /// Points could not be placed.
    #[error(transparent)]
    Place(#[from] PlaceError),
    /// More planes at walls than a file can hold.
    #[error("supports are cut off by over {MAX_ALL_CUTS} walls: bake with fewer --functions or --levels")]
    TooManyCuts,
    /// The result does not fit the file format.
    #[error(transparent)]
    Format(#[from] RbnError),
}

/// How far a bake is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// What is being done.
    pub stage: Stage,
    /// Units done of this stage.
    pub done: u64,
    /// Units of this stage; 0 where that is not known.
    pub total: u64,
    /// Level of points that it is about, where it is about one.
    pub level: usize,
}

/// A bake's stages, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Building the ray-casting structure, finding a viewpoint.
    Prepare,
    /// Placing points.
    Points,
    /// Finding parents and children.
    Basis,
    /// Computing the one-bounce links.
    Links,
    /// Adding later bounces.
    Bounces,
    /// Putting the file together.
    Assemble,
}

impl Stage {
    /// What a person reads.
    pub fn label(self) -> &'static str {
        match self {
            Stage::Prepare => "preparing",
            Stage::Points => "placing points",
            Stage::Basis => "relating points",
            Stage::Links => "tracing links",
            Stage::Bounces => "adding bounces",
            Stage::Assemble => "assembling",
        }
    }
}

/// Bakes a scene. The same scene and settings give the same result at any thread count.
///
/// # Errors
/// [`BakeError`].
pub fn bake(
    scene: &Scene,
    settings: &BakeSettings,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<(rbn::Scene, BakeReport), BakeError> {
    let mut settings = settings.clone().normalised();
    let tell = |stage, done: usize, total: usize, level| {
        progress(Progress { stage, done: done as u64, total: total as u64, level });
    };
    let mut report = BakeReport::new(scene, &settings);
    let mut clock = Instant::now();
    let mut lap = |report: &mut BakeReport, stage: Stage| {
        report.seconds.push((stage.label().to_owned(), clock.elapsed().as_secs_f64()));
        clock = Instant::now();
    };
    if scene.triangles.is_empty() {
        return Err(BakeError::Empty);
    }
    tell(Stage::Prepare, 0, 0, 0);
    let surfaces = TriangleSurfaces::from_scene(scene);
    let viewpoints = choose_viewpoints(scene, &surfaces, &settings)?;
    let viewpoint = viewpoints[0];
    report.viewpoint = (DVec3::from(scene.origin) + viewpoint.as_dvec3()).to_array();
    lap(&mut report, Stage::Prepare);
    let mut points =
        place(&surfaces, &viewpoints, &settings.place, |level, count| tell(Stage::Points, count, 0, level))?;
    cut(&surfaces, &mut points);
    footprint(&surfaces, &mut points);
    // Links can name so many senders: beyond, the finest levels receive and do not send.
    while points.count_on(settings.operator.sender_levels) > MAX_SENDERS
        && settings.operator.sender_levels > 1
    {
        settings.operator.sender_levels -= 1;
    }
    settings = settings.normalised();
    report.sender_levels = settings.operator.sender_levels as u64;
    lap(&mut report, Stage::Points);
    tell(Stage::Basis, 0, 0, 0);
    let relations = relate(&points, settings.direct_levels)?;
    lap(&mut report, Stage::Basis);
    settings.operator.reflected = reflected_share(&surfaces, &points, settings.operator.seed);
    let mut operator = refine(&surfaces, &points, &relations, &settings.operator, &|level, done, total| {
        tell(Stage::Links, done, total, level);
    });
    lap(&mut report, Stage::Links);
    add_later_bounces(&mut operator, &settings.operator, &|done, total| {
        tell(Stage::Bounces, done, total, 0);
    });
    lap(&mut report, Stage::Bounces);
    tell(Stage::Assemble, 0, 0, 0);
    report.describe(&points, &operator, &settings);
    if points.cuts.iter().map(Vec::len).sum::<usize>() > MAX_ALL_CUTS {
        return Err(BakeError::TooManyCuts);
    }
    let file = assemble::assemble(scene, &settings, viewpoint, points, relations, operator);
    lap(&mut report, Stage::Assemble);
    Ok((file, report))
}

/// The viewpoint given, or the scene's cameras that see something, or those that are found; never
/// empty.
fn choose_viewpoints(
    scene: &Scene,
    surfaces: &TriangleSurfaces,
    settings: &BakeSettings,
) -> Result<Vec<Vec3>, BakeError> {
    let local = |world: [f64; 3]| (DVec3::from(world) - DVec3::from(scene.origin)).as_vec3();
    if let Some(world) = settings.viewpoint {
        return Ok(vec![local(world)]);
    }
    let seed = settings.place.seed;
    let mut viewpoints: Vec<Vec3> = scene.cameras.iter().map(|camera| local(camera.position)).collect();
    viewpoints.retain(|point| Candidates::new(surfaces, &[*point], seed).batch().len() > 1000);
    if viewpoints.is_empty() {
        viewpoints = viewpoint::find(surfaces, seed);
    }
    if viewpoints.is_empty() { Err(BakeError::NoViewpoint) } else { Ok(viewpoints) }
}
