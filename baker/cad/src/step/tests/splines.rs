//! Solids with swept and B-spline surfaces, poles and wedges.

use super::integrate::{area_and_volume, assert_near};
use super::shapes::{assert_measures, only_part};
use super::text::{Text, list};
use super::{assert_closed, read};
use glam::DVec3;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

/// Poles and weights of a circle about z as a quadratic rational B-spline from x, in nine.
fn circle_poles(radius: f64, z: f64) -> ([DVec3; 9], [f64; 9]) {
    let corner = |at: usize| {
        let angle = TAU * at as f64 / 8.0;
        let out = if at.is_multiple_of(2) { radius } else { radius / FRAC_1_SQRT_2 };
        DVec3::new(out * angle.cosine(), out * angle.sine(), z)
    };
    let weight = |at: usize| if at.is_multiple_of(2) { 1.0 } else { FRAC_1_SQRT_2 };
    (std::array::from_fn(corner), std::array::from_fn(weight))
}

fn reals(values: &[f64]) -> String {
    format!("({})", values.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(","))
}

fn spline_circle(text: &mut Text, radius: f64, z: f64) -> u64 {
    let (poles, weights) = circle_poles(radius, z);
    let poles = list(&poles.map(|pole| text.point(pole)));
    text.add(format!(
        "( BOUNDED_CURVE() B_SPLINE_CURVE(2,{poles},.UNSPECIFIED.,.T.,.F.) \
         B_SPLINE_CURVE_WITH_KNOTS((3,2,2,2,3),(0.,1.,2.,3.,4.),.UNSPECIFIED.) CURVE() \
         GEOMETRIC_REPRESENTATION_ITEM() RATIONAL_B_SPLINE_CURVE({}) REPRESENTATION_ITEM('') )",
        reals(&weights)
    ))
}

/// A plane's disc at a height, within an edge.
fn disc(text: &mut Text, edge: u64, z: f64, is_top: bool) -> u64 {
    let frame = text.frame(z * DVec3::Z, if is_top { DVec3::Z } else { -DVec3::Z }, DVec3::X);
    let plane = text.add(format!("PLANE('',#{frame})"));
    let bound = text.bound(&[(edge, is_top)]);
    text.face(plane, &[bound], true)
}

