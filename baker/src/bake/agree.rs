//! Check that all members of a team work on the same points of the same scene. Every member places all points: sharing
//! the placement would save no time, and placing needs no communication.

use super::{BakeError, BakeSettings, Identity};
use crate::job::communicator::Communicator;
use crate::job::watch::Watch;
use crate::sampling::Points;
use crate::scene::Scene;
use sha2::{Digest, Sha256};

/// Compares digests of scene, settings, points, cuts, samples and tints between members, before use.
///
/// # Errors
/// [`BakeError::Apart`] with the first member whose digest differs from the digest of member 0.
pub(super) fn agree(
    scene: &Scene,
    settings: &BakeSettings,
    points: &Points,
    tints: &[u32],
    team: &dyn Communicator,
    watch: &dyn Watch,
) -> Result<(), BakeError> {
    if team.size() == 1 {
        return Ok(());
    }
    let mut hash = Sha256::new();
    hash.update(Identity::new(scene, settings).to_json());
    for point in &points.points {
        hash.update(bytemuck::bytes_of(&[point.position, point.normal, point.geometric_normal]));
    }
    points.cuts.iter().for_each(|cuts| hash.update(bytemuck::cast_slice(cuts)));
    hash.update(&points.samples);
    hash.update(bytemuck::cast_slice(tints));
    let digest = hash.finalize();
    let received = team.exchange(&[], digest.as_slice(), watch)?;
    match received.to_all.iter().position(|other| *other != received.to_all[0]) {
        Some(member) => Err(BakeError::Apart(member)),
        None => Ok(()),
    }
}
