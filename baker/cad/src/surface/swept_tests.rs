//! Laws of surfaces of revolution and extrusion.

use super::Surface;
use crate::curve::Curve;
use crate::frame::Frame;
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;

fn frame() -> Frame {
    Frame::new(DVec3::new(0.3, -1.0, 2.0), DVec3::new(1.0, 2.0, -0.5), DVec3::X).unwrap()
}

/// Swept surfaces, the same in closed form with the same parameters, and a patch.
fn pairs() -> Vec<(Surface, Surface, [DVec2; 2])> {
    let f = frame();
    let line = |from: DVec3, along: DVec3| Curve::Line { origin: f.place(from), direction: f.turn(along) };
    let upright = Frame { origin: f.place(DVec3::X * 2.0), x: f.x, y: f.z, z: -f.y };
    let patch = [DVec2::new(0.2, -0.9), DVec2::new(5.0, 1.2)];
    let slope = 0.4f64;
    vec![
        (
            Surface::Revolution { frame: f, profile: line(DVec3::X * 0.7, DVec3::Z) },
            Surface::Cylinder { frame: f, radius: 0.7 },
            patch,
        ),
        (
            Surface::Revolution {
                frame: f,
                profile: line(DVec3::X * 2.0, DVec3::new(slope.tangent(), 0.0, 1.0)),
            },
            Surface::Cone { frame: f, radius: 2.0, half_angle: slope },
            patch,
        ),
        (
            Surface::Revolution { frame: f, profile: Curve::Circle { frame: upright, radius: 0.5 } },
            Surface::Torus { frame: f, major: 2.0, minor: 0.5 },
            patch,
        ),
        (
            Surface::Extrusion { profile: Curve::Circle { frame: f, radius: 0.7 }, along: f.z },
            Surface::Cylinder { frame: f, radius: 0.7 },
            patch,
        ),
        (Surface::Extrusion { profile: line(DVec3::ZERO, DVec3::X), along: f.y }, Surface::Plane(f), patch),
    ]
}

/// Places of a patch.
fn places([low, high]: [DVec2; 2]) -> impl Iterator<Item = DVec2> {
    (0..400)
        .map(move |k| low + (high - low) * DVec2::new((f64::from(k) * 0.618).fract(), f64::from(k) / 400.0))
}

#[test]
fn they_are_the_closed_forms() {
    for (swept, closed, patch) in pairs() {
        for at in places(patch) {
            for (a, b) in swept.derivatives(at).into_iter().zip(closed.derivatives(at)) {
                assert!(a.distance(b) < 1e-12 * (1.0 + b.length()), "{swept:?} at {at}: {a}, not {b}");
            }
            let found = swept.invert(swept.point(at), Some(at + 0.01));
            assert!(found.distance(at) < 1e-7, "{swept:?}: {found} for {at}");
            let beside = swept.point(at) + 0.05 * swept.normal(at);
            assert!(swept.invert(beside, Some(at)).distance(at) < 1e-5, "{swept:?} beside {at}");
            let [low, high] = swept.bounds(patch);
            let place = swept.point(at);
            assert!(place.cmpge(low - 1e-12).all() && place.cmple(high + 1e-12).all(), "{swept:?}");
        }
    }
}

#[test]
fn a_skew_extrusion_of_an_ellipse_is_inverted() {
    let profile = Curve::Ellipse { frame: frame(), radii: [2.0, 0.7] };
    let surface = Surface::Extrusion { profile, along: frame().turn(DVec3::new(0.4, -0.3, 1.5)) };
    for at in places([DVec2::new(0.1, -1.0), DVec2::new(6.0, 1.0)]) {
        let found = surface.invert(surface.point(at), Some(at + 0.02));
        assert!(found.distance(at) < 1e-6, "{found} for {at}");
        let anywhere = surface.invert(surface.point(at), None);
        assert!(surface.point(anywhere).distance(surface.point(at)) < 1e-6, "{anywhere} for {at}");
    }
}
