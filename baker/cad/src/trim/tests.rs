//! Laws of the trapezoidal map, by brute force and closed forms.

use super::{Coverage, TrapezoidalMap, TrimEdge, TrimError, TrimLoop};
use crate::random::SplitMix;
use glam::DVec2;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn polygon(points: &[DVec2]) -> TrimLoop {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(&from, &to)| TrimEdge::Segment { from, to }).collect()
}

fn rectangle(low: DVec2, high: DVec2) -> TrimLoop {
    polygon(&[low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)])
}

fn ellipse(centre: DVec2, radii: DVec2, start: f64) -> TrimLoop {
    vec![TrimEdge::Arc { centre, radii, angles: [start, start + TAU] }]
}

fn circle(x: f64, y: f64, radius: f64) -> TrimLoop {
    ellipse(DVec2::new(x, y), DVec2::splat(radius), 0.0)
}

/// A star-shaped polygon.
fn star(random: &mut SplitMix, centre: DVec2, radius: f64, count: usize) -> TrimLoop {
    let points: Vec<DVec2> = (0..count)
        .map(|i| {
            let angle = TAU * (i as f64 + random.between(-0.3, 0.3)) / count as f64;
            centre + radius * random.between(0.5, 1.0) * DVec2::from_angle(angle)
        })
        .collect();
    polygon(&points)
}

/// Arcs anywhere, joined by segments: crosses itself at will.
fn tangle(random: &mut SplitMix, count: usize) -> TrimLoop {
    let mut edges: TrimLoop = Vec::new();
    for _ in 0..count {
        let start = random.between(-7.0, 7.0);
        let arc = TrimEdge::Arc {
            centre: random.point(DVec2::NEG_ONE, DVec2::ONE),
            radii: random.point(DVec2::splat(0.05), DVec2::ONE),
            angles: [start, start + random.between(-TAU, TAU)],
        };
        if let Some(last) = edges.last() {
            edges.push(TrimEdge::Segment { from: last.ends()[1], to: arc.ends()[0] });
        }
        edges.push(arc);
    }
    edges.push(TrimEdge::Segment { from: edges[edges.len() - 1].ends()[1], to: edges[0].ends()[0] });
    edges
}

fn half_disc(centre: DVec2, radius: f64, turn: f64) -> TrimLoop {
    let arc = TrimEdge::Arc { centre, radii: DVec2::splat(radius), angles: [turn, turn + PI] };
    let [a, b] = arc.ends();
    vec![arc, TrimEdge::Segment { from: b, to: a }]
}

