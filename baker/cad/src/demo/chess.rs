//! A chess set.

use super::loops::{circle, frame_of, planar, polygon, quad, rectangle};
use super::prism::prism;
use super::revolved::Profile;
use super::{add, coloured, instance, once};
use crate::curve::{Curve, NurbsCurve};
use crate::face::Face;
use crate::frame::Frame;
use crate::model::{Assembly, FaceColour};
use crate::trim::{TrimEdge, TrimLoop};
use glam::{DAffine3, DMat3, DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_PI_2, PI};

/// Side of a square, metres.
const SQUARE: f64 = 0.055;
/// Width of the board's border, and its height.
const BORDER: [f64; 2] = [0.03, 0.02];
/// Kinds of chessmen.
pub(super) const KINDS: [&str; 6] = ["rook", "knight", "bishop", "queen", "king", "pawn"];
/// Kinds of the first row, as indices.
const ROW: [usize; 8] = [0, 1, 2, 3, 4, 2, 1, 0];

/// The set in its first position on a board, which lies on a table top without room. White stands towards +z.
pub(super) fn assembly() -> Assembly {
    let mut scene = Assembly::default();
    once(&mut scene, "board", board(), true, [0.0; 3]);
    let table = quad([-0.5, 0.0, 0.45], [1.0, 0.0, 0.0], [0.0, 0.0, -0.9]);
    once(&mut scene, "table top", coloured(vec![table], [0.3, 0.2, 0.13]), false, [0.0, -BORDER[1], 0.0]);
    for (side, colour) in [("white", [0.74, 0.66, 0.5]), ("black", [0.09, 0.06, 0.05])] {
        let is_white = side == "white";
        let parts = KINDS
            .map(|kind| add(&mut scene, &format!("{side} {kind}"), coloured(chessman(kind).0, colour), true));
        for (column, &officer) in ROW.iter().enumerate() {
            for (row, kind) in [(0.0, officer), (1.0, 5)] {
                let name = format!("{side} {} {}", KINDS[kind], column + 1);
                let square = |at: f64| (at - 3.5) * SQUARE;
                let row = if is_white { 7.0 - row } else { row };
                let at = DVec3::new(square(column as f64), 0.0, square(row));
                // Knights look at the other side.
                let turn = if is_white {
                    DMat3::from_diagonal(DVec3::new(-1.0, 1.0, -1.0))
                } else {
                    DMat3::IDENTITY
                };
                instance(&mut scene, parts[kind], name, DAffine3::from_mat3_translation(turn, at));
            }
        }
    }
    scene
}

/// The closed board, its squares at y = 0.
fn board() -> Vec<(Face, FaceColour)> {
    let half = 4.0 * SQUARE;
    let edge = half + BORDER[0];
    let below = frame_of(DVec3::NEG_Y * BORDER[1], DVec3::X, DVec3::NEG_Z);
    let outline = rectangle(DVec2::splat(-edge), DVec2::splat(edge));
    let mut faces = prism(&below, &outline, &[], BORDER[1]);
    faces[0].loops.push(rectangle(DVec2::splat(-half), DVec2::splat(half)));
    let mut faces = coloured(faces, [0.2, 0.09, 0.05]);
    let top = frame_of(DVec3::ZERO, DVec3::X, DVec3::NEG_Z);
    for (row, column) in (0..8).flat_map(|row| (0..8).map(move |column| (row, column))) {
        let low = DVec2::new(f64::from(column) - 4.0, f64::from(row) - 4.0) * SQUARE;
        let square = planar(top, vec![rectangle(low, low + SQUARE)]);
        let is_dark = (row + column) % 2 == 0;
        faces.extend(coloured(vec![square], if is_dark { [0.14, 0.07, 0.04] } else { [0.72, 0.6, 0.42] }));
    }
    faces
}

/// Faces of a chessman that stands on the plane y = 0, and its volume.
pub(super) fn chessman(kind: &str) -> (Vec<Face>, f64) {
    match kind {
        "rook" => {
            let profile = base(0.019, 0.008, [0.0125, 0.0105], 0.034).to(0.0155, 0.036).to(0.0155, 0.05);
            profile.to(0.0115, 0.05).to(0.0115, 0.045).to(0.0, 0.045).finish()
        }
        "knight" => {
            let profile = base(0.019, 0.008, [0.0135, 0.0125], 0.016);
            crowned(profile, &horse(), 0.009)
        }
        "bishop" => {
            let profile = base(0.019, 0.008, [0.012, 0.0065], 0.042);
            let profile = collar(profile, 0.0025);
            // A mitre: an arc about a centre beyond the axis, and a ball on its top.
            let [radius, height] = profile.end();
            let (beyond, size) = (0.006, radius + 0.0095);
            let begin = -((beyond + radius) / size).arc_cosine();
            let end = ((beyond + 0.0015) / size).arc_cosine();
            let rise = -size * begin.sine();
            let profile = profile.arc(-beyond, height + rise, end - begin);
            ball(profile, 0.003).finish()
        }
        "queen" => {
            let profile = collar(base(0.021, 0.009, [0.0135, 0.0065], 0.056), 0.003);
            let [radius, height] = profile.end();
            let profile = profile.to(radius + 0.0055, height + 0.014).to(radius + 0.003, height + 0.014);
            // The bowl of the crown, and a ball in it.
            let profile = profile.to(0.004, height + 0.0115);
            ball(profile, 0.0052).finish()
        }
        "king" => {
            let profile = collar(base(0.021, 0.009, [0.014, 0.007], 0.062), 0.003);
            let [radius, height] = profile.end();
            let profile = profile.to(radius + 0.0045, height + 0.016).to(0.005, height + 0.0205);
            crowned(profile, &cross(), 0.004)
        }
        _ => {
            let profile = collar(base(0.016, 0.007, [0.01, 0.0055], 0.026), 0.002);
            ball(profile, 0.0095).finish()
        }
    }
}

