//! Laws of faces under rays.

use super::CastFace;
use crate::curve::Curve;
use crate::face::Face;
use crate::frame::Frame;
use crate::random::SplitMix;
use crate::surface::{Ray, Surface, SurfaceHit};
use crate::trim::TrimEdge;
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{PI, TAU};

fn rectangle(low: DVec2, high: DVec2) -> Vec<TrimEdge> {
    let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    (0..4).map(|k| TrimEdge::Segment { from: corners[k], to: corners[(k + 1) % 4] }).collect()
}

fn circle(centre: DVec2, radius: f64) -> Vec<TrimEdge> {
    vec![TrimEdge::Arc { centre, radii: DVec2::splat(radius), angles: [0.0, TAU] }]
}

fn frame() -> Frame {
    Frame::new(DVec3::new(0.1, -0.2, 0.3), DVec3::new(0.5, 1.0, -0.3), DVec3::X).unwrap()
}

fn face(surface: Surface, low: DVec2, high: DVec2, hole: Option<(DVec2, f64)>) -> Face {
    let mut loops = vec![rectangle(low, high)];
    loops.extend(hole.map(|(centre, radius)| circle(centre, radius)));
    Face { surface, is_reversed: false, loops }
}

/// The nearest meeting of all pieces; all of them are looked at.
fn nearest(face: &Face, rays: &[Ray]) -> Vec<Option<(SurfaceHit, DVec3)>> {
    let (cast, pieces) = CastFace::new(face).unwrap();
    let of = |ray: &Ray| {
        let found = pieces
            .iter()
            .filter_map(|piece| cast.nearest(piece, ray, &mut None, [0.0, f64::INFINITY], |_| true));
        let best = found.min_by(|a, b| a.distance.total_cmp(&b.distance))?;
        Some((best, cast.normal(best.at)))
    };
    rays.iter().map(of).collect()
}

fn rays(count: usize) -> Vec<Ray> {
    let mut random = SplitMix(7);
    (0..count)
        .map(|_| {
            let origin = random.place(4.0);
            Ray { origin, direction: random.place(1.5) - origin }
        })
        .collect()
}

#[test]
fn a_trimmed_face_is_met_where_the_whole_surface_is_met_within_its_loops() {
    let profile = Curve::Line { origin: DVec3::X * 0.8, direction: DVec3::Z };
    let kinds = [
        (Surface::Plane(frame()), DVec2::splat(-1.0), DVec2::new(1.2, 0.9), DVec2::new(0.1, 0.2), 0.5),
        (
            Surface::Cylinder { frame: frame(), radius: 0.8 },
            DVec2::new(0.3, -1.0),
            DVec2::new(5.9, 1.0),
            DVec2::new(2.0, 0.1),
            0.6,
        ),
        (
            Surface::Sphere { frame: frame(), radius: 1.1 },
            DVec2::new(0.0, -0.5 * PI),
            DVec2::new(TAU, 0.5 * PI),
            DVec2::new(3.0, 0.3),
            0.7,
        ),
        (
            Surface::Torus { frame: frame(), major: 1.0, minor: 0.35 },
            DVec2::ZERO,
            DVec2::splat(TAU),
            DVec2::new(4.0, 2.0),
            1.5,
        ),
        (
            Surface::Extrusion { profile: profile.clone(), along: DVec3::Y },
            DVec2::splat(-0.9),
            DVec2::splat(1.0),
            DVec2::new(0.2, 0.1),
            0.4,
        ),
    ];
    let rays = rays(4000);
    for (surface, low, high, middle, radius) in kinds {
        let trimmed = face(surface.clone(), low, high, Some((middle, radius)));
        let (cast, _) = CastFace::new(&trimmed).unwrap();
        let all = [face(surface.clone(), low, high, None), trimmed.clone()].map(|face| nearest(&face, &rays));
        let (mut hits, mut through) = (0, 0);
        for (k, ray) in rays.iter().enumerate() {
            // From hit to hit of the whole until one is within the loops.
            let (mut from, mut wanted) = (0.0, None);
            for _ in 0..6 {
                let ahead = Ray { origin: ray.origin + from * ray.direction, ..*ray };
                let whole = face(surface.clone(), low, high, None);
                let Some((meeting, _)) = nearest(&whole, &[ahead])[0] else { break };
                let distance = from + meeting.distance;
                if cast.map().contains(meeting.at) {
                    wanted = Some(distance);
                    break;
                }
                through += 1;
                from = distance + 1e-9;
            }
            let found = all[1][k].map(|(meeting, _)| meeting.distance);
            match (found, wanted) {
                (Some(a), Some(b)) => assert!((a - b).abs() < 1e-8, "{surface:?}: {a}, not {b}"),
                (a, b) => assert!(a.is_none() && b.is_none(), "{surface:?}: {a:?}, not {b:?}"),
            }
            hits += usize::from(found.is_some());
        }
        assert!(hits > 200 && through > 20, "{hits} hits, {through} through the hole");
    }
}