/// Loop sets, with their areas where there is a closed form.
fn domains() -> Vec<(&'static str, Vec<TrimLoop>, Option<f64>)> {
    let mut random = SplitMix(7);
    let r = &mut random;
    let o = DVec2::ZERO;
    let p = DVec2::new;
    let mut all = vec![
        ("square", vec![rectangle(p(-1.0, -1.0), p(1.0, 1.0))], Some(4.0)),
        ("circle", vec![circle(0.1, 0.2, 0.7)], Some(PI * 0.49)),
        ("turned circle", vec![ellipse(p(0.3, 0.1), p(0.6, 0.6), 1.234)], Some(PI * 0.36)),
        ("ellipse", vec![ellipse(o, p(1.0, 0.3), -2.0)], Some(PI * 0.3)),
        ("half disc", vec![half_disc(o, 1.0, 0.0)], Some(FRAC_PI_2)),
        ("half disc to the left", vec![half_disc(p(0.2, 0.1), 0.8, FRAC_PI_2)], Some(0.32 * PI)),
        ("oblique half disc", vec![half_disc(p(0.2, 0.1), 0.8, 0.6)], Some(0.32 * PI)),
        ("ring", vec![circle(0.0, 0.0, 1.0), circle(0.0, 0.0, 0.5)], Some(0.75 * PI)),
        (
            "nested holes",
            (1..=9).map(|i| circle(0.0, 0.0, 0.1 * f64::from(i))).collect(),
            Some(PI * 0.01 * (81.0 - 64.0 + 49.0 - 36.0 + 25.0 - 16.0 + 9.0 - 4.0 + 1.0)),
        ),
        (
            "circles tangent from inside",
            vec![
                circle(0.0, 0.0, 1.0),
                circle(0.5, 0.0, 0.5),
                circle(0.0, 0.5, 0.25),
                circle(-0.5, 0.0, 0.5),
            ],
            None,
        ),
        ("circles tangent from outside", vec![circle(-0.5, 0.0, 0.5), circle(0.5, 0.0, 0.5)], Some(PI * 0.5)),
        (
            "circles tangent obliquely",
            vec![circle(0.0, 0.0, 0.5), ellipse(p(0.6, 0.8) * 0.75, p(0.25, 0.25), 0.0)],
            Some(PI * 0.3125),
        ),
        ("nearly one circle", vec![circle(0.0, 0.0, 1.0), circle(1e-9, 0.0, 1.0)], None),
        ("circles that cross", vec![circle(-0.3, 0.0, 0.6), circle(0.3, 0.0, 0.6)], None),
        ("a circle twice", vec![circle(-0.3, 0.0, 0.6), circle(-0.3, 0.0, 0.6)], Some(0.0)),
        (
            "ellipses with four crossings",
            vec![ellipse(o, p(1.0, 0.4), 0.0), ellipse(o, p(0.4, 1.0), 0.0)],
            None,
        ),
        (
            "line tangent to a circle",
            vec![circle(0.0, 0.0, 0.5), rectangle(p(-1.0, -1.0), p(1.0, 0.5))],
            None,
        ),
        (
            "squares that touch at a vertex",
            vec![rectangle(p(-1.0, -1.0), o), rectangle(o, p(1.0, 1.0))],
            Some(2.0),
        ),
        (
            "overlapping edges",
            vec![
                polygon(&[p(-1.0, -0.9), p(1.0, -0.7), p(1.0, 0.9)]),
                polygon(&[p(-1.0, -0.9), p(0.0, -0.8), p(-0.5, 0.5)]),
            ],
            None,
        ),
        ("hourglass", vec![polygon(&[p(-1.0, -1.0), p(1.0, 1.0), p(1.0, -1.0), p(-1.0, 1.0)])], Some(2.0)),
        ("sliver", vec![polygon(&[p(-1.0, -1.0), p(1.0, 1.0), p(0.0, 1e-7)])], Some(1e-7)),
        (
            "square with a round hole at its edge",
            vec![rectangle(p(-1.0, -1.0), p(1.0, 1.0)), circle(0.5, 0.0, 0.5)],
            Some(4.0 - 0.25 * PI),
        ),
        (
            "slot",
            vec![vec![
                TrimEdge::Segment { from: p(-0.5, -0.2), to: p(0.5, -0.2) },
                TrimEdge::Arc { centre: p(0.5, 0.0), radii: p(0.2, 0.2), angles: [-FRAC_PI_2, FRAC_PI_2] },
                TrimEdge::Segment { from: p(0.5, 0.2), to: p(-0.5, 0.2) },
                TrimEdge::Arc {
                    centre: p(-0.5, 0.0),
                    radii: p(0.2, 0.2),
                    angles: [FRAC_PI_2, 3.0 * FRAC_PI_2],
                },
            ]],
            Some(0.4 + 0.04 * PI),
        ),
    ];
    let gon: Vec<DVec2> = (0..10_000).map(|i| DVec2::from_angle(TAU * f64::from(i) / 1e4)).collect();
    all.push(("10,000-gon", vec![polygon(&gon)], Some(5000.0 * (TAU / 1e4).sine())));
    for count in [5, 40, 300] {
        let outer = star(r, o, 1.0, count);
        let holes = [p(-0.2, 0.0), p(0.2, 0.1)].map(|at| star(r, at, 0.15, count));
        let area = shoelace(&outer) - shoelace(&holes[0]) - shoelace(&holes[1]);
        all.push(("star with holes", [vec![outer], holes.to_vec()].concat(), Some(area)));
    }
    for count in [3, 10, 50] {
        let points: Vec<DVec2> = (0..count).map(|_| r.point(DVec2::NEG_ONE, DVec2::ONE)).collect();
        all.push(("random polygon", vec![polygon(&points)], None));
        all.push(("tangle", vec![tangle(r, count), tangle(r, 2)], None));
    }
    let area = shoelace(&comb(200));
    all.push(("comb", vec![comb(200)], Some(area)));
    all
}

