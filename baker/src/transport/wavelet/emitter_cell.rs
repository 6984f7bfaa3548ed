//! Cells of emitters, with quadrature points.

use super::basis::{Basis, Coefficients};
use super::cell::Cell;
use super::form_factor::form_factor;
use super::node_bounds::{Facing, NodeBounds};
use super::patch::{PatchPoint, PlacedPatch};
use glam::{DVec2, DVec3};
use rebounce_cad::trim::Coverage;
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Quadrature points of a cell. Four points on the axes of a square, exact for cubic polynomials (Stroud
/// 1971, C₂: 3-1), of equal weights: none of them is a Gauss point of a receiver, where a patch shoots to
/// itself.
pub(super) const POINTS: usize = 4;

/// Cells of planes nearer than this many of their radii are not met by quadrature.
const NEAR: f64 = 2.0;

/// A cell of an emitter, or several patches of it. Quarters of a cell are made when the first receiver needs
/// them; they do not depend on which that is.
pub(super) struct EmitterCell {
    /// Index of the patch; `None` for several.
    pub(super) member: Option<usize>,
    pub(super) cell: Cell,
    pub(super) is_plain: bool,
    /// QuadtreeNode of the unshot radiosity.
    pub(super) node: Option<usize>,
    /// Of the radiosity.
    pub(super) coefficients: Coefficients,
    points: [QuadraturePoint; POINTS],
    /// Corners, of a cell of a plane: in order around it.
    corners: Option<[DVec3; 4]>,
    /// Area that a quadrature point stands for in the mean over the square, real and virtual.
    quarter_area: f64,
    /// Ball around the cell, about: centre and radius.
    pub ball: (DVec3, f64),
    /// Bounds of positions and normals.
    pub bounds: NodeBounds,
    pub(super) children: OnceLock<Vec<EmitterCell>>,
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

impl EmitterCell {
    /// A cell of a patch, with this radiosity.
    pub(super) fn new(
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
        let planar = |corners: &[DVec3; 4]| NodeBounds::planar(corners, points[0].at.normal);
        let bounds = corners.as_ref().map_or(NodeBounds::ball(ball), planar);
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
            bounds,
            children,
        }
    }

    /// Several, with points that stand for each.
    pub(super) fn several(
        points: [QuadraturePoint; POINTS],
        ball: (DVec3, f64),
        bounds: NodeBounds,
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
            bounds,
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

    /// Whether all quadrature points may face away from a point, or lie below its horizon, where the rest of the cell does
    /// not: for several patches unless `is_whole`, for a curved patch inside its ball. Planes have Lambert's formula.
    pub(super) fn may_hide_between_points(&self, position: DVec3, is_whole: bool) -> bool {
        match (self.member, &self.corners) {
            (None, _) => !is_whole,
            (Some(_), None) => self.distance_from_ball(position) <= 0.0,
            (Some(_), Some(_)) => false,
        }
    }

    /// The greatest radiosity of its quadrature points.
    pub(super) fn radiosity(&self) -> f64 {
        self.points().map(|point| point.radiosity.abs().max_element()).fold(0.0, f64::max)
    }

    /// Distance of a point from its ball; 0 inside.
    pub(super) fn distance_from_ball(&self, position: DVec3) -> f64 {
        let (centre, radius) = self.ball;
        (position.distance(centre) - radius).max(0.0)
    }

    /// Upper bound of the irradiance of a point, and whether the whole cell faces the point above its horizon. `None` if no
    /// part of the cell does.
    pub(super) fn bound(&self, receiver: &PatchPoint) -> Option<(f64, bool)> {
        let Facing::Maybe { most, is_everywhere } = self.bounds.facing(receiver) else { return None };
        let position = receiver.position;
        let distance = self.bounds.distance(position).max(self.distance_from_ball(position));
        Some((most * self.bound_at(distance), is_everywhere))
    }

    /// Upper bound of the irradiance at a distance: all power at this distance, both cosines 1.
    pub(super) fn bound_at(&self, distance: f64) -> f64 {
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
