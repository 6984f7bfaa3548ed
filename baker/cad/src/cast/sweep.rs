//! Surfaces of revolution and extrusion as NURBS surfaces (Piegl and Tiller 1997, 8.3 and 8.5), for the casting of rays. At
//! knots they have the parameters of the surface, between them they need not.

use super::{Curve, NurbsSurface};
use crate::frame::Frame;
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::FRAC_PI_2;

/// Most arcs of a turn.
const MOST_ARCS: f64 = 64.0;

/// Number of rational arcs of at most 90 degrees for a turn from one angle to another, and the angle of each.
fn arcs(low: f64, high: f64) -> (usize, f64) {
    let arcs = ((high - low) / FRAC_PI_2 - 1e-9).ceil().clamp(1.0, MOST_ARCS);
    (arcs as usize, (high - low) / arcs)
}

/// Whether a NURBS curve made of this one has its parameters everywhere.
pub(super) fn keeps_parameters(profile: &Curve) -> bool {
    matches!(profile, Curve::Line { .. } | Curve::Nurbs(_))
}

/// The angle of a surface of revolution, for the parameter of the spline that [`revolution`] makes of it with these least and
/// greatest angles.
pub(super) fn angle([low, high]: [f64; 2], at: f64) -> f64 {
    let (count, step) = arcs(low, high);
    let arc = ((at - low) / step).floor().clamp(0.0, (count - 1) as f64);
    let t = (at - low) / step - arc;
    // The rational quadratic arc with poles at 0, at the tangents' meeting, and at `step`.
    let [from, middle, to] = [(1.0 - t) * (1.0 - t), 2.0 * t * (1.0 - t), t * t];
    let ((sine, cosine), (half_sine, half_cosine)) = (step.sine_cosine(), (0.5 * step).sine_cosine());
    let angle = (middle * half_sine + to * sine).arc_tangent2(from + middle * half_cosine + to * cosine);
    low + arc * step + angle
}

/// Parameters of a surface of revolution, for those of its spline; `None` if the profile's cannot be told.
pub(super) fn of_revolution(profile: &Curve, ends: [f64; 2], at: DVec2) -> Option<DVec2> {
    keeps_parameters(profile).then(|| DVec2::new(angle(ends, at.x), at.y))
}

/// As [`of_revolution`], of a surface of extrusion.
pub(super) fn of_extrusion(profile: &Curve, at: DVec2) -> Option<DVec2> {
    keeps_parameters(profile).then_some(at)
}

/// The part of a surface of revolution with these least and greatest parameters: rational arcs of at most 90 degrees.
pub(super) fn revolution(frame: &Frame, profile: &Curve, [low, high]: [DVec2; 2]) -> NurbsSurface {
    let profile = profile.to_nurbs([low.y, high.y]);
    let (arcs, step) = arcs(low.x, high.x);
    let mut knots = vec![low.x; 3];
    (1..=arcs).for_each(|k| knots.extend([low.x + step * k as f64; 2]));
    knots.push(high.x);
    let (mut poles, mut weights) = (Vec::new(), Vec::new());
    for k in 0..=2 * arcs {
        // Between two arcs, and where the tangents of an arc's ends meet.
        let shoulder = if k % 2 == 1 { (0.5 * step).cosine() } else { 1.0 };
        let (sine, cosine) = (low.x + 0.5 * step * k as f64).sine_cosine();
        for (pole, weight) in profile.poles.iter().zip(&profile.weights) {
            let p = frame.local(*pole);
            let turned = DVec2::new(cosine * p.x - sine * p.y, sine * p.x + cosine * p.y) / shoulder;
            poles.push(frame.place(turned.extend(p.z)));
            weights.push(weight * shoulder);
        }
    }
    let counts = [2 * arcs + 1, profile.poles.len()];
    NurbsSurface { degrees: [2, profile.degree], knots: [knots, profile.knots], counts, poles, weights }
}

/// The part of a surface of extrusion with these least and greatest parameters.
pub(super) fn extrusion(profile: &Curve, along: DVec3, [low, high]: [DVec2; 2]) -> NurbsSurface {
    let profile = profile.to_nurbs([low.x, high.x]);
    let ends = [low.y, high.y];
    let poles = profile.poles.iter().flat_map(|pole| ends.map(|v| *pole + v * along)).collect();
    let weights = profile.weights.iter().flat_map(|weight| [*weight; 2]).collect();
    let counts = [profile.poles.len(), 2];
    let knots = [profile.knots, vec![ends[0], ends[0], ends[1], ends[1]]];
    NurbsSurface { degrees: [profile.degree, 1], knots, counts, poles, weights }
}