fn shoelace(polygon: &TrimLoop) -> f64 {
    polygon.iter().map(|edge| 0.5 * edge.ends()[0].perp_dot(edge.ends()[1])).sum::<f64>().abs()
}

/// Long teeth: many pieces span many slabs.
fn comb(count: usize) -> TrimLoop {
    let step = 0.1 / count as f64;
    let tip = |i: usize| -1.0 + 0.9 * ((i * 7919) % count) as f64 / count as f64;
    let mut points = Vec::new();
    for i in 0..count {
        points.extend([DVec2::new(1.0, i as f64 * step), DVec2::new(tip(i), (i as f64 + 0.5) * step)]);
    }
    points.push(DVec2::new(1.0, 0.1));
    points.push(DVec2::new(1.0 + 1e-3, 0.05));
    polygon(&points)
}

/// Even-odd rule by a ray along u, from whole edges.
fn is_within(loops: &[TrimLoop], at: DVec2) -> bool {
    let mut crossings = 0;
    for edge in loops.iter().flatten() {
        match *edge {
            TrimEdge::Segment { from, to } => {
                if (from.y > at.y) != (to.y > at.y) {
                    let u = from.x + (at.y - from.y) / (to.y - from.y) * (to.x - from.x);
                    crossings += usize::from(u > at.x);
                }
            }
            TrimEdge::Arc { centre, radii, angles } => {
                let sine = (at.y - centre.y) / radii.y;
                if sine.abs() < 1.0 {
                    for angle in [sine.arc_sine(), PI - sine.arc_sine()] {
                        let begin = angles[0].min(angles[1]);
                        let turned = begin + (angle - begin).rem_euclid(TAU);
                        let is_on = turned < angles[0].max(angles[1]);
                        crossings += usize::from(is_on && centre.x + radii.x * angle.cosine() > at.x);
                    }
                }
            }
        }
    }
    crossings % 2 == 1
}

#[test]
fn contains_is_the_even_odd_rule() {
    let mut random = SplitMix(1);
    for (name, loops, _) in domains() {
        let map = TrapezoidalMap::new(&loops).unwrap();
        let [low, high] = map.bounds();
        let margin = 0.05 * (high - low);
        let count = if loops.iter().map(Vec::len).sum::<usize>() > 1000 { 5_000 } else { 100_000 };
        for _ in 0..count {
            let at = random.point(low - margin, high + margin);
            assert_eq!(map.contains(at), is_within(&loops, at), "{name} at {at}");
        }
    }
}

#[test]
fn moments_are_those_of_parts() {
    // An L: [0, 2] × [0, 1] and [0, 1] × [1, 3]. Then a quarter disc, centroid 4 R / 3π.
    let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    let map = TrapezoidalMap::new(&[polygon(&corners.map(DVec2::from))]).unwrap();
    let moments = map.moments_within([DVec2::splat(-1.0), DVec2::splat(4.0)]);
    assert!(moments.distance(DVec2::new(2.0 + 1.0, 1.0 + 4.0)) < 1e-12, "{moments}");
    let moments = map.moments_within([DVec2::new(0.5, 0.5), DVec2::new(1.5, 2.0)]);
    // 1 × 0.5 about (1, 0.75) and 0.5 × 1 about (0.75, 1.5).
    assert!(moments.distance(DVec2::new(0.5 + 0.375, 0.375 + 0.75)) < 1e-12, "{moments}");
    let disc = TrapezoidalMap::new(&[circle(0.0, 0.0, 1.0)]).unwrap();
    let moments = disc.moments_within([DVec2::ZERO, DVec2::splat(2.0)]);
    assert!((3.0 * moments - 1.0).abs().max_element() < 1e-3, "{moments}");
}