/// A cylinder written as an extruded spline, an extruded circle, a turned line, a spline surface; with and without a seam.
#[test]
fn cylinders_of_all_kinds_have_their_area_and_volume() {
    let (radius, height) = (20.0, 50.0);
    for kind in 0..4 {
        for with_seam in [false, true] {
            let mut text = Text::new();
            let frame = text.frame(DVec3::ZERO, DVec3::Z, DVec3::X);
            let start = text.point(radius * DVec3::X);
            let up = text.direction(DVec3::Z);
            let up = text.add(format!("VECTOR('',#{up},10.)"));
            let surface = match kind {
                0 => {
                    let profile = spline_circle(&mut text, radius, 0.0);
                    text.add(format!("SURFACE_OF_LINEAR_EXTRUSION('',#{profile},#{up})"))
                }
                1 => {
                    let profile = text.add(format!("CIRCLE('',#{frame},{radius:?})"));
                    text.add(format!("SURFACE_OF_LINEAR_EXTRUSION('',#{profile},#{up})"))
                }
                2 => {
                    // σᵤ × σᵥ points out when the line goes up.
                    let profile = text.add(format!("LINE('',#{start},#{up})"));
                    let origin = text.point(DVec3::ZERO);
                    let axis = text.direction(DVec3::Z);
                    let axis = text.add(format!("AXIS1_PLACEMENT('',#{origin},#{axis})"));
                    text.add(format!("SURFACE_OF_REVOLUTION('',#{profile},#{axis})"))
                }
                _ => {
                    let (low, weights) = circle_poles(radius, 0.0);
                    let rows: Vec<String> = low
                        .iter()
                        .map(|pole| list(&[*pole, *pole + height * DVec3::Z].map(|pole| text.point(pole))))
                        .collect();
                    let weights: Vec<String> = weights.iter().map(|weight| reals(&[*weight; 2])).collect();
                    text.add(format!(
                        "( BOUNDED_SURFACE() B_SPLINE_SURFACE(2,1,({}),.UNSPECIFIED.,.T.,.F.,.F.) \
                         B_SPLINE_SURFACE_WITH_KNOTS((3,2,2,2,3),(2,2),(0.,1.,2.,3.,4.),(0.,1.),.UNSPECIFIED.) \
                         GEOMETRIC_REPRESENTATION_ITEM() RATIONAL_B_SPLINE_SURFACE(({})) \
                         REPRESENTATION_ITEM('') SURFACE() )",
                        rows.join(","),
                        weights.join(",")
                    ))
                }
            };
            // The seam is on x; without one the circles begin elsewhere.
            let reference = if with_seam { DVec3::X } else { DVec3::new(0.6, -0.8, 0.0) };
            let mut vertices = [0; 2];
            let mut edges = [0; 2];
            for (at, z) in [0.0, height].into_iter().enumerate() {
                vertices[at] = text.vertex(radius * reference + z * DVec3::Z);
                let curve = if with_seam {
                    spline_circle(&mut text, radius, z)
                } else {
                    let frame = text.frame(z * DVec3::Z, DVec3::Z, DVec3::X);
                    text.add(format!("CIRCLE('',#{frame},{radius:?})"))
                };
                edges[at] = text.edge([vertices[at]; 2], curve, true);
            }
            let bounds = if with_seam {
                let seam = text.straight(vertices, radius * DVec3::X, radius * DVec3::X + height * DVec3::Z);
                vec![text.bound(&[(edges[0], true), (seam, true), (edges[1], false), (seam, false)])]
            } else {
                vec![text.bound(&[(edges[0], true)]), text.bound(&[(edges[1], false)])]
            };
            let side = text.face(surface, &bounds, true);
            let faces =
                [side, disc(&mut text, edges[0], 0.0, false), disc(&mut text, edges[1], height, true)];
            let solid = text.solid("tin", &faces);
            assert_closed(text.finish().as_bytes());
            let part = only_part(text, solid);
            let [area, _] = area_and_volume(&part.faces[0].0);
            assert_near(area, TAU * 0.02 * 0.05, 1e-4);
            assert_measures(&part, TAU * 0.02 * 0.07, PI * 0.02 * 0.02 * 0.05);
        }
    }
}

