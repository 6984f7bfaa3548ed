//! Laws of the surfaces with a closed form.

mod evaluate;
mod meet;
mod torus;

use super::*;
use crate::random::SplitMix;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_PI_2, PI};

/// A surface, its size, and a patch that holds what a test looks at.
struct Case {
    name: &'static str,
    surface: Surface,
    size: f64,
    patch: [DVec2; 2],
}

fn case(name: &'static str, surface: Surface, size: f64, u: [f64; 2], v: [f64; 2]) -> Case {
    Case { name, surface, size, patch: [DVec2::new(u[0], v[0]), DVec2::new(u[1], v[1])] }
}

/// Surfaces of all kinds, each turned and moved at random.
fn cases() -> Vec<Case> {
    let mut random = SplitMix(1);
    let mut frame = || random.frame();
    let turn = [0.0, TAU];
    let cone = |frame, radius, half_angle| Surface::Cone { frame, radius, half_angle };
    let torus = |frame, major, minor| Surface::Torus { frame, major, minor };
    vec![
        case("plane", Surface::Plane(frame()), 2.0, [-2.0, 2.0], [-2.0, 2.0]),
        case("cylinder", Surface::Cylinder { frame: frame(), radius: 0.7 }, 1.0, turn, [-2.0, 2.0]),
        case("cone", cone(frame(), 0.4, 0.5), 1.0, turn, [-2.0, 2.0]),
        case("cone from its apex", cone(frame(), 0.0, 0.8), 1.0, turn, [0.0, 2.0]),
        case("flat cone", cone(frame(), 0.3, 1.5), 1.0, turn, [-0.1, 0.1]),
        case("narrow cone", cone(frame(), 0.3, 1e-6), 1.0, turn, [-2.0, 2.0]),
        case("sphere", Surface::Sphere { frame: frame(), radius: 1.3 }, 1.3, turn, [-FRAC_PI_2, FRAC_PI_2]),
        case("torus", torus(frame(), 1.0, 0.4), 1.4, turn, turn),
        case("thin torus", torus(frame(), 1.0, 0.01), 1.0, turn, turn),
        case("horn torus", torus(frame(), 0.7, 0.7), 1.4, turn, turn),
        case("apple", torus(frame(), 0.5, 0.9), 1.4, turn, outer([0.5, 0.9])),
        case("nearly a sphere", torus(frame(), 0.01, 1.0), 1.0, turn, outer([0.01, 1.0])),
    ]
}

/// Range of v of the outer part of a torus.
fn outer([major, minor]: [f64; 2]) -> [f64; 2] {
    let pole = (-major / minor).arc_cosine();
    [-pole, pole]
}

fn frame_of(surface: &Surface) -> Frame {
    match surface {
        Surface::Plane(frame)
        | Surface::Cylinder { frame, .. }
        | Surface::Cone { frame, .. }
        | Surface::Sphere { frame, .. }
        | Surface::Torus { frame, .. } => *frame,
        _ => Frame::default(),
    }
}
