//! Patches that shoot: their radiosity in cells with quadrature points, divided as deep as receivers need.

use super::basis::{Basis, Coefficients};
use super::cell::Cell;
use super::clusters::place_of;
use super::form_factor::form_factor;
use super::light_tree;
use super::patch::{PatchPoint, PlacedPatch};
use super::tree::UnshotTree;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use rebounce_cad::trim::Coverage;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Quadrature points of a cell. Four points on the axes of a square, exact for cubic polynomials (Stroud
/// 1971, C₂: 3-1), of equal weights: none of them is a Gauss point of a receiver, where a patch shoots to
/// itself.
pub(super) const POINTS: usize = 4;

/// Cells of planes nearer than this many of their radii are not met by quadrature.
const NEAR: f64 = 2.0;

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

/// A cell of an emitter, or several patches of it. Quarters of a cell are made when the first receiver needs
/// them; they do not depend on which that is.
pub(super) struct EmitterCell {
    /// Index of the patch; `None` for several.
    member: Option<usize>,
    cell: Cell,
    is_plain: bool,
    /// QuadtreeNode of the unshot radiosity.
    node: Option<usize>,
    /// Of the radiosity.
    coefficients: Coefficients,
    points: [QuadraturePoint; POINTS],
    /// Corners, of a cell of a plane: in order around it.
    corners: Option<[DVec3; 4]>,
    /// Area that a quadrature point stands for in the mean over the square, real and virtual.
    quarter_area: f64,
    /// Ball around the cell, about: centre and radius.
    pub ball: (DVec3, f64),
    children: OnceLock<Vec<EmitterCell>>,
}

/// A quadrature point.
#[derive(Clone, Copy, Debug)]
pub(super) struct QuadraturePoint {
    pub at: PatchPoint,
    /// Area of the real part of what it stands for.
    pub area: f64,
    /// Linear RGB.
    pub radiosity: DVec3,
}

impl QuadraturePoint {
    /// Irradiance of a point, if nothing is in between: B cos θ cos θ′ A / (π r²).
    ///
    /// `is_last`: the cell is not divided further; the area is taken for a disk, A / (π r² + A), which is at
    /// most 1.
    pub(super) fn irradiance(&self, receiver: &PatchPoint, is_last: bool) -> DVec3 {
        let between = self.at.position - receiver.position;
        let square = between.length_squared();
        let cosines = between.dot(receiver.normal).max(0.0) * (-between.dot(self.at.normal)).max(0.0);
        if cosines <= 0.0 || square <= 0.0 {
            return DVec3::ZERO;
        }
        let disk = if is_last { self.area } else { 0.0 };
        self.radiosity * (cosines / square * self.area / (PI * square + disk))
    }
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
        let most = self.root.bound(self.ball.0 + nearest * between.normalize_or_zero());
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

impl EmitterCell {
    fn new(
        patch: &PlacedPatch,
        basis: &Basis,
        (member, cell): (usize, Cell),
        coverage: Coverage,
        node: Option<usize>,
        coefficients: Coefficients,
    ) -> Self {
        let is_plain = coverage == Coverage::Plain;
        let area = patch.area * cell.area() / POINTS as f64;
        let offset = 0.5 * (2.0_f64 / 3.0).sqrt();
        let points = [0, 1, 2, 3].map(|i| {
            let (local, share) = if is_plain {
                let direction = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y][i];
                (DVec2::splat(0.5) + offset * direction, 1.0)
            } else {
                // Weights are the real parts of the areas of quarters, as in 4.2; points are not their
                // middles, which may be behind another surface, but the centroids of those parts.
                let (share, centroid) = patch.mesh.real_part(cell.child(i).corners());
                (cell.local(centroid), share)
            };
            let is_surely_real = is_plain || share <= 0.0;
            let st = cell.at(local);
            let at = if is_surely_real { patch.point(st) } else { patch.point_with_nearest(st, cell.side()) };
            let area = share * patch.mesh.density(st) * area;
            QuadraturePoint { at, area, radiosity: basis.evaluate(&coefficients, local) }
        });
        let centre = points.iter().map(|point| point.at.position).sum::<DVec3>() / POINTS as f64;
        let reach = points.iter().map(|point| point.at.position.distance(centre)).fold(0.0, f64::max);
        let ball = (centre, if is_plain { 2.0 } else { 2.5 } * reach);
        let corner = |x: f64, y: f64| patch.point(cell.at(DVec2::new(x, y))).position;
        let around = || [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
        let corners = patch.mesh.is_planar().then(around);
        let children = OnceLock::new();
        let member = Some(member);
        Self {
            member,
            cell,
            is_plain,
            node,
            coefficients,
            points,
            corners,
            quarter_area: area,
            ball,
            children,
        }
    }

    /// Several, with points that stand for each.
    pub(super) fn several(
        points: [QuadraturePoint; POINTS],
        ball: (DVec3, f64),
        children: Vec<EmitterCell>,
    ) -> Self {
        Self {
            member: None,
            cell: Cell::ROOT,
            is_plain: false,
            node: None,
            coefficients: Coefficients::default(),
            points,
            corners: None,
            quarter_area: 0.0,
            ball,
            children: OnceLock::from(children),
        }
    }

    /// Index of the patch; `None` for several.
    pub(super) fn member(&self) -> Option<usize> {
        self.member
    }

    /// A quadrature point, perhaps without area.
    pub(super) fn any_point(&self) -> QuadraturePoint {
        self.points[0]
    }

    /// Quadrature points with an area.
    pub(super) fn points(&self) -> impl Iterator<Item = &QuadraturePoint> {
        self.points.iter().filter(|point| point.area > 0.0)
    }

    /// Whether a point is so near that quadrature points may all face away from it, or lie below its horizon,
    /// where others do not. Planes have Lambert's formula there.
    pub(super) fn may_hide_between_points(&self, position: DVec3) -> bool {
        let (centre, radius) = self.ball;
        self.corners.is_none() && position.distance_squared(centre) < radius * radius
    }

    /// The greatest radiosity of its quadrature points.
    pub(super) fn radiosity(&self) -> f64 {
        self.points().map(|point| point.radiosity.abs().max_element()).fold(0.0, f64::max)
    }

    /// The most irradiance it can give to any point at this distance from its centre: of what is nearest,
    /// facing it.
    pub(super) fn bound(&self, position: DVec3) -> f64 {
        let (centre, radius) = self.ball;
        let distance = (position.distance(centre) - radius).max(0.0);
        let power: f64 = self.points().map(|point| point.area * point.radiosity.abs().max_element()).sum();
        power / (PI * distance * distance)
    }

    /// Irradiance of a point, if nothing is in between: by quadrature; of a near cell of a plane by Lambert's
    /// formula.
    pub(super) fn irradiance(&self, receiver: &PatchPoint, is_last: bool) -> DVec3 {
        let (centre, radius) = self.ball;
        match &self.corners {
            Some(corners) if receiver.position.distance(centre) < NEAR * radius => {
                self.near_irradiance(corners, receiver)
            }
            _ => self.points().map(|point| point.irradiance(receiver, is_last)).sum(),
        }
    }

    fn near_irradiance(&self, corners: &[DVec3; 4], receiver: &PatchPoint) -> DVec3 {
        let towards = (receiver.position - corners[0]).dot(self.points[0].at.normal);
        if towards <= 0.0 {
            return DVec3::ZERO;
        }
        if self.is_plain {
            return form_factor(corners, receiver) * self.coefficients[0];
        }
        // The real part of a quarter is taken for a smaller quarter about its centroid.
        let [a, b, _, d] = *corners;
        let of_point = |point: &QuadraturePoint| {
            let scale = 0.25 * (point.area / self.quarter_area).sqrt();
            let [s, t] = [scale * (b - a), scale * (d - a)];
            let corners = [-s - t, s - t, s + t, t - s].map(|corner| point.at.position + corner);
            form_factor(&corners, receiver) * point.radiosity
        };
        self.points().map(of_point).sum()
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