/// A barrel: a Bézier profile turned about z, in a file in inches and degrees, with pcurves in degrees.
#[test]
fn a_turned_bezier_curve_with_pcurves_in_degrees() {
    let mut text = Text::new();
    let profile = [(2.0, 0.0), (4.0, 1.5), (2.0, 3.0)];
    let poles = list(&profile.map(|(x, z)| text.point(DVec3::new(x, 0.0, z))));
    let profile = text.add(format!("BEZIER_CURVE('',2,{poles},.UNSPECIFIED.,.F.,.F.)"));
    let origin = text.point(DVec3::ZERO);
    let axis = text.direction(DVec3::Z);
    let axis = text.add(format!("AXIS1_PLACEMENT('',#{origin},#{axis})"));
    let surface = text.add(format!("SURFACE_OF_REVOLUTION('',#{profile},#{axis})"));
    let seam_ends = [0.0, 3.0].map(|z| text.vertex(DVec3::new(2.0, 0.0, z)));
    let plane_curve = |text: &mut Text, origin: [f64; 2], along: [f64; 2]| {
        let origin = text.add(format!("CARTESIAN_POINT('',{})", reals(&origin)));
        let along = text.add(format!("DIRECTION('',{})", reals(&along)));
        let along = text.add(format!("VECTOR('',#{along},1.)"));
        let line = text.add(format!("LINE('',#{origin},#{along})"));
        let definition = text.add(format!("DEFINITIONAL_REPRESENTATION('',(#{line}),$)"));
        text.add(format!("PCURVE('',#{surface},#{definition})"))
    };
    let mut circles = [0; 2];
    for (at, z) in [0.0, 3.0].into_iter().enumerate() {
        let frame = text.frame(z * DVec3::Z, DVec3::Z, DVec3::X);
        let circle = text.add(format!("CIRCLE('',#{frame},2.)"));
        let pcurve = plane_curve(&mut text, [0.0, at as f64], [1.0, 0.0]);
        let curve = text.add(format!("SURFACE_CURVE('',#{circle},(#{pcurve}),.PCURVE_S1.)"));
        circles[at] = text.edge([seam_ends[at]; 2], curve, true);
    }
    let pcurves = [0.0, 360.0].map(|u| plane_curve(&mut text, [u, 0.0], [0.0, 1.0]));
    let seam = text.add(format!("SEAM_CURVE('',#{profile},{},.PCURVE_S1.)", list(&pcurves)));
    let seam = text.edge(seam_ends, seam, true);
    let bound = text.bound(&[(circles[0], true), (seam, true), (circles[1], false), (seam, false)]);
    let side = text.face(surface, &[bound], true);
    let faces = [side, disc(&mut text, circles[0], 0.0, false), disc(&mut text, circles[1], 3.0, true)];
    let solid = text.solid("barrel", &faces);
    let context = text.inches();
    text.product("barrel", &[solid], context);
    let assembly = read(&text.finish());
    assert_eq!(assembly.notes, Vec::<String>::new());
    // ρ = 2 + 4t(1−t), z = 3t: V = π ∫ ρ² dz = 3π (4 + 16/6 + 16/30), by Simpson for the area.
    let volume = 3.0 * PI * (4.0 + 16.0 / 6.0 + 16.0 / 30.0);
    let ring = |t: f64| TAU * (2.0 + 4.0 * t * (1.0 - t)) * (4.0 - 8.0 * t).hypotenuse(3.0);
    let simpson = |at: i32| {
        let [a, b] = [f64::from(at) / 1000.0, f64::from(at + 1) / 1000.0];
        (b - a) / 6.0 * (ring(a) + 4.0 * ring(0.5 * (a + b)) + ring(b))
    };
    let area = (0..1000).map(simpson).sum::<f64>() + 2.0 * PI * 4.0;
    let inch: f64 = 0.0254;
    assert_measures(&assembly.parts[0], area * inch.powi(2), volume * inch.powi(3));
}

/// A great circle through both poles as one edge.
#[test]
fn an_edge_through_poles_halves_a_ball() {
    let mut text = Text::new();
    let edge = text.circle(DVec3::ZERO, DVec3::X, DVec3::Y, 25.0);
    let frame = text.frame(DVec3::ZERO, DVec3::Z, DVec3::new(1.0, 1.0, 0.0));
    let surface = text.add(format!("SPHERICAL_SURFACE('',#{frame},25.)"));
    let bound = text.bound(&[(edge, true)]);
    let dome = text.face(surface, &[bound], true);
    let frame = text.frame(DVec3::ZERO, -DVec3::X, DVec3::Y);
    let plane = text.add(format!("PLANE('',#{frame})"));
    let bound = text.bound(&[(edge, false)]);
    let base = text.face(plane, &[bound], true);
    let solid = text.solid("dome", &[dome, base]);
    let part = only_part(text, solid);
    let square = 0.025 * 0.025;
    assert_measures(&part, 3.0 * PI * square, 2.0 / 3.0 * PI * square * 0.025);
}

