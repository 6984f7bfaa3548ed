//! Laws of the scenes: triangles, volumes, closed solids under rays.

use super::{NAMES, assembly, chess, opera, revolved::Profile, teapot, tori};
use crate::cast::CastFace;
use crate::face::Face;
use crate::model::Part;
use crate::random::SplitMix;
use crate::surface::Ray;
use crate::tessellate::{self, Tessellation};
use crate::trim::{TrapezoidalMap, TrimLoop};
use glam::DVec3;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Triangles of a face, with its normals.
fn triangles(face: &Face, chord_error: f64) -> Vec<[DVec3; 3]> {
    let Tessellation { positions, triangles, .. } = tessellate::trimmed(face, chord_error).unwrap();
    let corners = |triangle: [u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
        if face.is_reversed { [a, c, b] } else { [a, b, c] }
    };
    triangles.into_iter().map(corners).collect()
}

fn faces(part: &Part) -> impl Iterator<Item = &Face> {
    part.faces.iter().map(|(face, _)| face)
}

/// Volume within triangles, by the divergence theorem.
fn volume<'a>(faces: impl IntoIterator<Item = &'a Face>, chord_error: f64) -> f64 {
    let of = |[a, b, c]: [DVec3; 3]| a.dot(b.cross(c)) / 6.0;
    faces.into_iter().flat_map(|face| triangles(face, chord_error)).map(of).sum()
}

fn area(outline: &TrimLoop, holes: &[TrimLoop]) -> f64 {
    let loops: Vec<TrimLoop> = std::iter::once(outline).chain(holes).cloned().collect();
    TrapezoidalMap::new(&loops).unwrap().area()
}

fn parts() -> Vec<Part> {
    NAMES.iter().flat_map(|name| assembly(name).unwrap().parts).collect()
}

/// Diagonal of the box about a part's pieces.
fn size(part: &Part) -> f64 {
    let pieces = faces(part).flat_map(|face| CastFace::new(face).unwrap().1);
    let bounds = pieces.map(|piece| piece.bounds);
    let [low, high] = bounds.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).unwrap();
    low.distance(high)
}

#[test]
fn scenes_are_whole() {
    assert!(assembly("kettle").is_none());
    for name in NAMES {
        let scene = assembly(name).unwrap();
        assert!(scene.notes.is_empty() && !scene.instances.is_empty());
        for part in &scene.parts {
            assert!(!part.name.is_empty() && !part.faces.is_empty());
            for (_, colour) in &part.faces {
                let colour = colour.unwrap();
                assert!(colour.min_element() > 0.0 && colour.max_element() <= 0.85);
            }
        }
        let used = |part| scene.instances.iter().any(|instance| instance.part == part);
        assert!((0..scene.parts.len()).all(used));
        assert!(scene.instances.iter().all(|instance| !instance.path.is_empty()));
    }
    let chess = assembly("chess").unwrap();
    assert_eq!((chess.parts.len(), chess.instances.len()), (14, 34));
}

#[test]
fn faces_have_triangles() {
    for part in parts() {
        let chord_error = 2e-3 * size(&part);
        for face in faces(&part) {
            assert!(!triangles(face, chord_error).is_empty(), "{}: {face:?}", part.name);
        }
    }
}

#[test]
fn closed_solids_have_their_volumes() {
    let near = |found: f64, expected: f64, share: f64, what: &str| {
        assert!((found / expected - 1.0).abs() < share, "{what}: {found}, not {expected}");
    };
    for kind in chess::KINDS {
        let (faces, expected) = chess::chessman(kind);
        near(volume(&faces, 4e-6), expected, 4e-3, kind);
    }
    let (faces, expected) = opera::column();
    near(volume(&faces, 1e-3), expected, 4e-3, "column");
    let [major, minor] = tori::RADII;
    let whole = assembly("tori").unwrap().parts.into_iter().find(|part| part.name == "whole").unwrap();
    near(volume(faces_of(&whole), 2e-4), TAU * PI * major * minor * minor, 4e-3, "torus");
    near(volume(&opera::wall(), 1e-3), 0.7 * area(&opera::front(), &opera::openings()), 1e-3, "wall");
    let (outline, window) = opera::gable();
    near(volume(&opera::pediment(), 1e-3), opera::PEDIMENT * area(&outline, &[window]), 1e-3, "pediment");
    near(volume(&opera::cornice(30.0, 0.9), 1e-4), 30.0 * area(&opera::moulding(0.9), &[]), 1e-3, "cornice");
    let board = 0.02 * (8.0f64 * 0.055 + 0.06).powi(2);
    let part = assembly("chess").unwrap().parts.swap_remove(0);
    near(volume(faces_of(&part), 1e-3), board, 1e-12, "board");
}

