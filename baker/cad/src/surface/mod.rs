//! Surfaces, with the parametrisations of ISO 10303-42.

use crate::curve::Curve;
use crate::frame::Frame;
use glam::{DVec2, DVec3};

pub mod extrusion;
pub mod nurbs;
pub mod revolution;

pub use nurbs::NurbsSurface;

/// A surface, untrimmed.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface {
    /// σ(u, v) = C + u x + v y.
    Plane(Frame),
    /// σ(u, v) = C + R (cos u x + sin u y) + v z.
    Cylinder {
        /// Placement.
        frame: Frame,
        /// R.
        radius: f64,
    },
    /// σ(u, v) = C + (R + v tan φ) (cos u x + sin u y) + v z.
    Cone {
        /// Placement.
        frame: Frame,
        /// R, where v is 0; may be 0.
        radius: f64,
        /// φ, above 0 and below π/2.
        half_angle: f64,
    },
    /// σ(u, v) = C + R cos v (cos u x + sin u y) + R sin v z.
    Sphere {
        /// Placement.
        frame: Frame,
        /// R.
        radius: f64,
    },
    /// σ(u, v) = C + (R + r cos v) (cos u x + sin u y) + r sin v z. R < r is a lemon or apple, of which the outer part counts.
    Torus {
        /// Placement.
        frame: Frame,
        /// R.
        major: f64,
        /// r.
        minor: f64,
    },
    /// σ(u, v) = λ(v) turned by u about the z axis of the frame through its origin.
    Revolution {
        /// Axis; x and y are of no account.
        frame: Frame,
        /// λ.
        profile: Curve,
    },
    /// σ(u, v) = λ(u) + v V.
    Extrusion {
        /// λ.
        profile: Curve,
        /// V.
        along: DVec3,
    },
    /// A B-spline surface, rational or not.
    Nurbs(NurbsSurface),
}

/// A line in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Origin.
    pub origin: DVec3,
    /// Direction, of any length above 0: distances are multiples of it.
    pub direction: DVec3,
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// Multiple of the ray's direction.
    pub distance: f64,
    /// Parameters u and v.
    pub at: DVec2,
}
