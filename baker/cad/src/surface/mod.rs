//! Surfaces, with the parametrisations of ISO 10303-42.

mod angle;
mod area;
mod cone;
mod cylinder;
mod extrusion;
mod line_meetings;
mod local_ray;
pub mod nurbs;
pub(crate) mod plane;
mod polynomial;
mod revolution;
mod sphere;
mod surface_hits;
#[cfg(test)]
mod swept_tests;
#[cfg(test)]
mod tests;
mod torus;

use crate::curve::Curve;
use crate::frame::Frame;
use angle::near_angle;
use glam::{DVec2, DVec3};
pub use line_meetings::LineMeetings;
pub use nurbs::NurbsSurface;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::TAU;
pub use surface_hits::SurfaceHits;

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
pub struct SurfaceHit {
    /// Multiple of the ray's direction.
    pub distance: f64,
    /// Parameters u and v.
    pub at: DVec2,
}

impl Surface {
    /// What the surface is called: `cylinder`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Plane(_) => "plane",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::Sphere { .. } => "sphere",
            Self::Torus { .. } => "torus",
            Self::Revolution { .. } => "revolution",
            Self::Extrusion { .. } => "extrusion",
            Self::Nurbs(_) => "NURBS surface",
        }
    }

    /// σ.
    pub fn point(&self, at: DVec2) -> DVec3 {
        self.derivatives(at)[0]
    }

    /// σ and the unit normal, as [`Self::point`] and [`Self::normal`] have them.
    pub fn point_and_normal(&self, at: DVec2) -> [DVec3; 2] {
        match self {
            Self::Revolution { .. } | Self::Extrusion { .. } | Self::Nurbs(_) => {
                let [point, along_u, along_v] = self.derivatives(at);
                let normal = Self::unit_normal([along_u, along_v], at).unwrap_or_else(|| self.normal(at));
                [point, normal]
            }
            _ => [self.point(at), self.normal(at)],
        }
    }

    /// σ, σᵤ, σᵥ.
    pub fn derivatives(&self, at: DVec2) -> [DVec3; 3] {
        let (frame, [point, along_u, along_v]) = match self {
            Self::Plane(frame) => (frame, plane::derivatives(at)),
            Self::Cylinder { frame, radius } => (frame, cylinder::derivatives(*radius, at)),
            Self::Cone { frame, radius, half_angle } => {
                (frame, cone::derivatives(*radius, half_angle.tangent(), at))
            }
            Self::Sphere { frame, radius } => (frame, sphere::derivatives(*radius, at)),
            Self::Torus { frame, major, minor } => (frame, torus::derivatives(*major, *minor, at)),
            Self::Revolution { frame, profile } => return revolution::derivatives(frame, profile, at),
            Self::Extrusion { profile, along } => return extrusion::derivatives(profile, *along, at),
            Self::Nurbs(nurbs) => return nurbs.derivatives(at),
        };
        [frame.place(point), frame.turn(along_u), frame.turn(along_v)]
    }

    /// Unit vector along σᵤ × σᵥ. At a pole of a sphere or torus and at a cone's apex, where that is 0, its limit: outward, and on the
    /// side of positive radius. Where another surface has σᵤ × σᵥ = 0, the normal a little towards parameter 0, or the middle
    /// of the domain of a NURBS surface; if it has none there either, any unit vector.
    pub fn normal(&self, at: DVec2) -> DVec3 {
        match self {
            Self::Plane(frame) => frame.z,
            Self::Cylinder { frame, .. } => frame.turn(DVec3::new(at.x.cosine(), at.x.sine(), 0.0)),
            Self::Cone { frame, radius, half_angle } => {
                frame.turn(cone::normal(*radius, half_angle.tangent(), at))
            }
            Self::Sphere { frame, .. } => frame.turn(sphere::normal(at)),
            Self::Torus { frame, .. } => frame.turn(torus::normal(at)),
            Self::Revolution { .. } | Self::Extrusion { .. } => self.normal_towards(at, DVec2::ZERO),
            Self::Nurbs(nurbs) => {
                let [low, high] = nurbs.domain();
                self.normal_towards(at, 0.5 * (low + high))
            }
        }
    }

    /// σᵤ × σᵥ made a unit vector, if it is 0 that a little nearer to `middle`.
    fn normal_towards(&self, at: DVec2, middle: DVec2) -> DVec3 {
        let inward = DVec2::new((middle.x - at.x).signum(), (middle.y - at.y).signum());
        let scale = at.abs().max(DVec2::ONE);
        let mut found = [0.0, 1e-6, 1e-3].into_iter().filter_map(|step| {
            let [_, along_u, along_v] = self.derivatives(at + step * scale * inward);
            Self::unit_normal([along_u, along_v], at)
        });
        found.next().unwrap_or(DVec3::Z)
    }

    /// σᵤ × σᵥ at parameters made a unit vector; `None` if it is 0.
    fn unit_normal([along_u, along_v]: [DVec3; 2], at: DVec2) -> Option<DVec3> {
        let scale = at.abs().max(DVec2::ONE);
        let [a, b] = [along_u.length() * scale.x, along_v.length() * scale.y];
        let cross = along_u.cross(along_v) * (scale.x * scale.y);
        // Below that it is what rounding leaves of vanishing or parallel derivatives.
        let is_any = a.min(b) > 1e-12 * a.max(b) && cross.length() > 1e-10 * a * b;
        is_any.then(|| cross.normalize_or(DVec3::Z))
    }

    /// Parameters of the nearest point of the surface. Of an angle's turns it is that nearest to `near`; where the angle is undetermined,
    /// on an axis, it is that of `near`. Without `near` u is from 0 to 2π.
    pub fn invert(&self, place: DVec3, near: Option<DVec2>) -> DVec2 {
        let mut at = match self {
            Self::Revolution { frame, profile } => return revolution::invert(frame, profile, place, near),
            Self::Extrusion { profile, along } => return extrusion::invert(profile, *along, place, near),
            Self::Nurbs(nurbs) => return nurbs.invert(place, near),
            Self::Plane(frame)
            | Self::Cylinder { frame, .. }
            | Self::Cone { frame, .. }
            | Self::Sphere { frame, .. }
            | Self::Torus { frame, .. } => self.invert_local(frame.local(place), near),
        };
        if let Some(near) = near {
            let periods = self.periods();
            at.x = if periods[0].is_some() { near_angle(at.x, near.x) } else { at.x };
            at.y = if periods[1].is_some() { near_angle(at.y, near.y) } else { at.y };
        }
        at
    }

    /// Parameters of the nearest point to a place in the frame's coordinates, of a surface with a closed form.
    fn invert_local(&self, place: DVec3, near: Option<DVec2>) -> DVec2 {
        match self {
            Self::Cylinder { radius, .. } => cylinder::invert(*radius, place, near),
            Self::Cone { radius, half_angle, .. } => cone::invert(*radius, half_angle.tangent(), place, near),
            Self::Sphere { radius, .. } => sphere::invert(*radius, place, near),
            Self::Torus { major, minor, .. } => torus::invert(*major, *minor, place, near),
            _ => plane::invert(place),
        }
    }

    /// Periods of u and v, where they have one.
    pub fn periods(&self) -> [Option<f64>; 2] {
        match self {
            Self::Plane(_) => [None; 2],
            Self::Cylinder { .. } | Self::Cone { .. } | Self::Sphere { .. } => [Some(TAU), None],
            Self::Torus { .. } => [Some(TAU); 2],
            Self::Revolution { frame, profile } => revolution::periods(frame, profile),
            Self::Extrusion { profile, along } => extrusion::periods(profile, *along),
            Self::Nurbs(nurbs) => nurbs.periods(),
        }
    }

    /// Where a ray meets the patch with parameters from low to high, within these distances, ascending; ends count. `found` loses
    /// what it had. An angle of a meeting is brought into the patch by whole turns, wherever the patch is; it has at most one. `false`,
    /// and nothing is found, for surfaces without a closed form: revolutions, extrusions, NURBS.
    ///
    /// A ray that touches the surface is found twice or not at all, so the number of meetings with a closed surface is even or odd
    /// as it should. A line within a plane, or a generator of a cylinder or cone, does not meet it.
    pub fn meet(&self, ray: &Ray, patch: &[DVec2; 2], distances: [f64; 2], found: &mut SurfaceHits) -> bool {
        found.clear();
        let Some(mut meetings) = self.line_meetings(ray, patch, distances) else { return false };
        for index in 0..meetings.count() {
            let distance = meetings.distance(index);
            if distances[0] <= distance
                && distance <= distances[1]
                && let Some(hit) = meetings.in_patch(index, self, patch)
            {
                found.push(hit);
            }
        }
        true
    }

    /// The box, low and high, about the finite patch with parameters from low to high: the least, but for a margin for rounding, for
    /// surfaces with a closed form.
    pub fn bounds(&self, patch: [DVec2; 2]) -> [DVec3; 2] {
        let frame = match self {
            Self::Plane(frame)
            | Self::Cylinder { frame, .. }
            | Self::Cone { frame, .. }
            | Self::Sphere { frame, .. }
            | Self::Torus { frame, .. } => frame,
            Self::Revolution { frame, profile } => return revolution::bounds(frame, profile, patch),
            Self::Extrusion { profile, along } => return extrusion::bounds(profile, *along, patch),
            Self::Nurbs(nurbs) => return nurbs.bounds(patch),
        };
        let extents = DVec3::AXES.map(|axis| {
            let direction = frame.local_direction(axis);
            match self {
                Self::Cylinder { radius, .. } => cylinder::extent(*radius, direction, patch),
                Self::Cone { radius, half_angle, .. } => {
                    cone::extent(*radius, half_angle.tangent(), direction, patch)
                }
                Self::Sphere { radius, .. } => sphere::extent(*radius, direction, patch),
                Self::Torus { major, minor, .. } => torus::extent(*major, *minor, direction, patch),
                _ => plane::extent(direction, patch),
            }
        });
        let [low, high] = [0, 1].map(|end| DVec3::from(extents.map(|extent| extent[end])));
        let size = low.abs().max(high.abs()).max_element() + frame.origin.abs().max_element();
        let margin = DVec3::splat(8.0 * f64::EPSILON * size);
        [frame.origin + low - margin, frame.origin + high + margin]
    }

    /// Area of the patch with parameters from low to high, which has at most a turn of an angle. A closed form, but for revolutions,
    /// extrusions and NURBS, where it is an integral computed to a part in a million, or of less where the surface has kinks.
    pub fn area(&self, patch: [DVec2; 2]) -> f64 {
        let sides = patch[1] - patch[0];
        match self {
            Self::Plane(_) => sides.x * sides.y,
            Self::Cylinder { radius, .. } => radius * sides.x * sides.y,
            Self::Cone { radius, half_angle, .. } => cone::area(*radius, half_angle.tangent(), patch),
            Self::Sphere { radius, .. } => sphere::area(*radius, patch),
            Self::Torus { major, minor, .. } => torus::area(*major, *minor, patch),
            Self::Revolution { .. } | Self::Extrusion { .. } | Self::Nurbs(_) => area::integral(self, patch),
        }
    }
}
