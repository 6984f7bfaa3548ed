//! Trimmed tori in a box.

use super::loops::{circle, ellipse, polygon, quad, rectangle};
use super::{add, coloured, instance, once};
use crate::face::Face;
use crate::frame::Frame;
use crate::frame::unit;
use crate::model::Assembly;
use crate::surface::Surface;
use crate::trim::TrimLoop;
use glam::{DAffine3, DMat3, DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Major and minor radius, metres.
pub(super) const RADII: [f64; 2] = [0.5, 0.18];

/// Tori on the floor of a box of 4 by 1.8 by 3 metres, which is open at the top and towards +z. A closed torus, and tori cut open
/// by loops in the parameter plane, which have an inside to be seen.
pub(super) fn assembly() -> Assembly {
    let mut scene = Assembly::default();
    let white = [0.74, 0.73, 0.7];
    let [x, y, z] = [[4.0, 0.0, 0.0], [0.0, 1.8, 0.0], [0.0, 0.0, 3.0]];
    let low = [-2.0, 0.0, -1.5];
    let mut shell = coloured(vec![quad(low, z, x), quad(low, x, y)], white);
    shell.extend(coloured(vec![quad(low, y, z)], [0.63, 0.06, 0.05]));
    shell.extend(coloured(vec![quad([2.0, 0.0, -1.5], z, y)], [0.14, 0.45, 0.09]));
    once(&mut scene, "box", shell, false, [0.0; 3]);

    let whole = vec![rectangle(DVec2::ZERO, DVec2::splat(TAU))];
    let tori: [(&str, Vec<TrimLoop>, bool, [f32; 3]); 5] = [
        ("whole", whole, true, [0.7, 0.5, 0.12]),
        ("windows", windows(), false, [0.2, 0.4, 0.7]),
        ("ribbons", ribbons(), false, [0.72, 0.3, 0.15]),
        ("half", vec![rectangle(DVec2::new(0.0, PI), DVec2::splat(TAU))], false, [0.6, 0.6, 0.62]),
        ("stars", stars(), false, [0.3, 0.55, 0.5]),
    ];
    // Places on the floor, and whether the torus stands on its edge, turned about the upright by an angle.
    let stands = [
        ([-1.3, -0.9], None),
        ([0.0, -0.7], Some(0.3)),
        ([1.3, -0.8], None),
        ([-0.8, 0.5], None),
        ([0.8, 0.5], Some(-0.6)),
    ];
    for ((name, loops, is_closed, colour), ([x, z], turn)) in tori.into_iter().zip(stands) {
        let part = add(&mut scene, name, coloured(vec![torus(loops)], colour), is_closed);
        let placed = match turn {
            None => DAffine3::from_translation(DVec3::new(x, RADII[1], z)),
            Some(turn) => {
                // A quarter turn about x, then the turn about y.
                let (sine, cosine) = turn.sine_cosine();
                let [x_axis, z_axis] = [DVec3::new(cosine, 0.0, -sine), DVec3::new(sine, 0.0, cosine)];
                let upright = DMat3::from_cols(x_axis, z_axis, DVec3::NEG_Y);
                let rise = RADII[0] + RADII[1];
                DAffine3::from_mat3_translation(upright, DVec3::new(x, rise, z))
            }
        };
        instance(&mut scene, part, name.into(), placed);
    }
    scene
}

/// A torus about the y axis with these loops.
fn torus(loops: Vec<TrimLoop>) -> Face {
    let frame = Frame { origin: DVec3::ZERO, x: DVec3::Z, y: DVec3::X, z: DVec3::Y };
    Face { surface: Surface::Torus { frame, major: RADII[0], minor: RADII[1] }, is_reversed: false, loops }
}

/// The whole, with 12 by 4 elliptical openings in staggered rows.
fn windows() -> Vec<TrimLoop> {
    let mut loops = vec![rectangle(DVec2::ZERO, DVec2::splat(TAU))];
    for row in 0..4 {
        for column in 0..12 {
            let shift = if row % 2 == 0 { 0.25 } else { 0.75 };
            let centre =
                DVec2::new(TAU * (f64::from(column) + shift) / 12.0, TAU * (f64::from(row) + 0.5) / 4.0);
            // Round in space, where v is 0 or π the circle about the axis is longer or shorter.
            let circumference = RADII[0] + RADII[1] * centre.y.cosine();
            let size = 0.11 * RADII[1] / 0.18;
            let radii = DVec2::new((0.9 * size / circumference).min(0.22), 0.9 * size / RADII[1]);
            loops.push(ellipse(centre, radii));
        }
    }
    loops
}

/// Bands that wind once about the tube on their way round the axis, cut at the ends of the periods.
fn ribbons() -> Vec<TrimLoop> {
    let (bands, share) = (5, 0.6);
    let mut loops = Vec::new();
    for band in 0..bands {
        let begin = TAU * f64::from(band) / f64::from(bands);
        let width = share * TAU / f64::from(bands);
        // v = begin + u: up to the end of the period of v, and the rest a period below.
        let at = |u: f64, v: f64| DVec2::new(u, v);
        let (low, high) = (begin, begin + width);
        loops.push(polygon(&[at(0.0, low), at(TAU - low, TAU), at(TAU - high, TAU), at(0.0, high)]));
        loops.push(polygon(&[at(TAU - low, 0.0), at(TAU, low), at(TAU, high), at(TAU - high, 0.0)]));
    }
    loops
}

/// The whole, with stars of five points cut out and discs left in the middle of them.
fn stars() -> Vec<TrimLoop> {
    let mut loops = vec![rectangle(DVec2::ZERO, DVec2::splat(TAU))];
    for (column, row) in (0..8).flat_map(|column| (0..2).map(move |row| (column, row))) {
        let centre = DVec2::new(TAU * (f64::from(column) + 0.5) / 8.0, PI * (f64::from(row) + 0.5));
        let corner = |k: u32| {
            let radii = if k.is_multiple_of(2) { DVec2::new(0.32, 1.1) } else { DVec2::new(0.14, 0.5) };
            let angle = FRAC_PI_2 + PI * f64::from(k) / 5.0;
            centre + radii * unit(angle)
        };
        loops.push(polygon(&(0..10).map(corner).collect::<Vec<_>>()));
        loops.push(circle(centre, 0.08));
    }
    loops
}