#[test]
fn areas_within_the_cells_of_a_grid_add_up() {
    for (name, loops, _) in domains() {
        let map = TrapezoidalMap::new(&loops).unwrap();
        let [low, high] = map.bounds();
        let margin = 0.1 * (high - low);
        let [low, side] = [low - margin, (high - low + 2.0 * margin) / 7.0];
        let mut sum = 0.0;
        for i in 0..49 {
            let corner = low + side * DVec2::new(f64::from(i % 7), f64::from(i / 7));
            let patch = [corner, corner + side];
            let area = map.area_within(patch);
            let whole = side.x * side.y;
            match map.coverage(patch) {
                Coverage::Empty => assert!(area.abs() < 1e-9 * whole, "{name}: {area} of an empty cell"),
                Coverage::Plain => assert!((area - whole).abs() < 1e-9 * whole, "{name}: {area} of {whole}"),
                Coverage::Boundary => {
                    assert!((-1e-9..1.0 + 1e-9).contains(&(area / whole)), "{name}: {area}")
                }
            }
            sum += area;
        }
        assert!((sum - map.area()).abs() < 1e-9 * map.area().max(1.0), "{name}: {sum}, not {}", map.area());
    }
}

#[test]
fn area_is_that_of_closed_forms() {
    for (name, loops, area) in domains() {
        if let Some(expected) = area {
            let area = TrapezoidalMap::new(&loops).unwrap().area();
            assert!((area - expected).abs() < 1e-12 * expected.max(1.0), "{name}: {area}, not {expected}");
        }
    }
}

#[test]
fn area_is_that_of_random_points() {
    let mut random = SplitMix(2);
    for (name, loops, _) in domains().into_iter().filter(|domain| domain.2.is_none()) {
        let map = TrapezoidalMap::new(&loops).unwrap();
        let [low, high] = map.bounds();
        let whole = (high - low).element_product();
        // A grid of 400 by 400 cells, a random point in each.
        let size = (high - low) / 400.0;
        let mut within = 0;
        for i in 0..160_000 {
            let cell = low + DVec2::new(f64::from(i % 400), f64::from(i / 400)) * size;
            within += usize::from(is_within(&loops, random.point(cell, cell + size)));
        }
        let sampled = whole * within as f64 / 160_000.0;
        assert!((map.area() - sampled).abs() < 2e-3 * whole, "{name}: {}, sampled {sampled}", map.area());
    }
}

#[test]
fn coverage_is_never_wrongly_empty_or_plain() {
    let mut random = SplitMix(3);
    for (name, loops, _) in domains() {
        let map = TrapezoidalMap::new(&loops).unwrap();
        let [low, high] = map.bounds();
        let size = high - low;
        let mut decided = 0;
        for _ in 0..400 {
            let corner = random.point(low - 0.2 * size, high);
            let side = random.point(DVec2::ZERO, size) * random.unit().powi(3);
            let patch = [corner, corner + side];
            let coverage = map.coverage(patch);
            if coverage != Coverage::Boundary {
                decided += 1;
                for _ in 0..200 {
                    let at = random.point(patch[0], patch[1]);
                    assert_eq!(
                        is_within(&loops, at),
                        coverage == Coverage::Plain,
                        "{name} at {at} of {patch:?}"
                    );
                }
            }
            assert_eq!(map.meets(patch), coverage != Coverage::Empty);
        }
        assert!(decided > 50, "{name}: {decided}");
    }
}

