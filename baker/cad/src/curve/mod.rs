//! Curves in space, with the parametrisations of ISO 10303-42. A plane curve (pcurve) has z = 0.

pub mod error;
pub mod nurbs;
#[cfg(test)]
pub(crate) mod random;

use crate::frame::Frame;
pub use error::SplineError;
use glam::DVec3;
pub use nurbs::NurbsCurve;

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
