//! A teapot of quadrics in a room, after the test scene of Alonso et al. 2001, *The Virtual Mesh*: ellipsoid, spheres, cones,
//! cylinders, hyperboloids and a torus for the handle, with trimmed intersections, and 7 planar polygons.

use super::loops::{planar, polygon, quad, rectangle};
use super::revolved::Profile;
use super::{coloured, once};
use crate::curve::Curve;
use crate::face::Face;
use crate::frame::Frame;
use crate::model::Assembly;
use crate::surface::Surface;
use crate::trim::TrimLoop;
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Radius of the belly, a sphere, metres.
pub(super) const BELLY: f64 = 0.07;
/// Latitudes at which foot and collar cut the belly, radians.
const CUTS: [f64; 2] = [-0.87, 0.91];
/// Height of the foot.
const FOOT: f64 = 0.012;
/// Radii of the spout at the belly and at its mouth, and distance of the mouth from the belly's centre.
pub(super) const SPOUT: [f64; 3] = [0.019, 0.009, 0.135];
/// Elevation of the spout, radians.
const SPOUT_ANGLE: f64 = 0.55;
/// Major and minor radius of the handle, and distance of its centre from the belly's.
pub(super) const HANDLE: [f64; 3] = [0.04, 0.0075, 0.087];
/// Points of a curve where two surfaces intersect.
const INTERSECTION_POINTS: u32 = 256;
/// By what share surfaces reach beyond an intersection, which is sampled, so that no gap is left.
const OVERLAP: f64 = 2e-4;

/// The teapot on a table in a room, which is open towards +z; the room's normals point into it.
pub(super) fn assembly() -> Assembly {
    let mut scene = Assembly::default();
    let glaze = [0.72, 0.7, 0.66];
    once(&mut scene, "teapot", coloured(teapot().0, glaze), true, [0.0, 0.7, 0.0]);
    let white = [0.75, 0.74, 0.7];
    let mut room = Vec::new();
    let [x, y, z] = [[3.0, 0.0, 0.0], [0.0, 2.4, 0.0], [0.0, 0.0, 3.0]];
    let low = [-1.5, 0.0, -1.5];
    room.extend(coloured(vec![quad(low, z, x)], [0.35, 0.26, 0.18]));
    room.extend(coloured(vec![quad(low, x, y)], white));
    room.extend(coloured(vec![quad(low, y, z)], [0.25, 0.45, 0.3]));
    room.extend(coloured(vec![quad([1.5, 0.0, -1.5], z, y)], white));
    room.extend(coloured(vec![quad([-1.5, 2.4, -1.5], x, z)], white));
    once(&mut scene, "room", room, false, [0.0; 3]);
    let table = planar(
        Frame { origin: DVec3::ZERO, x: DVec3::X, y: DVec3::NEG_Z, z: DVec3::Y },
        vec![rectangle(DVec2::new(-0.6, -0.4), DVec2::new(0.6, 0.4))],
    );
    once(&mut scene, "table top", coloured(vec![table], [0.5, 0.36, 0.22]), false, [0.0, 0.7, 0.0]);
    // The light of the paper's scene comes back from it.
    let plate = quad([-0.25, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.36, -0.1]);
    once(&mut scene, "red plate", coloured(vec![plate], [0.8, 0.06, 0.05]), false, [0.0, 0.701, -0.2]);
    scene
}

/// Height of the belly's centre.
fn belly_height() -> f64 {
    FOOT - BELLY * CUTS[0].sine()
}

/// Faces of the teapot, standing on the plane y = 0, and the volume without spout and handle.
pub(super) fn teapot() -> (Vec<Face>, f64) {
    let height = belly_height();
    let foot = BELLY * CUTS[0].cosine();
    let lip = BELLY * CUTS[1].cosine();
    // Hyperboloids of one sheet: waists of this share of the radius at both ends.
    let waist = |share: f64, radius: f64, tall: f64| {
        let end = (1.0f64 / share).area_hyperbolic_cosine();
        let radii = [share * radius, 0.5 * tall / end.hyperbolic_sine()];
        ([-end, end], move |frame: Frame| Curve::Hyperbola { frame, radii })
    };
    let collar = 0.01;
    let (ends, hyperbola) = waist(0.96, lip, collar);
    let top = height + BELLY * CUTS[1].sine();
    let profile = Profile::about_y(0.0, 0.0).to(1.08 * foot, 0.0).to(foot, FOOT);
    let profile = profile.arc(0.0, height, CUTS[1] - CUTS[0]).curve(0.0, top + 0.5 * collar, ends, hyperbola);
    // The lid: a ring, an ellipsoid up to 4/5 of its height, the knob's stem, and the knob.
    let rim = top + collar;
    let profile = profile.to(0.97 * lip, rim);
    let radii = [0.97 * lip, 0.022];
    let profile = profile.curve(0.0, rim, [0.0, 1.3], |frame| Curve::Ellipse { frame, radii });
    let [stem, bottom] = profile.end();
    let (ends, hyperbola) = waist(0.7, stem, 0.008);
    let profile = profile.curve(0.0, bottom + 0.004, ends, hyperbola);
    let [stem, bottom] = profile.end();
    let knob = 0.015f64;
    let below = (knob * knob - stem * stem).sqrt();
    let profile = profile.arc(0.0, bottom + below, FRAC_PI_2 + below.arc_tangent2(stem));
    let (mut faces, volume) = profile.finish();
    let spout = spout(height);
    let handle = handle(height);
    for face in &mut faces {
        if matches!(face.surface, Surface::Sphere { radius, .. } if radius == BELLY) {
            let holes = [spout_hole(height), handle_holes(height)].concat();
            let holes = holes.iter().map(|points| in_parameters(&face.surface, points));
            face.loops.extend(holes.collect::<Vec<_>>());
        }
    }
    faces.extend(spout);
    faces.push(handle);
    (faces, volume)
}