/// Boundary cells of a quadtree cover an area that halves with each level, so that the area of plain ones converges.
#[test]
fn plain_and_boundary_cells_bracket_the_area() {
    for (name, loops, _) in domains() {
        let map = TrapezoidalMap::new(&loops).unwrap();
        let [low, high] = map.bounds();
        let cells = 128;
        let size = (high - low) / f64::from(cells);
        let [mut plain, mut boundary] = [0.0; 2];
        for i in 0..cells * cells {
            let corner = low + DVec2::new(f64::from(i % cells), f64::from(i / cells)) * size;
            match map.coverage([corner, corner + size]) {
                Coverage::Empty => (),
                Coverage::Plain => plain += size.element_product(),
                Coverage::Boundary => boundary += size.element_product(),
            }
        }
        let slack = 1e-9 * (high - low).element_product();
        assert!(plain <= map.area() + slack && map.area() <= plain + boundary + slack, "{name}");
    }
    // The boundary of a disc passes through less than 8 r / size + 4 cells.
    let map = TrapezoidalMap::new(&[circle(0.0, 0.0, 1.0)]).unwrap();
    let mut boundary = 0;
    for i in 0..256 * 256 {
        let corner = DVec2::new(f64::from(i % 256), f64::from(i / 256)) / 128.0 - DVec2::ONE;
        boundary += usize::from(map.coverage([corner, corner + 1.0 / 128.0]) == Coverage::Boundary);
    }
    assert!((1020..1028).contains(&boundary), "{boundary}");
}

#[test]
fn a_point_is_in_one_of_two_domains_on_an_edge() {
    let mut random = SplitMix(4);
    let corners = [DVec2::splat(-2.0), DVec2::new(2.0, -2.0), DVec2::splat(2.0), DVec2::new(-2.0, 2.0)];
    for _ in 0..200 {
        // A path from the left to the right side of a square; the square's halves have it both, one in reverse.
        let mut path = vec![DVec2::new(-2.0, random.between(-1.0, 1.0))];
        path.extend((0..4).map(|_| random.point(DVec2::NEG_ONE, DVec2::ONE)));
        path.push(DVec2::new(2.0, random.between(-1.0, 1.0)));
        let mut edges: TrimLoop =
            path.windows(2).map(|ends| TrimEdge::Segment { from: ends[0], to: ends[1] }).collect();
        // Half of an ellipse instead of the middle part.
        let [a, b] = [edges[1].ends()[0], edges[3].ends()[1]];
        let radii = DVec2::new((b.x - a.x).abs() / 2.0, random.between(0.1, 1.0));
        let arc = TrimEdge::Arc { centre: DVec2::new(a.midpoint(b).x, a.y), radii, angles: [PI, 0.0] };
        let arc = if b.x < a.x { arc.reversed() } else { arc };
        let joints = [arc.ends()[0], arc.ends()[1]];
        edges.splice(
            1..4,
            [TrimEdge::Segment { from: a, to: joints[0] }, arc, TrimEdge::Segment { from: joints[1], to: b }],
        );
        let segment = |from, to| TrimEdge::Segment { from, to };
        let mut lower = edges.clone();
        lower.extend([
            segment(path[5], corners[1]),
            segment(corners[1], corners[0]),
            segment(corners[0], path[0]),
        ]);
        let mut upper: TrimLoop = edges.iter().rev().map(TrimEdge::reversed).collect();
        upper.extend([
            segment(path[0], corners[3]),
            segment(corners[3], corners[2]),
            segment(corners[2], path[5]),
        ]);
        let [lower, upper] = [lower, upper].map(|edges| TrapezoidalMap::new(&[edges]).unwrap());
        for edge in &edges {
            for i in 0..500 {
                let on = if i < 2 { edge.ends()[i] } else { edge.at(random.unit()) };
                // The path may leave the square on an outer side only at its ends.
                if on.x < 2.0 {
                    for v in [on.y, on.y.next_up(), on.y.next_down()] {
                        let at = DVec2::new(on.x, v);
                        assert!(lower.contains(at) != upper.contains(at), "{at}");
                    }
                }
            }
        }
        assert!((lower.area() + upper.area() - 16.0).abs() < 1e-12);
    }
}

