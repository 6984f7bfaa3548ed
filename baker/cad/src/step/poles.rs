//! Periods, poles and whole domains of surfaces, as trimming loops need them.

use crate::curve::Curve;
use crate::frame::Frame;
use crate::surface::{NurbsSurface, Surface};
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_PI_2, TAU};

/// What is near at a pole and at a seam, relative to the size of a surface.
const NEAR: f64 = 1e-7;

/// Parameters of a surface.
pub(super) struct Domain {
    /// Lengths after which u and v repeat: periods, and the lengths of closed B-splines.
    pub periods: [Option<f64>; 2],
    /// Beginnings and ends that u and v must not leave: B-splines.
    pub limits: [Option<[f64; 2]>; 2],
    /// Lines of the parameter plane that are points in space.
    pub poles: Vec<Pole>,
    /// All of it, where it is bounded.
    pub whole: Option<[DVec2; 2]>,
}

/// A line of constant parameter that is one point in space: apex, pole, collapsed side.
#[derive(Clone, Copy)]
pub(super) struct Pole {
    /// The constant parameter: 0 for u, 1 for v.
    pub axis: usize,
    /// Its value.
    pub value: f64,
    /// The point.
    pub place: DVec3,
}

impl Domain {
    /// That of a surface.
    pub fn new(surface: &Surface) -> Self {
        let mut domain = Self { periods: [None; 2], limits: [None; 2], poles: Vec::new(), whole: None };
        match surface {
            Surface::Plane(_) => {}
            Surface::Cylinder { .. } => domain.periods = [Some(TAU), None],
            Surface::Cone { frame, radius, half_angle } => {
                domain.periods = [Some(TAU), None];
                let value = -radius / half_angle.tangent();
                domain.poles.push(Pole { axis: 1, value, place: frame.place(DVec3::new(0.0, 0.0, value)) });
            }
            Surface::Sphere { .. } => {
                domain.periods = [Some(TAU), None];
                domain.between_poles(surface, FRAC_PI_2);
            }
            Surface::Torus { major, minor, .. } if minor >= major => {
                // Where the tube meets the axis.
                domain.periods = [Some(TAU), None];
                domain.between_poles(surface, (-major / minor).arc_cosine());
            }
            Surface::Torus { .. } => {
                domain.periods = [Some(TAU); 2];
                domain.whole = Some([DVec2::ZERO, DVec2::splat(TAU)]);
            }
            Surface::Revolution { frame, profile } => domain.revolve(frame, profile),
            Surface::Extrusion { profile, .. } => {
                (domain.periods[0], domain.limits[0]) = repeats(profile);
            }
            Surface::Nurbs(nurbs) => domain.knots(surface, nurbs),
        }
        domain
    }

    /// Whether the surface closes a body.
    pub fn is_closed(&self) -> bool {
        let ends = |axis| self.poles.iter().filter(|pole| pole.axis == axis).count();
        let closes = |axis: usize| self.periods[axis].is_some() || ends(axis) == 2;
        self.whole.is_some() && closes(0) && closes(1)
    }

    /// The same place in the limits: back by periods, or to the nearest end.
    pub fn within(&self, mut at: DVec2) -> DVec2 {
        for axis in 0..2 {
            let Some([first, last]) = self.limits[axis] else { continue };
            if at[axis] < first || at[axis] > last {
                let back = |period: f64| first + (at[axis] - first).rem_euclid(period);
                at[axis] = self.periods[axis].map_or(at[axis], back).clamp(first, last);
            }
        }
        at
    }

    fn between_poles(&mut self, surface: &Surface, latitude: f64) {
        for value in [-latitude, latitude] {
            self.poles.push(Pole { axis: 1, value, place: surface.point(DVec2::new(0.0, value)) });
        }
        self.whole = Some([DVec2::new(0.0, -latitude), DVec2::new(TAU, latitude)]);
    }