/// A quarter of a cone: two generators meet at the apex.
#[test]
fn a_wedge_of_a_cone_meets_its_apex() {
    let (radius, height) = (30.0, 40.0);
    let mut text = Text::new();
    let places = [radius * DVec3::X, radius * DVec3::Y, height * DVec3::Z, DVec3::ZERO];
    let [a, b, apex, centre] = places.map(|at| text.vertex(at));
    let frame = text.frame(DVec3::ZERO, DVec3::Z, DVec3::X);
    let circle = text.add(format!("CIRCLE('',#{frame},{radius:?})"));
    let arc = text.edge([a, b], circle, true);
    let mut side = |ends: [u64; 2], from: usize, to: usize| text.straight(ends, places[from], places[to]);
    let (up_a, up_b) = (side([a, apex], 0, 2), side([b, apex], 1, 2));
    let (in_a, in_b, axis) = (side([a, centre], 0, 3), side([b, centre], 1, 3), side([centre, apex], 3, 2));
    let frame = text.frame(DVec3::ZERO, -DVec3::Z, DVec3::X);
    let cone =
        text.add(format!("CONICAL_SURFACE('',#{frame},{radius:?},{:?})", (radius / height).arc_tangent()));
    let bound = text.bound(&[(arc, true), (up_b, true), (up_a, false)]);
    let cone = text.face(cone, &[bound], true);
    let mut flat = |axis: DVec3, reference: DVec3, edges: &[(u64, bool)]| {
        let frame = text.frame(DVec3::ZERO, axis, reference);
        let plane = text.add(format!("PLANE('',#{frame})"));
        let bound = text.bound(edges);
        text.face(plane, &[bound], true)
    };
    let faces = [
        cone,
        flat(-DVec3::Z, DVec3::X, &[(arc, false), (in_a, true), (in_b, false)]),
        flat(-DVec3::Y, DVec3::X, &[(up_a, true), (axis, false), (in_a, false)]),
        flat(-DVec3::X, DVec3::Y, &[(up_b, false), (in_b, true), (axis, true)]),
    ];
    let solid = text.solid("wedge", &faces);
    assert_closed(text.finish().as_bytes());
    let part = only_part(text, solid);
    let area = 0.25 * PI * (0.03 * 0.05 + 0.03 * 0.03) + 0.03 * 0.04;
    assert_measures(&part, area, 0.25 * PI * 0.03 * 0.03 * 0.04 / 3.0);
}

/// The outer part of a torus whose tube is thicker than its ring.
#[test]
fn an_apple_has_its_area_and_volume() {
    let mut text = Text::new();
    let frame = text.frame(DVec3::ZERO, DVec3::Z, DVec3::X);
    let surface = text.add(format!("DEGENERATE_TOROIDAL_SURFACE('',#{frame},10.,20.,.T.)"));
    let face = text.face(surface, &[], true);
    let solid = text.solid("apple", &[face]);
    let part = only_part(text, solid);
    let (ring, tube) = (0.01, 0.02);
    let end = Elementary::arc_cosine(-ring / tube);
    let area = 4.0 * PI * tube * (ring * end + tube * end.sine());
    let volume = PI
        * tube
        * (2.0 * ring * ring * end.sine()
            + 2.0 * ring * tube * (end + end.sine() * end.cosine())
            + tube * tube * (2.0 * end.sine() - 2.0 / 3.0 * end.sine().powi(3)));
    assert_measures(&part, area, volume);
}

/// A ball as one rational B-spline surface: its poles are collapsed sides, its seam is one edge used twice.
#[test]
fn a_ball_of_splines_has_poles() {
    for has_bounds in [false, true] {
        let radius = 25.0;
        let mut text = Text::new();
        // Rows along the equator, columns from pole to pole.
        let columns = [
            (-1.0, 0.0, 1.0),
            (-1.0, 1.0, FRAC_1_SQRT_2),
            (0.0, 1.0, 1.0),
            (1.0, 1.0, FRAC_1_SQRT_2),
            (1.0, 0.0, 1.0),
        ];
        let (circle, weights) = circle_poles(1.0, 0.0);
        let mut rows = Vec::new();
        let mut weight_rows = Vec::new();
        for (out, weight) in circle.iter().zip(weights) {
            let poles: Vec<u64> = columns
                .iter()
                .map(|(z, along, _)| text.point(radius * (*along * *out + *z * DVec3::Z)))
                .collect();
            rows.push(list(&poles));
            weight_rows.push(reals(&columns.map(|(_, _, own)| own * weight)));
        }
        let surface = text.add(format!(
            "( BOUNDED_SURFACE() B_SPLINE_SURFACE(2,2,({}),.UNSPECIFIED.,.T.,.F.,.F.) \
             B_SPLINE_SURFACE_WITH_KNOTS((3,2,2,2,3),(3,2,3),(0.,1.,2.,3.,4.),(0.,1.,2.),.UNSPECIFIED.) \
             GEOMETRIC_REPRESENTATION_ITEM() RATIONAL_B_SPLINE_SURFACE(({})) REPRESENTATION_ITEM('') SURFACE() )",
            rows.join(","),
            weight_rows.join(",")
        ));
        let bounds = if has_bounds {
            let ends = [-radius, radius].map(|z| text.vertex(z * DVec3::Z));
            let frame = text.frame(DVec3::ZERO, -DVec3::Y, DVec3::X);
            let circle = text.add(format!("CIRCLE('',#{frame},{radius:?})"));
            let seam = text.edge(ends, circle, true);
            vec![text.bound(&[(seam, true), (seam, false)])]
        } else {
            Vec::new()
        };
        let face = text.face(surface, &bounds, true);
        let solid = text.solid("ball", &[face]);
        let part = only_part(text, solid);
        assert_measures(&part, 4.0 * PI * 0.025 * 0.025, 4.0 / 3.0 * PI * 0.025_f64.powi(3));
    }
}