/// A foot of a cylinder and a quarter of a torus, and a stem, a NURBS curve from one radius to the other, up to a height.
fn base(foot: f64, tall: f64, stem: [f64; 2], height: f64) -> Profile {
    let round = 0.4 * tall;
    let profile = Profile::about_y(0.0, 0.0).to(foot, 0.0).to(foot, tall - round);
    let profile = profile.arc(foot - round, tall - round, FRAC_PI_2).to(stem[0], tall);
    let rise = height - tall;
    let poles = [
        DVec2::new(stem[0], tall),
        DVec2::new(0.85 * stem[0], tall + 0.15 * rise),
        DVec2::new(0.9 * stem[1], tall + 0.45 * rise),
        DVec2::new(0.95 * stem[1], tall + 0.8 * rise),
        DVec2::new(stem[1], height),
    ];
    profile.curve(0.0, 0.0, [0.0, 2.0], |frame| spline(&frame, &poles))
}

/// A cubic B-spline with these control points in a frame's plane, parameters from 0 to 2.
fn spline(frame: &Frame, poles: &[DVec2; 5]) -> Curve {
    Curve::Nurbs(NurbsCurve {
        degree: 3,
        knots: vec![0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0, 2.0],
        poles: poles.iter().map(|pole| frame.place(pole.extend(0.0))).collect(),
        weights: vec![1.0; 5],
    })
}

/// A ring, half a torus, and a narrower neck on it.
fn collar(profile: Profile, size: f64) -> Profile {
    let [radius, height] = profile.end();
    let profile = profile.to(radius + size, height).arc(radius + size, height + size, PI);
    profile.to(0.8 * radius, height + 2.0 * size)
}

/// A ball on the axis, from the profile's end to the axis.
fn ball(profile: Profile, size: f64) -> Profile {
    let [radius, height] = profile.end();
    let rise = (size * size - radius * radius).sqrt();
    profile.arc(0.0, height + rise, FRAC_PI_2 + rise.arc_tangent2(radius))
}

/// A flat top on the profile's end, and on it an upright prism of an outline whose first edge is its foot.
fn crowned(profile: Profile, outline: &TrimLoop, depth: f64) -> (Vec<Face>, f64) {
    let [radius, height] = profile.end();
    let (mut faces, volume) = profile.finish();
    let [from, to] = outline[0].ends();
    let half = 0.5 * depth;
    let top = frame_of(DVec3::Y * height, DVec3::Z, DVec3::X);
    let foot = rectangle(DVec2::new(from.x, -half), DVec2::new(to.x, half));
    faces.push(planar(top, vec![circle(DVec2::ZERO, radius), foot]));
    let upright = frame_of(DVec3::new(half, height, 0.0), DVec3::Z, DVec3::Y);
    let mut crown = prism(&upright, outline, &[], depth);
    // The side of the first edge, after front and back, is inside the solid.
    crown.remove(2);
    faces.extend(crown);
    let area: f64 = outline.iter().map(|edge| edge.swept_area(DVec2::ZERO)).sum();
    (faces, volume + depth * area)
}

/// A horse's head that looks along x.
fn horse() -> TrimLoop {
    let corners = [
        [-0.009, 0.0],
        [0.009, 0.0],
        [0.0075, 0.008],
        [0.004, 0.0125],
        [0.0115, 0.012],
        [0.0135, 0.0165],
        [0.0045, 0.0245],
        [0.003, 0.0285],
        [0.0, 0.0255],
    ];
    let mut edges = polygon(&corners.map(DVec2::from_array));
    // The mane, in place of the segment that closes the polygon.
    edges.pop();
    let radii = DVec2::new(0.009, 0.0255);
    edges.push(TrimEdge::Arc { centre: DVec2::ZERO, radii, angles: [FRAC_PI_2, PI] });
    edges
}

/// A cross.
fn cross() -> TrimLoop {
    let (arm, half) = (0.004, 0.0015);
    let (low, high, top) = (0.004, 0.0065, 0.0095);
    polygon(
        &[
            [-half, 0.0],
            [half, 0.0],
            [half, low],
            [arm, low],
            [arm, high],
            [half, high],
            [half, top],
            [-half, top],
            [-half, high],
            [-arm, high],
            [-arm, low],
            [-half, low],
        ]
        .map(DVec2::from_array),
    )
}
