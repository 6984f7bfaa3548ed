//! The front of an opera.

use super::loops::{arch, circle, frame_of, polygon, quad};
use super::prism::prism;
use super::revolved::Profile;
use super::{add, coloured, instance, once};
use crate::face::Face;
use crate::model::Assembly;
use crate::trim::{TrimEdge, TrimLoop};
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Width of the front and its height up to the main cornice, metres.
const FRONT: [f64; 2] = [30.0, 13.0];
/// Thickness of the front wall; its outer face is at z = 0.
const WALL: f64 = 0.7;
/// Bays, each with a door or window on every storey.
pub(super) const BAYS: u32 = 9;
/// Height of the steps in front.
const PLINTH: f64 = 0.9;
/// Height and mean radius of a column.
const COLUMN: [f64; 2] = [5.2, 0.42];

/// The front, without building behind it but for a dark plane at 2 m, on a square; it looks along +z, and is open to the sides.
pub(super) fn assembly() -> Assembly {
    let mut scene = Assembly::default();
    let [width, height] = FRONT;
    let stone = [0.62, 0.56, 0.45];
    once(&mut scene, "wall", coloured(wall(), stone), true, [0.0, PLINTH, 0.0]);
    once(&mut scene, "steps", coloured(steps(), [0.45, 0.43, 0.4]), true, [0.0; 3]);

    let low = add(&mut scene, "cornice", coloured(cornice(width, 0.45), stone), true);
    let high = add(&mut scene, "main cornice", coloured(cornice(width + 0.6, 0.9), stone), true);
    for (part, name, y) in
        [(low, "cornice of the ground floor", PLINTH + 5.6), (high, "main cornice", PLINTH + height - 0.9)]
    {
        instance(&mut scene, part, name.into(), DAffine3::from_translation(DVec3::new(0.0, y, 0.0)));
    }
    once(&mut scene, "pediment", coloured(pediment(), stone), true, [0.0, PLINTH + height, 0.2]);

    let part = add(&mut scene, "column", coloured(column().0, [0.7, 0.66, 0.58]), true);
    for k in 0..=BAYS {
        let x = (f64::from(k) / f64::from(BAYS) - 0.5) * (width - 1.6);
        let at = DVec3::new(x, PLINTH + 6.05, 0.75);
        instance(&mut scene, part, format!("column {}", k + 1), DAffine3::from_translation(at));
    }
    // The columns stand on a balcony.
    let balcony = balcony();
    once(&mut scene, "balcony", coloured(balcony, stone), true, [0.0, PLINTH + 5.75, 0.25]);
    let back = quad([-0.5 * width, 0.0, -2.0], [width, 0.0, 0.0], [0.0, height + PLINTH, 0.0]);
    once(&mut scene, "rooms behind", coloured(vec![back], [0.06, 0.05, 0.05]), false, [0.0; 3]);
    let square = quad([-24.0, 0.0, 30.0], [48.0, 0.0, 0.0], [0.0, 0.0, -33.0]);
    once(&mut scene, "square", coloured(vec![square], [0.3, 0.29, 0.28]), false, [0.0; 3]);
    scene
}

/// Openings of the front wall, counterclockwise: arched doors and windows, round windows over them.
pub(super) fn openings() -> Vec<TrimLoop> {
    let mut openings = Vec::new();
    for k in 0..BAYS {
        let x = ((f64::from(k) + 0.5) / f64::from(BAYS) - 0.5) * (FRONT[0] - 1.6);
        // Doors in the three bays of the middle, windows beside them.
        let is_door = k.abs_diff(BAYS / 2) <= 1;
        let (sill, tall) = if is_door { (0.05, 3.4) } else { (1.1, 2.35) };
        openings.push(arch(DVec2::new(x, sill), 1.9, tall));
        openings.push(arch(DVec2::new(x, 6.9), 1.5, 2.6));
        openings.push(circle(DVec2::new(x, 11.2), 0.45));
    }
    openings
}

/// Outline of the front wall, its sill in the middle.
pub(super) fn front() -> TrimLoop {
    let [width, height] = FRONT;
    polygon(
        &[[-0.5, 0.0], [0.5, 0.0], [0.5, 1.0], [-0.5, 1.0]].map(|[x, y]| DVec2::new(x * width, y * height)),
    )
}

/// The front wall: two planar faces with all openings as holes, and the reveals of the openings.
pub(super) fn wall() -> Vec<Face> {
    prism(&frame_of(DVec3::NEG_Z * WALL, DVec3::X, DVec3::Y), &front(), &openings(), WALL)
}

