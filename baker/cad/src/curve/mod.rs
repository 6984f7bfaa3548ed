//! Curves in space, with the parametrisations of ISO 10303-42. A plane curve (pcurve) has z = 0.

mod error;
mod flatten;
mod hull;
mod invert;
pub mod nurbs;
#[cfg(test)]
mod tests;
mod to_nurbs;

use crate::frame::Frame;
pub use error::CurveError;
use glam::DVec3;
pub use nurbs::NurbsCurve;
use std::f64::consts::TAU;

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// λ(u) = origin + u direction; `direction` need not have unit length.
    Line {
        /// λ(0).
        origin: DVec3,
        /// λ'.
        direction: DVec3,
    },
    /// λ(u) = C + R (cos u x + sin u y); 2π periodic.
    Circle {
        /// Centre C and plane.
        frame: Frame,
        /// R.
        radius: f64,
    },
    /// λ(u) = C + R₁ cos u x + R₂ sin u y; 2π periodic.
    Ellipse {
        /// Centre C and plane.
        frame: Frame,
        /// R₁, R₂.
        radii: [f64; 2],
    },
    /// λ(u) = C + R₁ cosh u x + R₂ sinh u y.
    Hyperbola {
        /// Centre C and plane.
        frame: Frame,
        /// R₁, R₂.
        radii: [f64; 2],
    },
    /// λ(u) = C + F (u² x + 2 u y).
    Parabola {
        /// Vertex C and plane.
        frame: Frame,
        /// F.
        focal_distance: f64,
    },
    /// A B-spline, rational or not.
    Nurbs(NurbsCurve),
}

impl Curve {
    /// Point and derivative λ, λ' at a parameter.
    pub fn derivatives(&self, u: f64) -> [DVec3; 2] {
        let placed = |frame: &Frame, at: DVec3, along: DVec3| [frame.place(at), frame.turn(along)];
        match self {
            Self::Line { origin, direction } => [*origin + u * *direction, *direction],
            Self::Circle { frame, radius } => {
                let (sine, cosine) = u.sin_cos();
                placed(
                    frame,
                    *radius * DVec3::new(cosine, sine, 0.0),
                    *radius * DVec3::new(-sine, cosine, 0.0),
                )
            }
            Self::Ellipse { frame, radii: [a, b] } => {
                let (sine, cosine) = u.sin_cos();
                placed(frame, DVec3::new(a * cosine, b * sine, 0.0), DVec3::new(-a * sine, b * cosine, 0.0))
            }
            Self::Hyperbola { frame, radii: [a, b] } => {
                let (sine, cosine) = (u.sinh(), u.cosh());
                placed(frame, DVec3::new(a * cosine, b * sine, 0.0), DVec3::new(a * sine, b * cosine, 0.0))
            }
            Self::Parabola { frame, focal_distance: f } => {
                placed(frame, *f * DVec3::new(u * u, 2.0 * u, 0.0), 2.0 * *f * DVec3::new(u, 1.0, 0.0))
            }
            Self::Nurbs(curve) => curve.derivatives(u),
        }
    }

    /// Point at a parameter.
    pub fn point(&self, u: f64) -> DVec3 {
        self.derivatives(u)[0]
    }

    /// Period of the parameter: of circles and ellipses 2π, of closed NURBS curves the length of their domain.
    pub fn period(&self) -> Option<f64> {
        match self {
            Self::Circle { .. } | Self::Ellipse { .. } => Some(TAU),
            Self::Nurbs(curve) if curve.is_closed() => {
                let [first, last] = curve.domain();
                Some(last - first)
            }
            _ => None,
        }
    }

    /// A range of the parameter with something of the curve's shape: the domain of a NURBS curve, a turn of an ellipse.
    pub fn some_range(&self) -> [f64; 2] {
        match self {
            Self::Circle { .. } | Self::Ellipse { .. } => [0.0, TAU],
            Self::Nurbs(curve) => curve.domain(),
            _ => [-1.0, 1.0],
        }
    }
}
