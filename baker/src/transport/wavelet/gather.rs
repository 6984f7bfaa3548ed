//! Irradiance of a point from an emitter: adaptive quadrature over its cells, with visibility.

use super::emitter::Emitter;
use super::emitter_cell::EmitterCell;
use super::patch::PatchPoint;
use super::settings::Tolerance;
use crate::geometry::Surfaces;
use glam::{DVec3, Vec3};
use std::sync::atomic::{AtomicU64, Ordering};

/// Part of the tolerance of receivers that the quadrature over emitters has: its errors must not look like
/// light that varies.
const QUADRATURE_SHARE: f64 = 0.25;
/// Irradiance that visibility of four quadrature points decides about at once, tolerances at most: more is
/// divided, so that there are more rays where more light comes from.
const MOST_AT_ONCE: f64 = 16.0;
/// The same of a cell that is partly visible, or may partly face away: errors of many such cells, an eighth of their
/// irradiance, add up like independent ones.
const MOST_IN_PART: f64 = 4.0;

/// Nodes of several patches are opened for an estimate of brightness if their bound is above this share of the radiosity.
const BRIGHTNESS_SHARE: f64 = 1.0 / 16.0;

/// Estimate of the irradiance of a point, if nothing is in between, on the cut of the tree whose nodes have bounds below `most`.
fn brightness(cell: &EmitterCell, receiver: &PatchPoint, most: f64) -> f64 {
    match cell.bound(receiver) {
        None => 0.0,
        Some((bound, _)) if bound > most && cell.member().is_none() => {
            cell.children.get().map_or(0.0, |all| all.iter().map(|it| brightness(it, receiver, most)).sum())
        }
        Some(_) => cell.irradiance(receiver, false).abs().max_element(),
    }
}

/// PatchVisibility among a scene's surfaces.
pub(super) struct PatchVisibility<'a, S> {
    surfaces: &'a S,
    rays: AtomicU64,
}

impl<'a, S: Surfaces> PatchVisibility<'a, S> {
    pub(super) fn new(surfaces: &'a S) -> Self {
        Self { surfaces, rays: AtomicU64::new(0) }
    }

    /// Rays cast so far.
    pub(super) fn rays(&self) -> u64 {
        self.rays.load(Ordering::Relaxed)
    }

    /// Whether nothing is between two points, not even glass.
    pub(super) fn is_clear(&self, a: DVec3, b: DVec3) -> bool {
        self.rays.fetch_add(1, Ordering::Relaxed);
        self.surfaces.transmittance(a.as_vec3(), b.as_vec3()) == Vec3::ONE
    }

    /// Transmittance between the nearest real points of two points, each a safe offset above its surface.
    fn between(&self, a: &PatchPoint, b: &PatchPoint) -> DVec3 {
        self.transmittance([(a.seen_from, a.seen_normal), (b.seen_from, b.seen_normal)])
    }

    fn transmittance(&self, ends: [(DVec3, DVec3); 2]) -> DVec3 {
        self.rays.fetch_add(1, Ordering::Relaxed);
        let [from, to] = ends.map(|(position, normal)| {
            let position = position.as_vec3();
            position + self.surfaces.epsilon_at(position) * normal.as_vec3()
        });
        self.surfaces.transmittance(from, to).as_dvec3()
    }

    /// Where a virtual point receives: at the nearest real point, if another surface lies between the two, as
    /// where the surface goes on behind a wall. There Alonso et al. 2001, 4.1, extend radiosity with a jump
    /// at the boundary, since the point is on the other side of what shines on the real one.
    pub(super) fn moved_before_walls(&self, point: PatchPoint) -> PatchPoint {
        let PatchPoint { position, normal, seen_from, seen_normal } = point;
        if position != seen_from {
            let transmittance = self.transmittance([(seen_from, seen_normal), (position, normal)]);
            if transmittance.min_element() < 1.0 {
                return PatchPoint { position: seen_from, normal: seen_normal, ..point };
            }
        }
        point
    }

    /// Irradiance of a point from an emitter, with an error of about the tolerance.
    ///
    /// A cell whose quadrature differs from that of its quarters by more than the tolerance is divided; else
    /// the latter is taken, whose error is a fraction of the difference. So is one that gives much light, is
    /// visible in part, is all around, or may face away in part.
    pub(super) fn irradiance(
        &self,
        emitter: &Emitter,
        receiver: &PatchPoint,
        tolerance: &Tolerance,
    ) -> DVec3 {
        let root = emitter.root();
        let unoccluded = root.irradiance(receiver, emitter.is_last(root));
        let radiosity = root.radiosity();
        let brightness = match root.member() {
            Some(_) => unoccluded.abs().max_element(),
            None => brightness(root, receiver, BRIGHTNESS_SHARE * radiosity),
        };
        // No more than its radiosity, also where a point that stands for many is near.
        let tolerance = QUADRATURE_SHARE * tolerance.at(brightness.min(radiosity));
        self.of_cell(emitter, root, unoccluded, receiver, tolerance)
    }

    fn of_cell(
        &self,
        emitter: &Emitter,
        cell: &EmitterCell,
        unoccluded: DVec3,
        receiver: &PatchPoint,
        tolerance: f64,
    ) -> DVec3 {
        let Some((bound, faces_everywhere)) = cell.bound(receiver) else { return DVec3::ZERO };
        if emitter.is_last(cell) || bound <= tolerance {
            return self.with_visibility(cell, receiver, unoccluded, emitter.is_last(cell)).0;
        }
        let children = emitter.children(cell);
        let mut fine = [DVec3::ZERO; 4];
        for (sum, child) in fine.iter_mut().zip(children) {
            *sum = child.irradiance(receiver, emitter.is_last(child));
        }
        let sum: DVec3 = fine.iter().sum();
        let size = sum.abs().max_element();
        let is_whole = faces_everywhere || bound <= MOST_IN_PART * tolerance;
        let is_settled = (sum - unoccluded).abs().max_element() <= tolerance
            && !cell.may_hide_between_points(receiver.position, is_whole);
        if is_settled && size <= MOST_AT_ONCE * tolerance {
            let (result, is_partial) = self.with_visibility(cell, receiver, sum, false);
            if !is_partial || size <= MOST_IN_PART * tolerance {
                return result;
            }
        }
        let quarters = children.iter().zip(fine);
        quarters.map(|(child, fine)| self.of_cell(emitter, child, fine, receiver, tolerance)).sum()
    }

    /// The irradiance `unoccluded` times the transmittance to the quadrature points, and whether that differs
    /// among them.
    fn with_visibility(
        &self,
        cell: &EmitterCell,
        receiver: &PatchPoint,
        unoccluded: DVec3,
        is_last: bool,
    ) -> (DVec3, bool) {
        let [mut sum, mut seen] = [DVec3::ZERO; 2];
        let mut first = None;
        let mut is_partial = false;
        for point in cell.points() {
            let here = point.irradiance(receiver, is_last);
            if here != DVec3::ZERO {
                let transmittance = self.between(receiver, &point.at);
                is_partial |= *first.get_or_insert(transmittance) != transmittance;
                sum += here;
                seen += transmittance * here;
            }
        }
        let Some(first) = first else { return (DVec3::ZERO, unoccluded != DVec3::ZERO) };
        if !is_partial {
            return (first * unoccluded, false);
        }
        // Parts of all that is unoccluded; of a channel without light, none.
        let part = DVec3::select(sum.cmpne(DVec3::ZERO), seen / sum, DVec3::ZERO);
        (part.clamp(DVec3::ZERO, DVec3::ONE) * unoccluded, true)
    }
}
