//! Receiver oracle: which receivers are refined (the report, section 6.3, RECEIVER-ORACLE).
//!
//! On the coarsest level a receiver is refined if a neighbour's irradiance differs by more than ε_E, on finer levels if its
//! own coefficient is larger: a large coefficient means that there is detail around it. A refined receiver's children are
//! gathered for.

use super::direct::GroupField;
use super::gather::brightness;
use crate::basis::{Evaluator, Relations, Support};
use crate::sampling::Points;
use glam::Vec3;
use rayon::prelude::*;

/// Thresholds of each group: ε_E times its mean bounced irradiance.
#[derive(Clone, Debug, PartialEq)]
pub struct ReceiverOracle {
    thresholds: Vec<f32>,
}

impl ReceiverOracle {
    /// Sets the thresholds from the irradiance of the coarsest level's points.
    pub fn new(epsilon_e: f32, irradiance: &GroupField, coarsest: usize) -> Self {
        let threshold = |group: usize| {
            let sum: f32 = irradiance.group(group).take(coarsest).map(brightness).sum();
            epsilon_e * sum / coarsest.max(1) as f32
        };
        Self { thresholds: (0..irradiance.groups).map(threshold).collect() }
    }

    /// Mean bounced irradiance of the coarsest level, by group, times ε_E.
    pub fn thresholds(&self) -> &[f32] {
        &self.thresholds
    }

    fn differs(&self, ours: impl Iterator<Item = Vec3>, others: impl Iterator<Item = Vec3>) -> bool {
        let mut pairs = ours.zip(others).zip(&self.thresholds);
        pairs.any(|((ours, other), threshold)| (brightness(ours) - brightness(other)).abs() > *threshold)
    }

    /// Returns which points of the coarsest level are refined: those with a neighbour, a function that is not 0 at the point,
    /// whose irradiance differs.
    pub fn refined_on_coarsest(&self, points: &Points, irradiance: &GroupField) -> Vec<bool> {
        let Some(level) = points.levels.first() else { return Vec::new() };
        let support = |i: usize| {
            let point = &points.points[i];
            Support {
                position: point.position,
                normal: point.normal,
                radius: level.support_radius * points.scale(point.group),
                cuts: points.cuts_of(i),
                group: point.group,
            }
        };
        let functions = Evaluator::new(level.range().map(support), level.first as u32);
        let is_refined = |i: usize| {
            let (point, mut is_refined) = (&points.points[i], false);
            functions.gather(point.position, point.normal, point.group, |other, _| {
                let other = irradiance.at(other as usize).iter().copied();
                is_refined |= self.differs(irradiance.at(i).iter().copied(), other);
            });
            is_refined
        };
        level.range().into_par_iter().map(is_refined).collect()
    }

    /// Whether a point's coefficient, its irradiance less the mean of its parents, is large in any group.
    pub fn is_refined(&self, relations: &Relations, irradiance: &GroupField, i: usize) -> bool {
        self.differs(irradiance.at(i).iter().copied(), irradiance.predicted(relations, i))
    }
}