/// The pieces of a grid of cells with common vertices: each point is in one cell.
#[test]
fn cells_of_a_grid_have_each_point_once() {
    let mut random = SplitMix(5);
    let vertices: Vec<DVec2> = (0..36)
        .map(|i| {
            DVec2::new(f64::from(i % 6), f64::from(i / 6))
                + random.point(DVec2::splat(-0.3), DVec2::splat(0.3))
        })
        .collect();
    let mut cells = Vec::new();
    for i in (0..30).filter(|i| i % 6 < 5) {
        let corners = [i, i + 1, i + 7, i + 6].map(|k| vertices[k]);
        cells.push(TrapezoidalMap::new(&[polygon(&corners)]).unwrap());
    }
    for i in 0..20_000 {
        // Vertices inside the grid, points on its edges, points anywhere.
        let (column, row) = (1 + i % 4, 1 + (i / 4) % 4);
        let vertex = vertices[6 * row + column];
        let at = match i % 3 {
            0 => vertex,
            1 => vertex.lerp(vertices[6 * row + column - 1], random.unit() * 0.999),
            _ => random.point(DVec2::splat(0.5), DVec2::splat(4.5)),
        };
        assert_eq!(cells.iter().filter(|cell| cell.contains(at)).count(), 1, "{at}");
    }
}

#[test]
fn memory_stays_near_linear() {
    for count in [500, 1000, 2000] {
        let map = TrapezoidalMap::new(&[comb(count)]).unwrap();
        let [pieces, levels] = map.counts();
        assert!(levels > 1);
        // At most two nodes of each level for the long side of a piece.
        assert!(map.entries() <= pieces * (8 + 2 * pieces.ilog2() as usize), "{}", map.entries());
    }
    let gon: Vec<DVec2> = (0..10_000).map(|i| DVec2::from_angle(TAU * f64::from(i) / 1e4)).collect();
    assert_eq!(TrapezoidalMap::new(&[polygon(&gon)]).unwrap().counts()[1], 1);
}

#[test]
fn loops_are_checked() {
    let o = DVec2::ZERO;
    let segment = |from, to| TrimEdge::Segment { from, to };
    let error = |loops: &[TrimLoop]| TrapezoidalMap::new(loops).unwrap_err();
    assert_eq!(error(&[]), TrimError::NoEdges);
    assert_eq!(error(&[circle(0.0, 0.0, 1.0), vec![]]), TrimError::NoEdges);
    assert_eq!(error(&[vec![segment(o, o)]]), TrimError::NoExtent);
    let open = vec![segment(o, DVec2::X), segment(DVec2::X, DVec2::Y)];
    assert_eq!(error(&[open]), TrimError::Open { curve: 0, edge: 0, gap: 1.0 });
    let bad = vec![segment(o, DVec2::NAN), segment(DVec2::NAN, o)];
    assert_eq!(error(&[bad]), TrimError::NotFinite { curve: 0, edge: 0 });
    let arc = |radii, angles| vec![TrimEdge::Arc { centre: o, radii, angles }];
    assert!(matches!(error(&[arc(DVec2::X, [0.0, TAU])]), TrimError::BadArc { .. }));
    assert!(matches!(error(&[arc(DVec2::ONE, [0.0, 7.0])]), TrimError::BadArc { .. }));
    assert!(matches!(error(&[arc(DVec2::ONE, [0.0, 3.0])]), TrimError::Open { .. }));
    assert!(matches!(error(&[arc(DVec2::ONE, [0.0, f64::INFINITY])]), TrimError::NotFinite { .. }));
    // A small gap is closed, and an edge without length left out.
    let e = 1e-6;
    let gaps = [
        segment(o, DVec2::X),
        segment(DVec2::new(1.0, e), DVec2::ONE),
        segment(DVec2::ONE, DVec2::ONE),
        segment(DVec2::new(1.0 - e, 1.0), DVec2::new(0.0, 1.0 - e)),
        segment(DVec2::Y, o),
    ];
    let map = TrapezoidalMap::new(&[gaps.to_vec()]).unwrap();
    assert!((map.area() - 1.0).abs() < 2.0 * e);
    // Both ends of a gap are joined: no leak at it.
    assert!(!map.contains(DVec2::new(2.0, 0.5 * e)) && !map.contains(DVec2::new(1.0 - 0.5 * e, 2.0)));
}

