//! Solids of revolution.

use super::loops::{circle, rectangle};
use crate::curve::Curve;
use crate::face::Face;
use crate::frame::Frame;
use crate::frame::unit;
use crate::surface::Surface;
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Share of a length that counts as rounding.
const ROUNDING: f64 = 1e-12;

/// A profile in the half plane of radius and height about an axis, from one end to the other. With the solid on the left of it,
/// as of a profile from the bottom of the axis outwards and up to its top, normals point out of the solid.
pub(super) struct Profile {
    frame: Frame,
    at: DVec2,
    faces: Vec<Face>,
    /// Volume between the profile and the axis, π ∫ r² dz.
    volume: f64,
}

impl Profile {
    /// The empty profile about the y axis.
    pub fn about_y(radius: f64, height: f64) -> Self {
        let frame = Frame { origin: DVec3::ZERO, x: DVec3::NEG_Z, y: DVec3::NEG_X, z: DVec3::Y };
        Self { frame, at: DVec2::new(radius, height), faces: Vec::new(), volume: 0.0 }
    }

    /// A segment to a radius and height: a disc or ring of a plane, a cylinder, or a cone.
    pub fn to(mut self, radius: f64, height: f64) -> Self {
        let (from, mut to) = (self.at, DVec2::new(radius, height));
        // What is level or upright but for rounding is level or upright.
        if (to.y - from.y).abs() < ROUNDING * (to.x - from.x).abs() {
            to.y = from.y;
        } else if (to.x - from.x).abs() < ROUNDING * (to.y - from.y).abs() {
            to.x = from.x;
        }
        self.at = to;
        let step = to - from;
        self.volume += step.y * TAU / 6.0 * (from.x * from.x + from.x * to.x + to.x * to.x);
        let base = |height: f64| Frame { origin: self.frame.place(DVec3::Z * height), ..self.frame };
        if step.y == 0.0 {
            let loops = [from.x, to.x].into_iter().filter(|radius| *radius > 0.0);
            let loops = loops.map(|radius| circle(DVec2::ZERO, radius)).collect();
            self.faces.push(Face { surface: Surface::Plane(base(to.y)), is_reversed: step.x > 0.0, loops });
        } else if step.x == 0.0 {
            let surface = Surface::Cylinder { frame: base(from.y.min(to.y)), radius: to.x };
            self.round(surface, [0.0, step.y.abs()], step.y < 0.0);
        } else {
            let narrow = if step.x > 0.0 { from } else { to };
            let mut frame = base(narrow.y);
            if step.x * step.y < 0.0 {
                // The other way up: cones widen along their axis.
                (frame.y, frame.z) = (-frame.y, -frame.z);
            }
            let half_angle = (step.x / step.y).abs().arc_tangent();
            let surface = Surface::Cone { frame, radius: narrow.x, half_angle };
            self.round(surface, [0.0, step.y.abs()], step.y < 0.0);
        }
        self
    }

    /// An arc of a circle about a centre, by so many radians, counterclockwise where positive: a sphere or a torus, or a surface
    /// of revolution where the torus would meet itself.
    pub fn arc(mut self, radius: f64, height: f64, turn: f64) -> Self {
        let (from, centre) = (self.at, DVec2::new(radius, height));
        let size = from.distance(centre);
        let begin = (from - centre).to_angle();
        let end = begin + turn;
        self.at = centre + size * unit(end);
        // An arc that ends on the axis but for rounding ends on it.
        if self.at.x.abs() < ROUNDING * size {
            self.at.x = 0.0;
        }
        let range = [begin.min(end), begin.max(end)];
        let middle = Frame { origin: self.frame.place(DVec3::Z * height), ..self.frame };
        if radius == 0.0 {
            let range = range.map(|v| v.clamp(-FRAC_PI_2, FRAC_PI_2));
            self.round(Surface::Sphere { frame: middle, radius: size }, range, turn < 0.0);
        } else if radius > size {
            self.round(Surface::Torus { frame: middle, major: radius, minor: size }, range, turn < 0.0);
        } else {
            let circle = Curve::Circle { frame: self.upright(centre), radius: size };
            let surface = Surface::Revolution { frame: self.frame, profile: circle };
            self.round(surface, range, turn < 0.0);
        }
        // ∫ (c + ρ cos t)² ρ cos t dt.
        let integral = |t: f64| {
            let (sin, cos) = t.sine_cosine();
            radius * radius * sin + radius * size * (t + sin * cos) + size * size * (sin - sin.powi(3) / 3.0)
        };
        self.volume += 0.5 * TAU * size * (integral(end) - integral(begin));
        self
    }

    /// Part of a curve from one parameter to the other. `curve` makes it of a frame: the origin at this radius and height, x away
    /// from the axis, y along it.
    pub fn curve(
        mut self,
        radius: f64,
        height: f64,
        [from, to]: [f64; 2],
        curve: impl FnOnce(Frame) -> Curve,
    ) -> Self {
        let profile = curve(self.upright(DVec2::new(radius, height)));
        let place = |u: f64| self.frame.local(profile.point(u));
        // Simpson's rule between points where the curve is smooth.
        for part in profile.pieces([from, to]).windows(2) {
            let steps = 64;
            for step in 0..steps {
                let u = |part_of: f64| {
                    part[0] + (part[1] - part[0]) * (f64::from(step) + part_of) / f64::from(steps)
                };
                let slice = |u: f64| {
                    let [point, along, _] = profile.derivatives(u);
                    let [point, along] = [self.frame.local(point), self.frame.local_direction(along)];
                    (point.x * point.x + point.y * point.y) * along.z
                };
                let width = u(1.0) - u(0.0);
                self.volume +=
                    0.5 * TAU * width * (slice(u(0.0)) + 4.0 * slice(u(0.5)) + slice(u(1.0))) / 6.0;
            }
        }
        let end = place(to);
        self.at = DVec2::new(end.x, end.z);
        let surface = Surface::Revolution { frame: self.frame, profile };
        self.round(surface, [from.min(to), from.max(to)], to < from);
        self
    }

    /// Radius and height of the end.
    pub fn end(&self) -> [f64; 2] {
        self.at.to_array()
    }

    /// The faces, and the volume between the profile and the axis.
    pub fn finish(self) -> (Vec<Face>, f64) {
        (self.faces, self.volume)
    }

    /// Placement of a plane curve of the profile.
    fn upright(&self, at: DVec2) -> Frame {
        let Frame { x, y, z, .. } = self.frame;
        Frame { origin: self.frame.place(DVec3::new(at.x, 0.0, at.y)), x, y: z, z: -y }
    }

    /// A face all round, with v in this range.
    fn round(&mut self, surface: Surface, [low, high]: [f64; 2], is_reversed: bool) {
        let loops = vec![rectangle(DVec2::new(0.0, low), DVec2::new(TAU, high))];
        self.faces.push(Face { surface, is_reversed, loops });
    }
}
