//! Equal-area maps between the parameters of a surface and a plane.

use super::antiderivative::{Antiderivative, Form};
use super::cumulative::Cumulative;
use super::marginal::Marginal;
use super::revolved;
use crate::curve::Curve;
use crate::surface::Surface;
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;

/// Of unit vectors that are taken for parallel.
const ROUNDING: f64 = 1e-12;

/// Ψ⁻¹ of Alonso et al. 2001, 3.1, as a map of parameters (u, v) to a plane (x, y) in which areas are those
/// on the surface: its Jacobian with the area element |σᵤ × σᵥ| is 1.
#[derive(Clone, Debug)]
pub(super) enum EqualArea {
    /// Planes: (x, y) = (u, v).
    Identity,
    /// The area element is a product f(u) g(v): x = ∫ f du, y = ∫ g dv.
    Separable([Antiderivative; 2]),
    /// Any other.
    Marginal(Box<Marginal>),
    /// For comparison, (x, y) = (u, v) of a surface whose area element is not constant: areas are not kept.
    /// Has the least and greatest parameters that matter.
    Natural([DVec2; 2]),
}

impl EqualArea {
    /// The map of a surface. `domain` has the least and greatest parameters that matter: beyond it, and
    /// beyond poles and apices, parameters may be clamped.
    pub(super) fn new(surface: &Surface, domain: [DVec2; 2]) -> Self {
        let [low, high] = domain;
        let range = [low.y, high.y];
        let middle = 0.5 * (low.y + high.y);
        let turn = Antiderivative::constant(1.0);
        let along_axis = match surface {
            Surface::Plane(_) => return Self::Identity,
            Surface::Cylinder { radius, .. } => Antiderivative::constant(*radius),
            Surface::Cone { radius, half_angle, .. } => {
                let slope = half_angle.tangent();
                revolved::line(*radius, slope, 1f64.hypotenuse(slope), middle)
            }
            Surface::Sphere { radius, .. } => revolved::spheroid(*radius, *radius, 0.0, middle),
            Surface::Torus { major, minor, .. } => revolved::torus(*major, *minor, 0.0, middle),
            Surface::Revolution { frame, profile } => revolved::closed_form(frame, profile, range)
                .unwrap_or_else(|| table(profile, range, |v| area_element(surface, DVec2::new(low.x, v)))),
            Surface::Extrusion { profile, along } => {
                let [from, to] = [low.x, high.x];
                return Self::Separable([extruded(surface, profile, *along, [from, to]), turn]);
            }
            Surface::Nurbs(nurbs) => {
                let breaks = [0, 1].map(|direction| {
                    let [from, to] = [low[direction], high[direction]];
                    let degree = nurbs.degrees[direction];
                    let knots = &nurbs.knots[direction][degree..=nurbs.counts[direction]];
                    let within = knots.iter().copied().filter(|&knot| from < knot && knot < to);
                    let mut breaks: Vec<f64> = std::iter::once(from).chain(within).chain([to]).collect();
                    breaks.dedup();
                    breaks
                });
                return Self::Marginal(Box::new(Marginal::new(breaks, |at| area_element(surface, at))));
            }
        };
        if along_axis.holds(range) {
            return Self::Separable([turn, along_axis]);
        }
        // Across an apex or a pole.
        let ends = [range[0], middle, range[1]];
        let table = Cumulative::new(&ends, |v| area_element(surface, DVec2::new(low.x, v)));
        Self::Separable([turn, Antiderivative::new(Form::Table(table), range)])
    }

    /// The natural parameters of a surface in place of its map; the map itself if that is affine.
    pub(super) fn natural(surface: &Surface, domain: [DVec2; 2]) -> Self {
        match Self::new(surface, domain) {
            Self::Identity => Self::Identity,
            Self::Separable(both) if both.iter().all(Antiderivative::is_linear) => Self::Separable(both),
            _ => Self::Natural(domain),
        }
    }

    /// Whether areas in the plane are in proportion to those on the surface.
    pub(super) fn keeps_areas(&self) -> bool {
        !matches!(self, Self::Natural(_))
    }

    /// From (u, v) to (x, y).
    pub(super) fn flat(&self, at: DVec2) -> DVec2 {
        match self {
            Self::Identity | Self::Natural(_) => at,
            Self::Separable([u, v]) => DVec2::new(u.value(at.x), v.value(at.y)),
            Self::Marginal(marginal) => marginal.flat(at),
        }
    }

    /// From (x, y) to (u, v); of points beyond the image of the domain, the parameters at its border.
    pub(super) fn parameters(&self, flat: DVec2) -> DVec2 {
        match self {
            Self::Identity => flat,
            Self::Separable([u, v]) => DVec2::new(u.inverse(flat.x), v.inverse(flat.y)),
            Self::Marginal(marginal) => marginal.parameters(flat),
            Self::Natural([low, high]) => flat.clamp(*low, *high),
        }
    }
}

/// |σᵤ × σᵥ|.
pub(super) fn area_element(surface: &Surface, at: DVec2) -> f64 {
    let [_, along_u, along_v] = surface.derivatives(at);
    along_u.cross(along_v).length()
}

/// A table of a density over a range of a profile's parameters.
fn table(profile: &Curve, range: [f64; 2], density: impl Fn(f64) -> f64) -> Antiderivative {
    Antiderivative::new(Form::Table(Cumulative::new(&profile.pieces(range), density)), range)
}

/// |λ′ × V| of an extrusion: constant for lines, and circles about the direction V.
fn extruded(surface: &Surface, profile: &Curve, along: DVec3, range: [f64; 2]) -> Antiderivative {
    let is_constant = match profile {
        Curve::Line { .. } => true,
        Curve::Circle { frame, .. } => frame.z.cross(along).length() <= ROUNDING * along.length(),
        _ => false,
    };
    let density = |u: f64| area_element(surface, DVec2::new(u, 0.0));
    if is_constant { Antiderivative::constant(density(range[0])) } else { table(profile, range, density) }
}