/// Placement of the spout: at its mouth, with z back towards the belly's centre.
fn spout_frame(height: f64) -> Frame {
    let (sin, cos) = SPOUT_ANGLE.sine_cosine();
    let out = DVec3::new(cos, sin, 0.0);
    let origin = DVec3::Y * height + SPOUT[2] * out;
    Frame { origin, x: DVec3::Z, y: DVec3::Z.cross(out), z: -out }
}

/// Distance along the spout from its mouth to the circle where it meets the belly.
pub(super) fn spout_length() -> f64 {
    SPOUT[2] - (BELLY * BELLY - SPOUT[0] * SPOUT[0]).sqrt()
}

/// A cone from the belly to the mouth, which is closed by a disc.
fn spout(height: f64) -> Vec<Face> {
    let frame = spout_frame(height);
    let length = spout_length();
    let half_angle = ((SPOUT[0] - SPOUT[1]) / length).arc_tangent();
    let cone = Face {
        surface: Surface::Cone { frame, radius: SPOUT[1], half_angle },
        is_reversed: false,
        loops: vec![rectangle(DVec2::ZERO, DVec2::new(TAU, length))],
    };
    let disc = Face { is_reversed: true, ..planar(frame, vec![super::loops::circle(DVec2::ZERO, SPOUT[1])]) };
    vec![cone, disc]
}

/// Points of the circle where the cone meets the belly. Its chords in the belly's parameter plane lie within the circle, so that
/// the belly reaches into the spout.
fn spout_hole(height: f64) -> Vec<Vec<DVec3>> {
    let frame = spout_frame(height);
    let point = |k: u32| {
        let (sin, cos) = (TAU * f64::from(k) / f64::from(INTERSECTION_POINTS)).sine_cosine();
        frame.place(DVec3::new(SPOUT[0] * cos, SPOUT[0] * sin, spout_length()))
    };
    vec![(0..INTERSECTION_POINTS).map(point).collect()]
}

/// The handle's torus of a minor radius: u is 0 where it is farthest from the belly.
fn handle_torus(height: f64, minor: f64) -> Surface {
    let origin = DVec3::new(-HANDLE[2], height, 0.0);
    let frame = Frame { origin, x: DVec3::NEG_X, y: DVec3::NEG_Y, z: DVec3::Z };
    Surface::Torus { frame, major: HANDLE[0], minor }
}

/// The angle u from 0 to π at which the torus meets a sphere about the belly's centre, by bisection; the torus is symmetrical.
fn handle_end(torus: &Surface, height: f64, radius: f64, v: f64) -> f64 {
    let (mut outside, mut inside) = (0.0, PI);
    for _ in 0..60 {
        let middle = 0.5 * (outside + inside);
        let is_outside = torus.point(DVec2::new(middle, v)).distance(DVec3::Y * height) > radius;
        *(if is_outside { &mut outside } else { &mut inside }) = middle;
    }
    outside
}

/// The angle v of a point of the intersection.
fn handle_angle(k: u32) -> f64 {
    TAU * f64::from(k) / f64::from(INTERSECTION_POINTS)
}

/// The torus outside the belly, which it enters a little.
fn handle(height: f64) -> Face {
    let torus = handle_torus(height, HANDLE[1]);
    let end = |k: u32| handle_end(&torus, height, BELLY * (1.0 - OVERLAP), handle_angle(k));
    let upper = (0..=INTERSECTION_POINTS).map(|k| DVec2::new(end(k), handle_angle(k)));
    let lower = (0..=INTERSECTION_POINTS).rev().map(|k| DVec2::new(-end(k), handle_angle(k)));
    let corners: Vec<DVec2> = upper.chain(lower).collect();
    Face { surface: torus, is_reversed: false, loops: vec![polygon(&corners)] }
}

/// Points of the two curves where a slightly thinner handle meets the belly.
fn handle_holes(height: f64) -> Vec<Vec<DVec3>> {
    let torus = handle_torus(height, HANDLE[1] * (1.0 - OVERLAP));
    let hole = |side: f64| {
        let point = |k: u32| {
            let v = handle_angle(k);
            torus.point(DVec2::new(side * handle_end(&torus, height, BELLY, v), v))
        };
        (0..INTERSECTION_POINTS).map(point).collect()
    };
    vec![hole(1.0), hole(-1.0)]
}

/// The closed polygon through points of a surface in its parameter plane.
fn in_parameters(surface: &Surface, points: &[DVec3]) -> TrimLoop {
    let parameters: Vec<DVec2> = points.iter().map(|&point| surface.invert(point, None)).collect();
    polygon(&parameters)
}
