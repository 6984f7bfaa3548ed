//! Laws of tessellated faces: areas, closed borders, chord error.

use super::{TessellateError, Tessellation, face, outline};
use crate::trim::{TrapezoidalMap, TrimEdge, TrimLoop};
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

fn rectangle(low: DVec2, high: DVec2) -> TrimLoop {
    let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    (0..4).map(|i| TrimEdge::Segment { from: corners[i], to: corners[(i + 1) % 4] }).collect()
}

fn circle(centre: DVec2, radius: f64) -> TrimLoop {
    vec![TrimEdge::Arc { centre, radii: DVec2::splat(radius), angles: [0.0, TAU] }]
}

fn plane(at: DVec2) -> DVec3 {
    at.extend(0.0)
}

fn cylinder(at: DVec2) -> DVec3 {
    DVec3::new(at.x.cosine(), at.x.sine(), at.y)
}

fn sphere(at: DVec2) -> DVec3 {
    DVec3::new(at.y.cosine() * at.x.cosine(), at.y.cosine() * at.x.sine(), at.y.sine())
}

/// A sine wave: its chord from a zero to the next but one crosses it in the middle.
fn wave(at: DVec2) -> DVec3 {
    DVec3::new(at.x, at.y, 0.1 * (TAU * at.x).sine())
}

fn tessellated(loops: &[TrimLoop], surface: &impl Fn(DVec2) -> DVec3, chord_error: f64) -> Tessellation {
    let outlines: Vec<Vec<DVec2>> = loops.iter().map(|edges| outline(edges, surface, chord_error)).collect();
    let mesh = face(&outlines, surface, chord_error).unwrap();
    // Triangles are counterclockwise, cover the domain once, and only outlines have a triangle on one side alone.
    let mut sides: HashMap<(u32, u32), u32> = HashMap::new();
    let mut area = 0.0;
    for &[a, b, c] in &mesh.triangles {
        let at = [a, b, c].map(|vertex| mesh.parameters[vertex as usize]);
        let doubled = (at[1] - at[0]).perp_dot(at[2] - at[0]);
        assert!(doubled > 0.0);
        area += 0.5 * doubled;
        for side in [(a, b), (b, c), (c, a)] {
            assert!(sides.insert(side, 1).is_none());
        }
    }
    let polygon = |points: &Vec<DVec2>| -> TrimLoop {
        (0..points.len())
            .map(|i| TrimEdge::Segment { from: points[i], to: points[(i + 1) % points.len()] })
            .collect()
    };
    let domain = TrapezoidalMap::new(&outlines.iter().map(polygon).collect::<Vec<_>>()).unwrap();
    assert!((area - domain.area()).abs() < 1e-9 * area, "{area} {}", domain.area());
    let mut open: Vec<(u32, u32)> = sides
        .keys()
        .filter(|&&(a, b)| !sides.contains_key(&(b, a)))
        .map(|&(a, b)| (a.min(b), a.max(b)))
        .collect();
    let mut expected = Vec::new();
    for vertices in &mesh.outlines {
        for i in 0..vertices.len() {
            let (a, b) = (vertices[i], vertices[(i + 1) % vertices.len()]);
            expected.push((a.min(b), a.max(b)));
        }
    }
    open.sort_unstable();
    expected.sort_unstable();
    assert_eq!(open, expected);
    for (at, position) in mesh.parameters.iter().zip(&mesh.positions) {
        assert_eq!(surface(*at), *position);
    }
    mesh
}

fn area(mesh: &Tessellation) -> f64 {
    let area = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        0.5 * (b - a).cross(c - a).length()
    };
    mesh.triangles.iter().map(area).sum()
}

/// Greatest distance of triangles' points from a surface whose distance function is given.
fn greatest_error(mesh: &Tessellation, distance: impl Fn(DVec3) -> f64) -> f64 {
    let mut greatest = 0.0f64;
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        for i in 0..=8 {
            for j in 0..=8 - i {
                let [s, t] = [i, j].map(|k| f64::from(k) / 8.0);
                greatest = greatest.max(distance(a + s * (b - a) + t * (c - a)).abs());
            }
        }
    }
    greatest
}

#[test]
fn a_plane_with_holes_needs_no_vertices_inside() {
    let loops = [
        rectangle(DVec2::NEG_ONE, DVec2::ONE),
        circle(DVec2::splat(0.4), 0.3),
        circle(DVec2::splat(-0.5), 0.2),
    ];
    let mesh = tessellated(&loops, &plane, 1e-4);
    assert_eq!(mesh.parameters.len(), mesh.outlines.iter().map(Vec::len).sum::<usize>());
    assert_eq!(mesh.outlines[0].len(), 4);
    assert!((area(&mesh) - (4.0 - 0.13 * PI)).abs() < 1e-3);
}