/// Five steps over the width of the front.
pub(super) fn steps() -> Vec<Face> {
    let count = 5u32;
    let [rise, tread] = [PLINTH / f64::from(count), 0.42];
    let mut corners = vec![DVec2::new(-WALL, 0.0), DVec2::new(1.6 + f64::from(count - 1) * tread, 0.0)];
    for step in 0..count {
        let x = 1.6 + f64::from(count - 1 - step) * tread;
        let y = f64::from(step) * rise;
        if step > 0 {
            corners.push(DVec2::new(x, y));
        }
        corners.push(DVec2::new(x, y + rise));
    }
    corners.push(DVec2::new(-WALL, PLINTH));
    along(&polygon(&corners), FRONT[0])
}

/// The prism of an outline with z to the right and y up, in the middle of its length along x.
fn along(outline: &TrimLoop, length: f64) -> Vec<Face> {
    // Seen from -x, with z to the right, the extrusion comes towards the eye.
    let frame = frame_of(DVec3::X * (0.5 * length), DVec3::Z, DVec3::Y);
    prism(&frame, outline, &[], length)
}

/// Outline of a cornice, which stands out as far as it is high: a fillet, a cyma of two quarter ellipses, and another fillet.
pub(super) fn moulding(size: f64) -> TrimLoop {
    let at = |x: f64, y: f64| size * DVec2::new(x, y);
    let radii = at(0.4, 0.35);
    let segment = |from: DVec2, to: DVec2| TrimEdge::Segment { from, to };
    vec![
        segment(at(0.0, 0.0), at(0.2, 0.0)),
        segment(at(0.2, 0.0), at(0.2, 0.1)),
        // Convex, then concave.
        TrimEdge::Arc { centre: at(0.2, 0.45), radii, angles: [-FRAC_PI_2, 0.0] },
        TrimEdge::Arc { centre: at(1.0, 0.45), radii, angles: [PI, FRAC_PI_2] },
        segment(at(1.0, 0.8), at(1.0, 1.0)),
        segment(at(1.0, 1.0), at(0.0, 1.0)),
        segment(at(0.0, 1.0), at(0.0, 0.0)),
    ]
}

/// A cornice along the front.
pub(super) fn cornice(length: f64, size: f64) -> Vec<Face> {
    along(&moulding(size), length)
}

/// Outline of the pediment and its round window.
pub(super) fn gable() -> (TrimLoop, TrimLoop) {
    let half = 0.2 * FRONT[0];
    let corners = [[-half, 0.0], [half, 0.0], [half, 0.4], [0.0, 3.2], [-half, 0.4]].map(DVec2::from_array);
    (polygon(&corners), circle(DVec2::new(0.0, 1.35), 0.7))
}

/// Thickness of the pediment.
pub(super) const PEDIMENT: f64 = 0.8;

/// A gable with a round window.
pub(super) fn pediment() -> Vec<Face> {
    let (outline, window) = gable();
    prism(&frame_of(DVec3::NEG_Z * PEDIMENT, DVec3::X, DVec3::Y), &outline, &[window], PEDIMENT)
}

/// A slab of five sides on which the columns stand, with rounded corners.
pub(super) fn balcony() -> Vec<Face> {
    let (half, deep, round) = (0.5 * FRONT[0], 1.1, 0.5);
    let segment = |from: [f64; 2], to: [f64; 2]| TrimEdge::Segment { from: from.into(), to: to.into() };
    let corner = |x: f64, angles: [f64; 2]| TrimEdge::Arc {
        centre: DVec2::new(x, round - deep),
        radii: DVec2::splat(round),
        angles,
    };
    let outline = vec![
        corner(round - half, [PI, 1.5 * PI]),
        segment([round - half, -deep], [half - round, -deep]),
        corner(half - round, [-FRAC_PI_2, 0.0]),
        segment([half, round - deep], [half, 0.0]),
        segment([half, 0.0], [-half, 0.0]),
        segment([-half, 0.0], [-half, round - deep]),
    ];
    prism(&frame_of(DVec3::ZERO, DVec3::X, DVec3::NEG_Z), &outline, &[], 0.3)
}

/// A column with its base and capital of tori and rings, and its volume.
pub(super) fn column() -> (Vec<Face>, f64) {
    let [height, radius] = COLUMN;
    let profile = Profile::about_y(0.0, 0.0).to(1.4 * radius, 0.0).to(1.4 * radius, 0.15);
    // Base: a torus, a hollow, a smaller torus.
    let profile = profile.to(1.25 * radius, 0.15).arc(1.25 * radius, 0.25, PI).to(1.2 * radius, 0.35);
    let profile = profile.arc(1.2 * radius, 0.41, -PI).arc(1.2 * radius, 0.53, PI);
    let profile = profile.to(1.03 * radius, 0.59);
    // The shaft narrows, and the capital widens in a quarter of a circle.
    let profile = profile.to(0.9 * radius, height - 0.55).to(radius, height - 0.55).to(radius, height - 0.45);
    let profile = profile.to(0.95 * radius, height - 0.45).arc(1.45 * radius, height - 0.45, -FRAC_PI_2);
    let [wide, _] = profile.end();
    profile.to(wide, height).to(0.0, height).finish()
}
