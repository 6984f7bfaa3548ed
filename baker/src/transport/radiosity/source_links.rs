//! Links from the sky and from emissive surfaces, for the direct light of a solution.

use super::direct::GroupSource;
use crate::geometry::Surfaces;
use crate::job::Job;
use crate::job::communicator::CommunicatorError;
use crate::job::stage::Stage;
use crate::transport::Problem;
use crate::transport::sources::{SourceGather, SourceLinks, SourceSettings};
use rebounce_shared::rbn::sources::EmissiveGroup;

/// Links from the sky and from emissive surfaces, if a group has light from them.
///
/// # Errors
/// [`CommunicatorError`] if the job is stopped.
pub async fn source_links<S: Surfaces + ?Sized>(
    groups: &[GroupSource],
    settings: &SourceSettings,
    emissive_groups: &[EmissiveGroup],
    problem: &Problem<'_, S>,
    job: &Job<'_>,
) -> Result<SourceLinks, CommunicatorError> {
    if !groups.iter().any(|group| group.has_links) {
        return Ok(SourceLinks::default());
    }
    let watch = job.reporter.begin(Stage::Sources, None);
    let sky = groups.iter().any(|group| group.lighting.sky.is_some());
    let settings = SourceSettings { sky: sky && settings.sky, ..settings.clone() };
    let Problem { surfaces, points, relations, .. } = *problem;
    SourceGather::new(surfaces, points, relations, &settings, emissive_groups.to_vec())
        .links(job, &*watch)
        .await
}
