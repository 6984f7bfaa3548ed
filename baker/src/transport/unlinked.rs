//! Solver of a file without links: what light finds is computed by [radiosity](rebounce_shared::radiosity) when the file is
//! shown, so that things may move.

use super::direct_to_indirect::colours;
use super::{Operator, Partial, Problem, Solver};
use crate::geometry::Surfaces;
use crate::job::Job;
use crate::job::communicator::CommunicatorError;
use crate::job::stage::Stage;
use sha2::{Digest, Sha256};

/// Reads the colours of the points' surfaces, and computes no transport.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unlinked;

impl<S: Surfaces + ?Sized> Solver<S> for Unlinked {
    type Solution = Operator;

    async fn solve(
        &self,
        problem: &Problem<'_, S>,
        job: &Job<'_>,
        _: &mut Partial<'_, Operator>,
    ) -> Result<Operator, CommunicatorError> {
        let watch = job.reporter.begin(Stage::Tints, None);
        let (tints, reflectance) = colours(problem, &*watch)?;
        job.agree(&Sha256::digest(bytemuck::cast_slice(&tints)), &*watch).await?;
        Ok(Operator { tints, reflectance, ..Operator::without_links(problem.points.points.len()) })
    }
}