fn faces_of(part: &Part) -> Vec<&Face> {
    faces(part).collect()
}

/// The teapot is its solid of revolution, and what of the spout and the handle is outside the belly.
#[test]
fn a_teapot_has_its_volume() {
    let (faces, revolved) = teapot::teapot();
    let [foot, mouth, reach] = teapot::SPOUT;
    let length = teapot::spout_length();
    let cone = PI / 3.0 * length * (foot * foot + foot * mouth + mouth * mouth);
    // The cap of the belly within the cone.
    let high = teapot::BELLY - (reach - length);
    let cap = PI / 3.0 * high * high * (3.0 * teapot::BELLY - high);
    let [major, minor, distance] = teapot::HANDLE;
    // By Pappus's theorem, to the angle at which the middle of the tube enters the belly.
    let cosine = (teapot::BELLY.powi(2) - distance * distance - major * major) / (2.0 * distance * major);
    let handle = PI * minor * minor * major * 2.0 * cosine.arc_cosine();
    let expected = revolved + cone - cap + handle;
    let found = volume(&faces, 2e-5);
    assert!(handle > 0.01 * expected && cone > 0.01 * expected);
    assert!((found / expected - 1.0).abs() < 3e-3, "{found}, not {expected}");
}

#[test]
fn closed_parts_have_positive_volumes() {
    for part in parts().iter().filter(|part| part.is_closed) {
        assert!(volume(faces(part), 2e-3 * size(part)) > 0.0, "{}", part.name);
    }
}

/// From points inside a closed solid, all rays hit, and from behind the normal.
#[test]
fn closed_parts_let_no_ray_out() {
    let mut random = SplitMix(11);
    for part in parts().iter().filter(|part| part.is_closed) {
        let cast: Vec<_> = faces(part).map(|face| CastFace::new(face).unwrap()).collect();
        let nearest = |ray: &Ray| {
            let hits = cast.iter().flat_map(|(face, pieces)| {
                let near = |piece| face.nearest(piece, ray, &mut None, [0.0, f64::INFINITY], |_| true);
                pieces.iter().filter_map(near).map(|hit| (hit.distance, face.normal(hit.at)))
            });
            hits.min_by(|a, b| a.0.total_cmp(&b.0))
        };
        // A little behind the middles of triangles, where the triangles wind about the point once.
        let scale = size(part);
        let all: Vec<_> = faces(part).flat_map(|face| triangles(face, 2e-3 * scale)).collect();
        let step = (all.len() / 60).max(1);
        let inner = all.iter().step_by(step).filter_map(|[a, b, c]| {
            let normal = (b - a).cross(c - a).try_normalize()?;
            let point = (a + b + c) / 3.0 - 4e-3 * scale * normal;
            ((winding(&all, point) - 1.0).abs() < 0.1).then_some(point)
        });
        let inner: Vec<DVec3> = inner.collect();
        assert!(inner.len() > 5, "{}: {}", part.name, inner.len());
        for k in 0..400 {
            let ray = Ray { origin: inner[k % inner.len()], direction: random.direction() };
            let hit = nearest(&ray);
            assert!(hit.is_some_and(|(_, normal)| normal.dot(ray.direction) > 0.0), "{}: {ray:?}", part.name);
        }
    }
}

/// How often triangles wind about a point: their solid angles (van Oosterom and Strackee 1983) over 4π.
fn winding(triangles: &[[DVec3; 3]], point: DVec3) -> f64 {
    let angle = |corners: &[DVec3; 3]| {
        let [a, b, c] = corners.map(|corner| corner - point);
        let [x, y, z] = [a, b, c].map(DVec3::length);
        let below = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
        2.0 * a.dot(b.cross(c)).arc_tangent2(below)
    };
    triangles.iter().map(angle).sum::<f64>() / (2.0 * TAU)
}

#[test]
fn profiles_have_their_closed_volumes() {
    let ball = Profile::about_y(0.0, -0.3).arc(0.0, 0.0, PI).finish();
    let cylinder = Profile::about_y(0.0, 0.0).to(0.5, 0.0).to(0.5, 2.0).to(0.0, 2.0).finish();
    let cone = Profile::about_y(0.0, 0.0).to(0.6, 0.0).to(0.0, 1.0).finish();
    let bowl = Profile::about_y(0.0, 0.0).to(1.0, 0.0).arc(0.0, 0.0, FRAC_PI_2).finish();
    let expected = [4.0 / 3.0 * PI * 0.027, PI * 0.5, PI * 0.12, 2.0 / 3.0 * PI];
    for ((faces, volume_of), expected) in [ball, cylinder, cone, bowl].into_iter().zip(expected) {
        assert!((volume_of - expected).abs() < 1e-12);
        assert!((volume(&faces, 1e-4) / expected - 1.0).abs() < 2e-3);
    }
}