    fn revolve(&mut self, frame: &Frame, profile: &Curve) {
        let (period, limits) = repeats(profile);
        self.periods = [Some(TAU), period];
        self.limits[1] = limits;
        for value in meets_axis(frame, profile) {
            self.poles.push(Pole { axis: 1, value, place: profile.point(value) });
        }
        let mut range = limits.or(period.map(|period| [0.0, period]));
        if let (Some(period), [low, high]) = (period, &self.poles[..])
            && limits.is_none()
        {
            // A conic through the axis: its part from pole to pole makes the surface.
            self.periods[1] = None;
            let (low, high) = (low.value.min(high.value), low.value.max(high.value));
            range = Some(if high - low > 0.5 * period + 1e-6 { [high, low + period] } else { [low, high] });
            self.poles[0].value = range.map_or(low, |range| range[0]);
            self.poles[1].value = range.map_or(high, |range| range[1]);
            self.poles.iter_mut().for_each(|pole| pole.place = profile.point(pole.value));
        }
        self.whole = range.map(|[low, high]| [DVec2::new(0.0, low), DVec2::new(TAU, high)]);
    }

    fn knots(&mut self, surface: &Surface, nurbs: &NurbsSurface) {
        let [low, high] = nurbs.domain();
        let extent = nurbs.poles.iter().map(|pole| pole.distance(nurbs.poles[0])).fold(0.0, f64::max);
        let fractions = [0.0, 0.21, 0.4, 0.63, 0.82, 1.0];
        for axis in 0..2 {
            self.limits[axis] = Some([low[axis], high[axis]]);
            // Points along both sides of constant u (axis 0) or v.
            let side = |value: f64| {
                fractions.map(|fraction| {
                    let mut at = low + fraction * (high - low);
                    at[axis] = value;
                    surface.point(at)
                })
            };
            let sides = [side(low[axis]), side(high[axis])];
            let is_point = |side: &[DVec3; 6]| side.iter().all(|it| it.distance(side[0]) <= NEAR * extent);
            for (side, value) in sides.iter().zip([low[axis], high[axis]]) {
                if is_point(side) {
                    self.poles.push(Pole { axis, value, place: side[0] });
                }
            }
            let is_seam = sides[0].iter().zip(&sides[1]).all(|(a, b)| a.distance(*b) <= NEAR * extent);
            if is_seam && !is_point(&sides[0]) {
                self.periods[axis] = Some(high[axis] - low[axis]);
            }
        }
        self.whole = Some([low, high]);
    }
}

/// Period and limits of a profile's parameter.
fn repeats(profile: &Curve) -> (Option<f64>, Option<[f64; 2]>) {
    match profile {
        Curve::Nurbs(nurbs) => (profile.period(), Some(nurbs.domain())),
        _ => (profile.period(), None),
    }
}

/// Parameters at which a profile meets the axis that it is turned about: lines, circles, ellipses, ends of B-splines.
fn meets_axis(frame: &Frame, profile: &Curve) -> Vec<f64> {
    let distance = |t: f64| frame.local(profile.point(t)).truncate().length();
    match profile {
        Curve::Line { origin, direction } => {
            let (at, along) = (frame.local(*origin).truncate(), frame.local_direction(*direction).truncate());
            let t = -at.dot(along) / along.length_squared();
            let is_met = along.length() > NEAR * direction.length() && distance(t) <= NEAR * at.length();
            is_met.then_some(t).into_iter().collect()
        }
        Curve::Circle { radius, .. } => least(distance, NEAR * radius),
        Curve::Ellipse { radii, .. } => least(distance, NEAR * radii[0].max(radii[1])),
        Curve::Nurbs(nurbs) => {
            let extent = nurbs.poles.iter().map(|pole| pole.distance(nurbs.poles[0])).fold(0.0, f64::max);
            let (period, ends) = repeats(profile);
            let ends = if period.is_some() { None } else { ends };
            ends.into_iter().flatten().filter(|end| distance(*end) <= NEAR * extent).collect()
        }
        _ => Vec::new(),
    }
}

/// Where a function of an angle comes down to 0: the least of 64 samples, made exact by golden section.
fn least(distance: impl Fn(f64) -> f64, near: f64) -> Vec<f64> {
    let step = TAU / 64.0;
    let mut found: Vec<f64> = Vec::new();
    for at in 0..64 {
        let t = f64::from(at) * step;
        if distance(t) > distance(t - step) || distance(t) >= distance(t + step) {
            continue;
        }
        let (mut low, mut high) = (t - step, t + step);
        for _ in 0..60 {
            let third = 0.381_966_011_250_105 * (high - low);
            if distance(low + third) < distance(high - third) { high -= third } else { low += third }
        }
        if distance(0.5 * (low + high)) <= near {
            found.push(0.5 * (low + high));
        }
    }
    found
}
