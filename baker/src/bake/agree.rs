//! Whether all members of a team work on the same points of the same scene. They place them by themselves: the first
//! one takes as long for it as all do, so nobody waits, and nothing is sent.

use super::{BakeError, BakeSettings, Identity};
use crate::communicator::Communicator;
use crate::sampling::Points;
use crate::scene::Scene;
use crate::watch::Watch;
use sha2::{Digest, Sha256};

/// Compares what all members have, before they rely on it.
///
/// # Errors
/// [`BakeError::Apart`] names the first member that has something else than member 0.
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