#[test]
fn swept_surfaces_are_met_where_their_closed_forms_are() {
    let f = frame();
    let upright = Frame { origin: f.place(DVec3::X), x: f.x, y: f.z, z: -f.y };
    let skew = Curve::Line {
        origin: f.place(DVec3::X * 0.8),
        direction: f.turn(DVec3::new(0.3f64.tangent(), 0.0, 1.0)),
    };
    let pairs = [
        (
            Surface::Revolution { frame: f, profile: Curve::Circle { frame: upright, radius: 0.35 } },
            Surface::Torus { frame: f, major: 1.0, minor: 0.35 },
        ),
        (
            Surface::Revolution { frame: f, profile: skew },
            Surface::Cone { frame: f, radius: 0.8, half_angle: 0.3 },
        ),
        (
            Surface::Extrusion { profile: Curve::Circle { frame: f, radius: 0.8 }, along: f.z },
            Surface::Cylinder { frame: f, radius: 0.8 },
        ),
    ];
    let rays = rays(4000);
    let (low, high) = (DVec2::new(0.2, -1.3), DVec2::new(5.6, 1.4));
    for (swept, closed) in pairs {
        let hole = Some((DVec2::new(3.0, 0.2), 0.8));
        let [a, b] = [swept, closed].map(|surface| nearest(&face(surface, low, high, hole), &rays));
        let mut hits = 0;
        for (a, b) in a.iter().zip(&b) {
            match (a, b) {
                (Some((a, normal_a)), Some((b, normal_b))) => {
                    assert!(
                        (a.distance - b.distance).abs() < 1e-8 && a.at.distance(b.at) < 1e-6,
                        "{a:?}, {b:?}"
                    );
                    assert!(normal_a.distance(*normal_b) < 1e-6);
                    hits += 1;
                }
                (a, b) => assert!(a.is_none() && b.is_none(), "{a:?}, not {b:?}"),
            }
        }
        assert!(hits > 200, "{hits}");
    }
}

#[test]
fn pieces_hold_what_they_are_pieces_of() {
    let sphere = Surface::Sphere { frame: frame(), radius: 1.0 };
    let face = face(sphere, DVec2::new(0.0, -0.5 * PI), DVec2::new(TAU, 0.5 * PI), None);
    let (_, pieces) = CastFace::new(&face).unwrap();
    let volume = |[low, high]: [DVec3; 2]| (high - low).element_product();
    assert!(pieces.len() >= 8 && pieces.iter().map(|piece| volume(piece.bounds)).sum::<f64>() < 40.0);
}

#[test]
fn what_other_pieces_leave_changes_nothing() {
    let whole = DVec2::splat(TAU);
    let kinds = [
        (Surface::Torus { frame: frame(), major: 1.0, minor: 0.35 }, DVec2::ZERO, whole),
        (Surface::Cone { frame: frame(), radius: 0.2, half_angle: 0.4 }, DVec2::ZERO, DVec2::new(TAU, 1.0)),
        (Surface::Cylinder { frame: frame(), radius: 0.8 }, DVec2::ZERO, DVec2::new(TAU, 1.0)),
    ];
    for (surface, low, high) in kinds {
        let (cast, pieces) =
            CastFace::new(&face(surface, low, high, Some((DVec2::new(3.0, 0.5), 0.4)))).unwrap();
        assert!(cast.has_line_meetings() && pieces.len() > 4);
        let mut hits = 0;
        for ray in rays(2000) {
            // As a hierarchy does: hits so far are the limit of those to come.
            let mut limits = [f64::INFINITY; 2];
            let mut known = None;
            for piece in &pieces {
                let alone = cast.nearest(piece, &ray, &mut None, [0.0, limits[0]], |_| true);
                let after = cast.nearest(piece, &ray, &mut known, [0.0, limits[1]], |_| true);
                let [alone, after] = [alone, after].map(|hit| hit.map_or(f64::INFINITY, |hit| hit.distance));
                assert!(alone == after || (alone - after).abs() < 1e-14, "{alone} {after}");
                limits = [limits[0].min(alone), limits[1].min(after)];
            }
            hits += usize::from(limits[0].is_finite());
        }
        assert!(hits > 200, "{hits}");
    }
}
