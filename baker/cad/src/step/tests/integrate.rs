//! Area and volume of faces by the even-odd rule: scan lines of the parameter plane, Gauss-Legendre along them.

use crate::face::Face;
use crate::model::Part;
use crate::trim::{TrapezoidalMap, TrimEdge};
use glam::{DVec2, DVec3};

const LINES: usize = 3000;
const PIECES: usize = 8;

/// Segments that approach the loops.
fn segments(face: &Face) -> Vec<[DVec2; 2]> {
    let mut found = Vec::new();
    for edge in face.loops.iter().flatten() {
        match *edge {
            TrimEdge::Segment { from, to } => found.push([from, to]),
            TrimEdge::Arc { centre, radii, angles: [a, b] } => {
                let at = |k: usize| centre + radii * DVec2::from_angle(a + (b - a) * k as f64 / 2000.0);
                found.extend((0..2000).map(|k| [at(k), at(k + 1)]));
            }
        }
    }
    found
}

/// Every loop closed: each edge begins where the one before ends, but for rounding.
pub fn assert_loops_closed(face: &Face) {
    assert!(!face.loops.is_empty());
    assert!(TrapezoidalMap::new(&face.loops).is_ok());
    for edges in &face.loops {
        let size = edges.iter().flat_map(TrimEdge::ends).map(DVec2::length).fold(0.0, f64::max);
        for (at, edge) in edges.iter().enumerate() {
            let before = &edges[(at + edges.len() - 1) % edges.len()];
            assert!(before.ends()[1].distance(edge.ends()[0]) <= 1e-12 * size, "{before:?} {edge:?}");
        }
    }
}

/// Integral over the face of area and of p · n / 3, n the face's normal.
pub fn area_and_volume(face: &Face) -> [f64; 2] {
    let segments = segments(face);
    let all = || segments.iter().flatten();
    let low = all().map(|at| at.y).fold(f64::INFINITY, f64::min);
    let high = all().map(|at| at.y).fold(f64::NEG_INFINITY, f64::max);
    let step = (high - low) / LINES as f64;
    let mut sum = [0.0; 2];
    let gauss =
        [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];
    for line in 0..LINES {
        let v = low + (line as f64 + 0.5) * step;
        let mut crossings: Vec<f64> = segments
            .iter()
            .filter(|[a, b]| (a.y > v) != (b.y > v))
            .map(|[a, b]| a.x + (v - a.y) / (b.y - a.y) * (b.x - a.x))
            .collect();
        crossings.sort_by(f64::total_cmp);
        assert_eq!(crossings.len() % 2, 0);
        for pair in crossings.chunks(2) {
            let width = (pair[1] - pair[0]) / PIECES as f64;
            for piece in 0..PIECES {
                for (node, weight) in gauss {
                    let u = pair[0] + (piece as f64 + 0.5 + 0.5 * node) * width;
                    let [place, along_u, along_v] = face.surface.derivatives(DVec2::new(u, v));
                    let normal: DVec3 = along_u.cross(along_v);
                    let share = 0.5 * weight * width * step;
                    sum[0] += share * normal.length();
                    sum[1] += share * place.dot(if face.is_reversed { -normal } else { normal }) / 3.0;
                }
            }
        }
    }
    sum
}

/// Sums over a part's faces; also checks that loops close.
pub fn totals(part: &Part) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for (face, _) in &part.faces {
        assert_loops_closed(face);
        let [area, volume] = area_and_volume(face);
        sum[0] += area;
        sum[1] += volume;
    }
    sum
}

/// Asserts that two numbers agree to a relative error.
pub fn assert_near(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} instead of {expected}");
}