#[test]
fn curved_faces_keep_the_chord_error() {
    let whole = rectangle(DVec2::new(0.0, -1.0), DVec2::new(TAU, 1.0));
    for error in [1e-2, 1e-3] {
        let pierced = [whole.clone(), circle(DVec2::new(2.0, 0.1), 0.7)];
        let mesh = tessellated(&pierced, &cylinder, error);
        let greatest = greatest_error(&mesh, |at| at.truncate().length() - 1.0);
        assert!(greatest < 1.5 * error, "{greatest} {}", mesh.triangles.len());
        assert!((area(&mesh) - (2.0 * TAU - 0.49 * PI)).abs() < 20.0 * error);

        // Poles: an edge of no length in space.
        let globe = [rectangle(DVec2::new(0.0, -PI / 2.0), DVec2::new(TAU, PI / 2.0))];
        let mesh = tessellated(&globe, &sphere, error);
        let greatest = greatest_error(&mesh, |at| at.length() - 1.0);
        assert!(greatest < 2.0 * error, "{greatest} {}", mesh.triangles.len());
        assert!((area(&mesh) / (4.0 * PI) - 1.0).abs() < 3.0 * error);
        assert!(mesh.triangles.len() < (40.0 / error) as usize, "{}", mesh.triangles.len());

        let sheet = [rectangle(DVec2::ZERO, DVec2::ONE)];
        let mesh = tessellated(&sheet, &wave, error);
        let greatest = greatest_error(&mesh, |at| at.z - 0.1 * (TAU * at.x).sine());
        assert!(greatest < 2.0 * error, "{greatest}");
    }
}

/// Half a cylinder whose borders are level but for rounding: no triangles close its ends.
#[test]
fn borders_that_are_level_but_for_rounding_have_no_triangles_beyond() {
    for nudge in [0.0, 1e-17, -1e-17, 1e-16, -3e-16, 1e-60] {
        let corners = [
            DVec2::new(0.3, -0.02),
            DVec2::new(0.3 + PI, -0.02 + nudge),
            DVec2::new(0.3 + PI, 0.07 - nudge),
            DVec2::new(0.3, 0.07),
        ];
        let edges: TrimLoop =
            (0..4).map(|i| TrimEdge::Segment { from: corners[i], to: corners[(i + 1) % 4] }).collect();
        for tilt in [0.0, 0.1] {
            let tilted = |at: DVec2| cylinder(at + DVec2::new(0.0, tilt * at.x));
            let mesh = tessellated(std::slice::from_ref(&edges), &tilted, 1e-4);
            let expected = 0.09 * PI;
            assert!((area(&mesh) / expected - 1.0).abs() < 1e-3, "{nudge} {tilt}: {}", area(&mesh));
        }
    }
}

/// A tiny coordinate is no fault.
#[test]
fn tiny_coordinates_are_triangulated() {
    let points = [DVec2::new(1e-70, -1e-50), DVec2::X, DVec2::ONE, DVec2::new(-1e-47, 1.0)].to_vec();
    assert_eq!(face(&[points], &plane, 1e-3).unwrap().triangles.len(), 2);
}

#[test]
fn an_edge_has_the_same_points_both_ways() {
    let arc = TrimEdge::Arc { centre: DVec2::ONE, radii: DVec2::new(1.0, 0.4), angles: [0.3, 2.0] };
    let segment = TrimEdge::Segment { from: DVec2::new(2.0, -1.0), to: DVec2::new(0.3, 0.9) };
    for edge in [arc, segment] {
        let [from, to] = edge.ends();
        let close = TrimEdge::Segment { from: to, to: from };
        let forward = outline(&vec![edge, close], &sphere, 1e-4);
        let mut back = outline(&vec![close.reversed(), edge.reversed()], &sphere, 1e-4);
        back.reverse();
        back.rotate_right(1);
        let begin = forward.iter().position(|&point| point == from).unwrap();
        assert_eq!(begin, 0);
        let shift = back.iter().position(|&point| point == from).unwrap();
        back.rotate_left(shift);
        assert_eq!(forward, back);
        assert!(forward.len() > 20);
    }
}

#[test]
fn odd_outlines_are_split_or_refused() {
    // An hourglass: its edges cross and are split.
    let points = [DVec2::ZERO, DVec2::ONE, DVec2::X, DVec2::Y].to_vec();
    let mesh = face(&[points], &plane, 1e-3).unwrap();
    assert_eq!((mesh.triangles.len(), mesh.parameters.len()), (2, 5));
    assert!((area(&mesh) - 0.5).abs() < 1e-12);
    assert!(matches!(face(&[], &plane, 1e-3), Err(TessellateError::Trim(_))));
    let hole = |at: DVec2| if at.x > 0.5 { DVec3::NAN } else { plane(at) };
    let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y].to_vec();
    assert!(matches!(face(&[square], &hole, 1e-3), Err(TessellateError::NotFinite { .. })));
}

#[test]
fn short_edges_are_no_poles() {
    // A side in parts that are shorter than the chord error.
    let parts = 200;
    let mut edges = rectangle(DVec2::ZERO, DVec2::new(2.0, 1.0));
    edges.remove(0);
    let at = |i: u32| DVec2::new(2.0 * f64::from(i) / f64::from(parts), 0.0);
    edges.splice(0..0, (0..parts).map(|i| TrimEdge::Segment { from: at(i), to: at(i + 1) }));
    let triangles = tessellated(&[edges], &cylinder, 0.05).triangles.len();
    assert!(triangles < 2 * parts as usize, "{triangles}");
}
