//! Patches that shoot: their radiosity in cells with quadrature points, divided as deep as receivers need.

use super::basis::{Basis, Coefficients};
use super::cell::Cell;
use super::clusters::place_of;
use super::emitter_cell::EmitterCell;
use super::light_tree;
use super::patch::PlacedPatch;
use super::tree::UnshotTree;
use glam::DVec3;
use rayon::prelude::*;
use rebounce_cad::trim::Coverage;

/// How much irradiance varies at most: the cosines and the square of the distance together, over a part of
/// the distance.
const VARIATION: f64 = 4.0;

/// Radiosity of a shot.
pub(super) enum Radiosity {
    /// The same everywhere: its own light.
    Constant(DVec3),
    /// Irradiance, reflected with this albedo.
    Reflected {
        /// Linear RGB.
        albedo: DVec3,
        /// Irradiance.
        unshot: UnshotTree,
    },
}

/// A patch that shoots.
pub(super) struct ShootingPatch<'a> {
    pub patch: &'a PlacedPatch<'a>,
    pub radiosity: Radiosity,
}

/// The patches that shoot together.
pub(super) struct Emitter<'a> {
    members: Vec<ShootingPatch<'a>>,
    basis: &'a Basis,
    deepest: u32,
    root: EmitterCell,
    /// Ball around all points.
    pub ball: (DVec3, f64),
}

impl<'a> Emitter<'a> {
    /// `seed` chooses what stands for several patches.
    pub(super) fn new(members: Vec<ShootingPatch<'a>>, basis: &'a Basis, deepest: u32, seed: u64) -> Self {
        let cell = |(index, member): (usize, &ShootingPatch)| {
            let coverage = member.patch.mesh.coverage(Cell::ROOT.corners());
            let of_root = match &member.radiosity {
                Radiosity::Constant(value) => constant(*value),
                Radiosity::Reflected { albedo, unshot } => scaled(unshot.coefficients(0), *albedo),
            };
            EmitterCell::new(member.patch, basis, (index, Cell::ROOT), coverage, Some(0), of_root)
        };
        let cells: Vec<EmitterCell> = members.par_iter().enumerate().map(cell).collect();
        let ball = light_tree::ball(members.iter().map(|member| member.patch.ball));
        let place = |index: usize| place_of(members[index].patch, ball.1);
        let root = light_tree::joined(cells, &place, seed);
        Self { members, basis, deepest, root, ball }
    }

    pub(super) fn root(&self) -> &EmitterCell {
        &self.root
    }

    /// Whether all points of a ball are behind it: nothing of it gets there.
    pub(super) fn is_behind(&self, ball: (DVec3, f64)) -> bool {
        matches!(self.members.as_slice(), [one] if one.patch.is_behind(ball))
    }

    /// The most irradiance that a patch can get of it; and the most that it can vary over a plane, if all or
    /// nothing of it is visible: by 4 / d of itself over a length, where d is the distance.
    pub(super) fn reach(&self, patch: &PlacedPatch) -> [f64; 2] {
        let (centre, radius) = patch.ball;
        let between = centre - self.ball.0;
        let nearest = (between.length() - radius).max(0.0);
        let at = self.ball.0 + nearest * between.normalize_or_zero();
        let most = self.root.bound_at(self.root.distance_from_ball(at));
        let distance = (nearest - self.ball.1).max(0.0);
        let share = if patch.mesh.is_planar() { (VARIATION * radius / distance).min(1.0) } else { 1.0 };
        // Nothing is far enough from itself.
        [most, if share < 1.0 { share * most } else { f64::INFINITY }]
    }

    /// Whether a cell is not divided.
    pub(super) fn is_last(&self, cell: &EmitterCell) -> bool {
        cell.member.is_some() && cell.cell.level >= self.deepest
    }

    /// The quarters of a cell that are not empty, or parts of several patches.
    pub(super) fn children<'c>(&self, parent: &'c EmitterCell) -> &'c [EmitterCell] {
        parent.children.get_or_init(|| {
            let Some(index) = parent.member else { return Vec::new() };
            let ShootingPatch { patch, radiosity } = &self.members[index];
            let quarter = |quadrant: usize| {
                let cell = parent.cell.child(quadrant);
                let coverage =
                    if parent.is_plain { Coverage::Plain } else { patch.mesh.coverage(cell.corners()) };
                if coverage == Coverage::Empty {
                    return None;
                }
                let (node, coefficients) = match (radiosity, parent.node) {
                    (Radiosity::Reflected { albedo, unshot }, Some(node)) => match unshot.children(node) {
                        Some(first) => {
                            let node = first + quadrant;
                            (Some(node), scaled(unshot.coefficients(node), *albedo))
                        }
                        None => (None, self.basis.push(&parent.coefficients, quadrant)),
                    },
                    _ => (None, self.basis.push(&parent.coefficients, quadrant)),
                };
                Some(EmitterCell::new(patch, self.basis, (index, cell), coverage, node, coefficients))
            };
            (0..4).filter_map(quarter).collect()
        })
    }
}

/// Coefficients of a constant.
fn constant(value: DVec3) -> Coefficients {
    let mut coefficients = Coefficients::default();
    coefficients[0] = value;
    coefficients
}

fn scaled(coefficients: &Coefficients, factor: DVec3) -> Coefficients {
    coefficients.map(|c| factor * c)
}
