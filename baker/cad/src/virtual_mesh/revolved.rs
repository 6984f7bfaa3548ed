//! Area elements of surfaces of revolution in closed form: lines and conics about their axes, circles as
//! tori.

use super::antiderivative::{Antiderivative, Form, Substitution};
use crate::curve::Curve;
use crate::frame::Frame;
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Of the sizes compared: so near is on the axis, in the plane, along it.
const ROUNDING: f64 = 1e-10;

/// An antiderivative of ρ |λ′|, where ρ is the distance of the profile from the axis, that holds on a range
/// of v; `None` if there is no closed form. Alonso et al. 2001, appendix A: cones, spheroids; Cuny 2000: the
/// other quadrics.
pub(super) fn closed_form(frame: &Frame, profile: &Curve, range: [f64; 2]) -> Option<Antiderivative> {
    let middle = 0.5 * (range[0] + range[1]);
    let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
    let found = match profile {
        Curve::Line { origin, direction } => {
            let [from, along] = [frame.local(*origin), frame.local_direction(*direction)];
            let out = radial(along.truncate(), from.truncate())?;
            line(from.truncate().dot(out), along.truncate().dot(out), direction.length(), middle)
        }
        Curve::Circle { frame: plane, radius } => {
            let half = HalfPlane::new(frame, plane, *radius)?;
            circle(&half, *radius, middle)
        }
        Curve::Ellipse { frame: plane, radii } => {
            let half = HalfPlane::new(frame, plane, radii[0].max(radii[1]))?;
            let along = half.axis_along(radii[0].max(radii[1]))?;
            let base = if along == 1 { 0.0 } else { FRAC_PI_2 };
            spheroid(radii[1 - along], radii[along], base, middle)
        }
        Curve::Hyperbola { frame: plane, radii } => {
            let half = HalfPlane::new(frame, plane, radii[0].max(radii[1]))?;
            let square = radii[0] * radii[0] + radii[1] * radii[1];
            if half.axis_along(radii[0].max(radii[1]))? == 1 {
                let substitution = Substitution::HyperbolicSine;
                let constant = radii[1] * radii[1];
                let form = Form::Conic { substitution, scale: radii[0], constant, square };
                Antiderivative::new(form, everywhere)
            } else {
                let side = 1_f64.copysign(middle);
                let substitution = Substitution::HyperbolicCosine { side };
                let constant = -radii[0] * radii[0];
                let form = Form::Conic { substitution, scale: radii[1], constant, square };
                Antiderivative::new(form, beyond(side, 0.0))
            }
        }
        Curve::Parabola { frame: plane, focal_distance } => {
            let half = HalfPlane::new(frame, plane, *focal_distance)?;
            if half.axis_along(*focal_distance)? == 1 {
                return None;
            }
            let side = 1_f64.copysign(middle);
            let form = Form::Parabola { scale: 4.0 * focal_distance * focal_distance, side };
            Antiderivative::new(form, beyond(side, 0.0))
        }
        Curve::Nurbs(_) => return None,
    };
    found.holds(range).then_some(found)
}

/// A line at a distance a + b t from the axis, of this speed: a cone, cylinder or plane. Also
/// [`crate::surface::Surface::Cone`].
pub(super) fn line(a: f64, b: f64, speed: f64, middle: f64) -> Antiderivative {
    let side = 1_f64.copysign(a + b * middle);
    if b.abs() <= ROUNDING * speed {
        return Antiderivative::constant(a.abs() * speed);
    }
    let form = Form::Linear { constant: speed * a, slope: speed * b, side };
    Antiderivative::new(form, beyond(side * b.signum(), -a / b))
}

/// An ellipse about one of its axes: radius across the axis and along it. Its farthest points are at `base`
/// and half a turn on.
pub(super) fn spheroid(across: f64, along: f64, base: f64, middle: f64) -> Antiderivative {
    let base = base + PI * ((middle - base) / PI).round();
    let substitution = Substitution::Sine { base };
    let square = (across - along) * (across + along);
    let form = Form::Conic { substitution, scale: across, constant: along * along, square };
    Antiderivative::new(form, [base - FRAC_PI_2, base + FRAC_PI_2])
}

/// A circle about an axis in its plane, at the distance `major` from the centre, not negative: ρ = R + r
/// cos(t − farthest).
pub(super) fn torus(major: f64, minor: f64, farthest: f64, middle: f64) -> Antiderivative {
    let [mean, amplitude] = [major * minor, minor * minor];
    if major >= minor {
        let form = Form::Kepler { mean, amplitude, phase: -farthest };
        return Antiderivative::new(form, [f64::NEG_INFINITY, f64::INFINITY]);
    }
    let pole = (-major / minor).arc_cosine();
    let centre = farthest + TAU * ((middle - farthest) / TAU).round();
    if (middle - centre).abs() <= pole {
        let form = Form::Kepler { mean, amplitude, phase: -centre };
        return Antiderivative::new(form, [centre - pole, centre + pole]);
    }
    // The part beyond the axis.
    let inner = if middle > centre { centre + pole } else { centre - TAU + pole };
    let form = Form::Kepler { mean: -mean, amplitude: -amplitude, phase: -centre };
    Antiderivative::new(form, [inner, inner + TAU - 2.0 * pole])
}

/// A circle: a sphere if its centre is on the axis, else a torus.
fn circle(half: &HalfPlane, radius: f64, middle: f64) -> Antiderivative {
    let [x, y] = half.across;
    let farthest = y.arc_tangent2(x);
    if half.distance.abs() <= ROUNDING * radius {
        return spheroid(radius, radius, farthest, middle);
    }
    let farthest = if half.distance < 0.0 { farthest + PI } else { farthest };
    torus(half.distance.abs(), radius, farthest, middle)
}

/// All parameters on one side of another.
fn beyond(side: f64, at: f64) -> [f64; 2] {
    if side > 0.0 { [at, f64::INFINITY] } else { [f64::NEG_INFINITY, at] }
}

/// The direction away from the axis that two vectors have in common; `None` if they have none.
fn radial(a: DVec2, b: DVec2) -> Option<DVec2> {
    let longer = if a.length() > b.length() { a } else { b };
    let out = longer.try_normalize()?;
    let size = a.length().max(b.length());
    (out.perp_dot(a).abs().max(out.perp_dot(b).abs()) <= ROUNDING * size).then_some(out)
}

/// How a conic lies in a plane with the axis.
struct HalfPlane {
    /// Of its centre from the axis, of either sign.
    distance: f64,
    /// Components of its x and y axes away from the axis.
    across: [f64; 2],
}

impl HalfPlane {
    /// `None` if the conic's plane does not hold the axis.
    fn new(frame: &Frame, plane: &Frame, size: f64) -> Option<Self> {
        let centre = frame.local(plane.origin);
        let normal = frame.local_direction(plane.z);
        let is_in_plane =
            normal.z.abs() <= ROUNDING && centre.truncate().dot(normal.truncate()).abs() <= ROUNDING * size;
        let out = normal.cross(DVec3::Z).try_normalize()?;
        let across = [plane.x, plane.y].map(|axis| frame.local_direction(axis).dot(out));
        is_in_plane.then_some(Self { distance: centre.dot(out), across })
    }

    /// Which axis of a conic centred on the axis lies along it, 0 or 1.
    fn axis_along(&self, size: f64) -> Option<usize> {
        if self.distance.abs() > ROUNDING * size {
            return None;
        }
        self.across.iter().position(|across| across.abs() <= ROUNDING)
    }
}