/// A stadium: its side is an extruded composite of trimmed curves in one edge; planes with flags the other way round.
#[test]
fn composite_edges_and_turned_flags() {
    let (length, radius, height) = (40.0, 10.0, 15.0);
    let mut text = Text::new();
    let mut rims = [0; 2];
    let mut segments = Vec::new();
    let start = DVec3::new(0.0, -radius, 0.0);
    for (at, z) in [0.0, height].into_iter().enumerate() {
        let up = z * DVec3::Z;
        let mut pieces = Vec::new();
        let corners =
            [start, start + length * DVec3::X, start + DVec3::new(length, 2.0 * radius, 0.0), -start];
        for side in 0..4 {
            let (from, to) = (corners[side] + up, corners[(side + 1) % 4] + up);
            let curve = if side % 2 == 0 {
                let (origin, direction) = (text.point(from), text.direction(to - from));
                let vector = text.add(format!("VECTOR('',#{direction},1.)"));
                text.add(format!("LINE('',#{origin},#{vector})"))
            } else {
                let frame = text.frame(0.5 * (from + to), DVec3::Z, DVec3::Y);
                text.add(format!("CIRCLE('',#{frame},{radius:?})"))
            };
            let ends = [from, to].map(|at| text.point(at));
            // Every other segment is trimmed and run backwards twice.
            let curve = if side < 2 {
                text.add(format!("TRIMMED_CURVE('',#{curve},(#{}),(#{}),.T.,.CARTESIAN.)", ends[0], ends[1]))
            } else {
                text.add(format!("TRIMMED_CURVE('',#{curve},(#{}),(#{}),.F.,.CARTESIAN.)", ends[1], ends[0]))
            };
            let sense = if side < 2 { ".T." } else { ".F." };
            pieces.push(text.add(format!("COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,{sense},#{curve})")));
        }
        let rim = text.add(format!("COMPOSITE_CURVE('',{},.F.)", list(&pieces)));
        let vertex = text.vertex(start + up);
        rims[at] = text.edge([vertex; 2], rim, true);
        segments.push(vertex);
    }
    // A plane whose normal is against the face's, and a bound against its loop.
    let mut lids = Vec::new();
    for (at, z) in [0.0, height].into_iter().enumerate() {
        let is_top = at == 1;
        let frame = text.frame(z * DVec3::Z, if is_top { -DVec3::Z } else { DVec3::Z }, DVec3::X);
        let plane = text.add(format!("PLANE('',#{frame})"));
        let run =
            text.add(format!("ORIENTED_EDGE('',*,*,#{},{})", rims[at], if is_top { ".F." } else { ".T." }));
        let edges = text.add(format!("EDGE_LOOP('',(#{run}))"));
        let bound = text.add(format!("FACE_OUTER_BOUND('',#{edges},.F.)"));
        lids.push(text.face(plane, &[bound], false));
    }
    let solid = text.solid("lids", &lids);
    let part = only_part(text, solid);
    let [area, volume] = super::integrate::totals(&part);
    let lid = PI * 0.01 * 0.01 + 0.02 * 0.04;
    assert_near(area, 2.0 * lid, 1e-4);
    // Planes at 0 and at the height: a third of that height times the area of the upper.
    assert_near(volume, lid * 0.015 / 3.0, 1e-4);
}
