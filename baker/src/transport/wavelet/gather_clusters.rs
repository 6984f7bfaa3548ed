//! Clusters of gather points: small patches with one representative receiver.
//!
//! Walter, Arbree, Bala, Greenberg: Multidimensional Lightcuts (2006), section 3. Clusters here have at most half the
//! area of the least cells and a narrow range of normals: one representative suffices at all distances.

use super::clusters::{halves, place_of};
use super::patch::{PatchPoint, PlacedPatch};
use glam::DVec3;

/// Greatest area of a cluster, part of the least area of divided cells, whose quarters have 1/4 of it.
const CLUSTER_AREA: f64 = 0.5;
/// Greatest distance from the representative, part of the side of a square of the least area.
const REACH: f64 = 0.5;
/// Greatest difference of unit normals.
const TURN: f64 = 0.1;
/// Lift of rays between middles, part of the distance: the surface bulges in between by TURN / 4 of it at most.
const LIFT: f64 = 0.5 * TURN;

/// By patch, the index of its representative, at whose middle irradiance is evaluated. Patches of `least_area` or more
/// represent themselves.
///
/// `sees`: visibility between two points.
pub(super) fn representatives(
    patches: &[PlacedPatch],
    least_area: f64,
    sees: &impl Fn(DVec3, DVec3) -> bool,
) -> Vec<usize> {
    let mut out: Vec<usize> = (0..patches.len()).collect();
    let mut small: Vec<usize> = (0..patches.len()).filter(|&i| patches[i].real_area < least_area).collect();
    let reach = REACH * least_area.sqrt();
    let clustering = Clustering { patches, most: CLUSTER_AREA * least_area, reach, sees };
    clustering.divide(&mut small, &mut out);
    out
}

struct Clustering<'a, Sees> {
    patches: &'a [PlacedPatch<'a>],
    /// Area of a cluster.
    most: f64,
    /// From the representative.
    reach: f64,
    sees: &'a Sees,
}

impl<Sees: Fn(DVec3, DVec3) -> bool> Clustering<'_, Sees> {
    /// Halves the members until one of them can stand for the others.
    fn divide(&self, members: &mut [usize], out: &mut [usize]) {
        if members.len() < 2 {
            return;
        }
        if self.area(members) <= self.most {
            let representative = self.nearest_to_mean(members);
            if members.iter().all(|&member| self.is_like(representative, member)) {
                for member in members {
                    out[*member] = representative;
                }
                return;
            }
        }
        let scale = self.reach / TURN;
        for half in halves(members, |&member| place_of(&self.patches[member], scale)) {
            self.divide(half, out);
        }
    }

    fn area(&self, members: &[usize]) -> f64 {
        members.iter().map(|&member| self.patches[member].real_area).sum()
    }

    fn middle(&self, patch: usize) -> &PatchPoint {
        &self.patches[patch].middle
    }

    /// The member whose middle is nearest to the mean of all middles.
    fn nearest_to_mean(&self, members: &[usize]) -> usize {
        let sum: DVec3 = members.iter().map(|&member| self.middle(member).position).sum();
        let mean = sum / members.len() as f64;
        let square = |member: usize| self.middle(member).position.distance_squared(mean);
        let nearer = |best: usize, &member: &usize| if square(member) < square(best) { member } else { best };
        members.iter().fold(members[0], nearer)
    }

    /// Whether two patches are near, with similar normals, and visible to each other.
    fn is_like(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|patch| self.middle(patch));
        let distance = a.position.distance(b.position);
        let is_near = distance <= self.reach && a.normal.distance(b.normal) <= TURN;
        let lifted = |point: &PatchPoint| point.position + LIFT * distance * point.normal;
        is_near && (distance == 0.0 || (self.sees)(lifted(a), lifted(b)))
    }
}
