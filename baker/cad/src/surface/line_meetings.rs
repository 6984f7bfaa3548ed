//! Where a line meets a surface with a closed form: found once, for all patches of the surface.

use super::angle::angle_within;
use super::local_ray::LocalRay;
use super::polynomial::Roots;
use super::{Ray, Surface, SurfaceHit, cone, cylinder, plane, sphere, torus};
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;

/// All meetings of a line with a surface, ascending. Parameters are computed when they are first asked for.
#[derive(Clone, Copy, Debug)]
pub struct LineMeetings {
    ray: LocalRay,
    roots: Roots,
    parameters: [Option<DVec2>; 4],
}

impl LineMeetings {
    /// Number of meetings.
    pub fn count(&self) -> usize {
        self.roots.len()
    }

    /// Distance of a meeting, a multiple of the ray's direction.
    pub fn distance(&self, index: usize) -> f64 {
        self.ray.distance(self.roots[index])
    }

    /// A meeting with a patch of the surface that they are of, as [`Surface::meet`] has it; `None` if it is not in the patch.
    pub fn in_patch(
        &mut self,
        index: usize,
        surface: &Surface,
        [low, high]: &[DVec2; 2],
    ) -> Option<SurfaceHit> {
        let known = self.parameters[index];
        let at = known.unwrap_or_else(|| surface.invert_local(self.ray.at(self.roots[index]), None));
        self.parameters[index] = Some(at);
        let periods = surface.periods();
        let within = |value: f64, ends: [f64; 2], period: Option<f64>| match period {
            Some(_) => angle_within(value, ends),
            None => (ends[0] <= value && value <= ends[1]).then_some(value),
        };
        let u = within(at.x, [low.x, high.x], periods[0])?;
        let v = within(at.y, [low.y, high.y], periods[1])?;
        Some(SurfaceHit { distance: self.distance(index), at: DVec2::new(u, v) })
    }
}

impl Surface {
    /// Where a ray's line meets the surface, wherever on it; the digits are best near `patch`. Meetings that are not at these
    /// distances may be left out. `None` for surfaces without a closed form: revolutions, extrusions, NURBS.
    pub fn line_meetings(
        &self,
        ray: &Ray,
        [low, high]: &[DVec2; 2],
        distances: [f64; 2],
    ) -> Option<LineMeetings> {
        let middle = 0.5 * (low.y + high.y);
        let middle = DVec3::new(0.0, 0.0, if middle.is_finite() { middle } else { 0.0 });
        let (frame, centre) = match self {
            Self::Plane(frame) => (frame, DVec3::ZERO),
            Self::Cylinder { frame, .. } | Self::Cone { frame, .. } => (frame, middle),
            Self::Sphere { frame, .. } | Self::Torus { frame, .. } => (frame, DVec3::ZERO),
            Self::Revolution { .. } | Self::Extrusion { .. } | Self::Nurbs(_) => return None,
        };
        let parameters = [None; 4];
        let Some(ray) = LocalRay::new(ray, frame, centre) else {
            return Some(LineMeetings { ray: LocalRay::NONE, roots: Roots::default(), parameters });
        };
        let roots = match self {
            Self::Cylinder { radius, .. } => cylinder::roots(*radius, &ray),
            Self::Cone { radius, half_angle, .. } => cone::roots(*radius, half_angle.tangent(), &ray),
            Self::Sphere { radius, .. } => sphere::roots(*radius, &ray),
            Self::Torus { major, minor, .. } => torus::roots(*major, *minor, &ray, distances),
            _ => plane::roots(&ray),
        };
        Some(LineMeetings { ray, roots, parameters })
    }
}