#[test]
fn a_domain_may_be_all_of_a_patch() {
    let patch = [DVec2::new(0.0, -1.0), DVec2::new(TAU, 1.0)];
    let map = TrapezoidalMap::new(&[rectangle(patch[0], patch[1])]).unwrap();
    assert!(map.is_all_of(patch));
    assert_eq!(map.coverage(patch), Coverage::Plain);
    assert!(!map.is_all_of([patch[0], patch[1] + 0.1]));
    assert!(!TrapezoidalMap::new(&[circle(0.0, 0.0, 1.0)]).unwrap().is_all_of([DVec2::NEG_ONE, DVec2::ONE]));
    assert!(!map.meets([DVec2::new(0.0, 1.0), DVec2::new(1.0, 2.0)]));
    // A slit without area splits no domain, but is its boundary.
    let slit = polygon(&[DVec2::new(1.0, -0.5), DVec2::new(1.0, 0.5)]);
    let map = TrapezoidalMap::new(&[rectangle(patch[0], patch[1]), slit]).unwrap();
    assert_eq!(map.coverage([DVec2::new(0.9, -0.1), DVec2::new(1.1, 0.1)]), Coverage::Boundary);
    assert!(map.contains(DVec2::new(1.0, 0.0)));
}

/// Prints queries a second.
#[test]
#[ignore = "a measurement"]
fn speed_of_queries() {
    let mut random = SplitMix(6);
    let star = star(&mut random, DVec2::ZERO, 1.0, 1000);
    let arcs: Vec<TrimLoop> = (0..1000)
        .map(|_| {
            let centre = random.point(DVec2::NEG_ONE, DVec2::ONE);
            circle(centre.x, centre.y, random.between(0.001, 0.02))
        })
        .collect();
    let gon: Vec<DVec2> = (0..10_000).map(|i| DVec2::from_angle(TAU * f64::from(i) / 1e4)).collect();
    for (name, loops) in [
        ("star of 1,000 edges", vec![star]),
        ("1,000 circles", arcs),
        ("comb of 1,000 teeth", vec![comb(1000)]),
        ("10,000-gon", vec![polygon(&gon)]),
    ] {
        let begin = std::time::Instant::now();
        let map = TrapezoidalMap::new(&loops).unwrap();
        let built = begin.elapsed();
        let [low, high] = map.bounds();
        let points: Vec<DVec2> = (0..1_000_000).map(|_| random.point(low, high)).collect();
        let begin = std::time::Instant::now();
        let within = points.iter().filter(|&&at| map.contains(at)).count();
        let rate = 1.0 / begin.elapsed().as_secs_f64();
        let begin = std::time::Instant::now();
        let area = map.area();
        println!(
            "{name}: built in {built:?}, {:?} pieces and levels, {} entries, {rate:.2} million queries a second, {within} within; area {area} in {:?}",
            map.counts(),
            map.entries(),
            begin.elapsed()
        );
    }
}
