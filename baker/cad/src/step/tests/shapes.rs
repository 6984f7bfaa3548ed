//! Solids of which area and volume are known.

use super::integrate::{assert_near, totals};
use super::text::{Text, list};
use super::{assert_closed, read};
use crate::face::Face;
use crate::model::{FaceColour, Part};
use crate::surface::Surface;
use crate::trim::TrimEdge;
use glam::{DQuat, DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::PI;

/// The one part of a file with this solid.
pub fn only_part(mut text: Text, solid: u64) -> Part {
    let context = text.millimetres();
    text.product("thing", &[solid], context);
    let assembly = read(&text.finish());
    assert_eq!(assembly.notes, Vec::<String>::new());
    assert_eq!((assembly.parts.len(), assembly.instances.len()), (1, 1));
    assembly.parts.into_iter().next().unwrap()
}

/// Area and volume to 1e-4.
pub fn assert_measures(part: &Part, area: f64, volume: f64) {
    let [found_area, found_volume] = totals(part);
    assert_near(found_area, area, 1e-4);
    assert_near(found_volume, volume, 1e-4);
}

#[test]
fn a_turned_box_has_its_area_and_volume() {
    let mut text = Text::new();
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 2.0);
    let (solid, _) = text.cuboid(DVec3::new(100.0, 200.0, 300.0), turn, DVec3::new(5.0, 7.0, -9.0));
    assert_closed(text.finish().as_bytes());
    let part = only_part(text, solid);
    assert!(part.is_closed);
    assert_eq!(part.name, "thing");
    assert_measures(&part, 0.22, 0.006);
}

/// A tube: plane rings with whole circles, cylinders with or without a seam.
fn tube(with_seam: bool) -> (Text, u64) {
    let mut text = Text::new();
    let mut faces = Vec::new();
    let reference = DVec3::new(0.6, 0.8, 0.0);
    let (low, high) = (DVec3::new(10.0, 20.0, -5.0), DVec3::new(10.0, 20.0, 95.0));
    let circles =
        [50.0, 20.0].map(|radius| [low, high].map(|centre| text.circle(centre, DVec3::Z, reference, radius)));
    for (at, radius) in [50.0, 20.0].into_iter().enumerate() {
        let frame = text.frame(low, DVec3::Z, DVec3::X);
        let surface = text.add(format!("CYLINDRICAL_SURFACE('',#{frame},{radius:?})"));
        let [bottom, top] = circles[at];
        let is_outer = at == 0;
        let bounds = if with_seam {
            // The vertices of a seam are those of the circles.
            let (a, b) = (low + radius * reference, high + radius * reference);
            let ends = [vertex_of(&text, bottom), vertex_of(&text, top)];
            let seam = text.straight(ends, a, b);
            let mut bound = vec![(bottom, true), (seam, true), (top, false), (seam, false)];
            if !is_outer {
                bound.reverse();
                bound.iter_mut().for_each(|(_, forward)| *forward = !*forward);
            }
            vec![text.bound(&bound)]
        } else {
            vec![text.bound(&[(bottom, is_outer)]), text.bound(&[(top, !is_outer)])]
        };
        faces.push(text.face(surface, &bounds, is_outer));
    }
    for (at, centre) in [low, high].into_iter().enumerate() {
        let is_top = at == 1;
        let frame = text.frame(centre, DVec3::Z, DVec3::Y);
        let surface = text.add(format!("PLANE('',#{frame})"));
        let bounds = [text.bound(&[(circles[0][at], is_top)]), text.bound(&[(circles[1][at], !is_top)])];
        faces.push(text.face(surface, &bounds, is_top));
    }
    let solid = text.solid("tube", &faces);
    (text, solid)
}

/// The start vertex of an edge.
fn vertex_of(text: &Text, edge: u64) -> u64 {
    let whole = text.finish();
    let line = whole.lines().find(|line| line.starts_with(&format!("#{edge} ="))).unwrap();
    line.split('#').nth(2).unwrap().trim_end_matches(',').parse().unwrap()
}

#[test]
fn a_tube_has_its_area_and_volume_with_and_without_seams() {
    for with_seam in [false, true] {
        let (text, solid) = tube(with_seam);
        assert_closed(text.finish().as_bytes());
        let part = only_part(text, solid);
        let ring = PI * (0.05 * 0.05 - 0.02 * 0.02);
        assert_measures(&part, 2.0 * PI * 0.07 * 0.1 + 2.0 * ring, ring * 0.1);
        for (face, _) in &part.faces {
            match face.surface {
                // Rectangles over one period.
                Surface::Cylinder { .. } => {
                    assert_eq!(face.loops.len(), 1);
                    let across = |edge: &TrimEdge| {
                        let [a, b] = edge.ends();
                        [a.x, b.x]
                    };
                    let all: Vec<f64> = face.loops[0].iter().flat_map(across).collect();
                    let range = all.iter().copied().fold(f64::NEG_INFINITY, f64::max)
                        - all.iter().copied().fold(f64::INFINITY, f64::min);
                    assert!((range - 2.0 * PI).abs() < 1e-12);
                    assert!(face.loops[0].len() <= 8, "{:?}", face.loops);
                }
                // Circles stay circles.
                _ => assert!(face.loops.iter().flatten().all(|edge| matches!(edge, TrimEdge::Arc { .. }))),
            }
        }
    }
}

#[test]
fn a_sphere_has_its_area_and_volume_without_bounds_with_a_seam_and_in_caps() {
    let centre = DVec3::new(3.0, -4.0, 12.0);
    let axis = DVec3::new(1.0, 2.0, 2.0) / 3.0;
    let across = DVec3::new(2.0, 1.0, -2.0) / 3.0;
    let sphere = |text: &mut Text| {
        let frame = text.frame(centre, axis, across);
        text.add(format!("SPHERICAL_SURFACE('',#{frame},25.)"))
    };
    for kind in 0..5 {
        let mut text = Text::new();
        let surface = sphere(&mut text);
        let faces = match kind {
            // No bounds, or only a vertex.
            0 => vec![text.face(surface, &[], true)],
            1 => {
                let pole = text.vertex(centre + 25.0 * axis);
                let pole = text.add(format!("VERTEX_LOOP('',#{pole})"));
                let bound = text.add(format!("FACE_OUTER_BOUND('',#{pole},.T.)"));
                vec![text.face(surface, &[bound], true)]
            }
            // One seam from pole to pole, used twice.
            2 => {
                let ends = [-1.0, 1.0].map(|side| text.vertex(centre + side * 25.0 * axis));
                let frame = text.frame(centre, across.cross(axis), across);
                let circle = text.add(format!("CIRCLE('',#{frame},25.)"));
                let seam = text.edge(ends, circle, true);
                let bound = text.bound(&[(seam, true), (seam, false)]);
                vec![text.face(surface, &[bound], true)]
            }
            // Two caps about the poles, and two about an axis askew.
            _ => {
                let tilt = if kind == 3 { axis } else { (axis + 2.0 * across).normalize() };
                let reference = tilt.any_orthonormal_vector();
                let edge = text.circle(centre + 7.0 * tilt, tilt, reference, (25.0_f64 * 25.0 - 49.0).sqrt());
                let above = text.bound(&[(edge, true)]);
                let below = text.bound(&[(edge, false)]);
                vec![text.face(surface, &[above], true), text.face(surface, &[below], true)]
            }
        };
        let solid = text.solid("ball", &faces);
        let part = only_part(text, solid);
        assert_measures(&part, 4.0 * PI * 0.025 * 0.025, 4.0 / 3.0 * PI * 0.025_f64.powi(3));
        if kind == 3 {
            // The cap of height h has the area 2πRh.
            let [cap, _] = super::integrate::area_and_volume(&part.faces[0].0);
            assert_near(cap, 2.0 * PI * 0.025 * 0.018, 1e-4);
        }
    }
}

#[test]
fn a_cone_closes_at_its_apex() {
    // Wide below, so its semi-angle is written about the turned axis, or as a negative one.
    for negative in [false, true] {
        let mut text = Text::new();
        let edge = text.circle(DVec3::ZERO, DVec3::Z, DVec3::X, 30.0);
        let (axis, angle) = if negative {
            (DVec3::Z, -(0.75_f64.arc_tangent()))
        } else {
            (-DVec3::Z, 0.75_f64.arc_tangent())
        };
        let frame = text.frame(DVec3::ZERO, axis, DVec3::X);
        let surface = text.add(format!("CONICAL_SURFACE('',#{frame},30.,{angle:?})"));
        let side = text.bound(&[(edge, true)]);
        let apex = text.vertex(DVec3::new(0.0, 0.0, 40.0));
        let apex = text.add(format!("VERTEX_LOOP('',#{apex})"));
        let apex = text.add(format!("FACE_BOUND('',#{apex},.T.)"));
        let side = text.face(surface, &[side, apex], true);
        let frame = text.frame(DVec3::ZERO, -DVec3::Z, DVec3::X);
        let surface = text.add(format!("PLANE('',#{frame})"));
        let base = text.bound(&[(edge, false)]);
        let base = text.face(surface, &[base], true);
        let solid = text.solid("cone", &[side, base]);
        assert_closed(text.finish().as_bytes());
        let part = only_part(text, solid);
        assert_measures(&part, PI * 0.03 * 0.05 + PI * 0.03 * 0.03, PI * 0.03 * 0.03 * 0.04 / 3.0);
    }
}

#[test]
fn a_torus_has_its_area_whole_and_in_halves_either_way() {
    let (major, minor) = (40.0, 10.0);
    for kind in 0..3 {
        let mut text = Text::new();
        let frame = text.frame(DVec3::ZERO, DVec3::Z, DVec3::X);
        let surface = text.add(format!("TOROIDAL_SURFACE('',#{frame},{major:?},{minor:?})"));
        let faces = match kind {
            0 => vec![text.face(surface, &[], true)],
            // Above and below the equator.
            1 => {
                let outer = text.circle(DVec3::ZERO, DVec3::Z, DVec3::X, major + minor);
                let inner = text.circle(DVec3::ZERO, DVec3::Z, DVec3::Y, major - minor);
                let above = [text.bound(&[(outer, true)]), text.bound(&[(inner, false)])];
                let below = [text.bound(&[(outer, false)]), text.bound(&[(inner, true)])];
                vec![text.face(surface, &above, true), text.face(surface, &below, true)]
            }
            // Two bows, of one and of five sixths.
            _ => {
                let around = [0.4_f64, 0.4 + PI / 3.0].map(|angle| {
                    let out = DVec3::new(angle.cosine(), angle.sine(), 0.0);
                    // Its axis along −u: then it runs along +v.
                    text.circle(major * out, out.cross(DVec3::Z), out, minor)
                });
                let small = [text.bound(&[(around[0], false)]), text.bound(&[(around[1], true)])];
                let large = [text.bound(&[(around[0], true)]), text.bound(&[(around[1], false)])];
                vec![text.face(surface, &small, true), text.face(surface, &large, true)]
            }
        };
        let solid = text.solid("ring", &faces);
        let part = only_part(text, solid);
        let area = 4.0 * PI * PI * 0.04 * 0.01;
        assert_measures(&part, area, 2.0 * PI * PI * 0.04 * 0.01 * 0.01);
        if kind == 2 {
            let [bow, _] = super::integrate::area_and_volume(&part.faces[0].0);
            assert_near(bow, area / 6.0, 1e-4);
        }
    }
}

/// A cylinder cut askew: an ellipse on a plane, a wave on the cylinder.
#[test]
fn an_oblique_section_keeps_its_ellipse() {
    let (radius, slope) = (20.0, 0.75);
    let mut text = Text::new();
    let bottom = text.circle(DVec3::ZERO, DVec3::Z, DVec3::X, radius);
    let centre = DVec3::new(0.0, 0.0, 60.0);
    let normal = DVec3::new(-slope, 0.0, 1.0).normalize();
    let along = DVec3::new(1.0, 0.0, slope).normalize();
    let frame = text.frame(centre, normal, along);
    let ellipse = text.add(format!("ELLIPSE('',#{frame},{:?},{radius:?})", radius * 1.25));
    let vertex = text.vertex(centre + 1.25 * radius * along);
    let top = text.edge([vertex; 2], ellipse, true);
    let frame = text.frame(DVec3::ZERO, DVec3::Z, DVec3::Y);
    let surface = text.add(format!("CYLINDRICAL_SURFACE('',#{frame},{radius:?})"));
    let bounds = [text.bound(&[(bottom, true)]), text.bound(&[(top, false)])];
    let side = text.face(surface, &bounds, true);
    let frame = text.frame(centre, normal, DVec3::new(1.0, 2.0, 0.0));
    let surface = text.add(format!("PLANE('',#{frame})"));
    let bounds = [text.bound(&[(top, true)])];
    let lid = text.face(surface, &bounds, true);
    let frame = text.frame(DVec3::ZERO, -DVec3::Z, DVec3::X);
    let surface = text.add(format!("PLANE('',#{frame})"));
    let bounds = [text.bound(&[(bottom, false)])];
    let base = text.face(surface, &bounds, true);
    let solid = text.solid("cut", &[side, lid, base]);
    assert_closed(text.finish().as_bytes());
    let part = only_part(text, solid);
    assert!(matches!(part.faces[1].0.loops[0][..], [TrimEdge::Arc { .. }]));
    let disc = PI * 0.02 * 0.02;
    assert_measures(&part, 2.0 * PI * 0.02 * 0.06 + 2.25 * disc, disc * 0.06);
}

/// The same solid as polygons without edges or surfaces.
#[test]
fn a_faceted_tetrahedron_is_read() {
    let mut text = Text::new();
    let points = [DVec3::ZERO, 60.0 * DVec3::X, 60.0 * DVec3::Y, 60.0 * DVec3::Z].map(|at| text.point(at));
    let corners = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let faces = corners.map(|corners| {
        let polygon = text.add(format!("POLY_LOOP('',{})", super::text::list(&corners.map(|at| points[at]))));
        let bound = text.add(format!("FACE_OUTER_BOUND('',#{polygon},.T.)"));
        text.add(format!("FACE('',(#{bound}))"))
    });
    let shell = text.add(format!("CLOSED_SHELL('',{})", super::text::list(&faces)));
    let solid = text.add(format!("FACETED_BREP('',#{shell})"));
    let part = only_part(text, solid);
    assert_measures(&part, 0.06 * 0.06 * (1.5 + 3.0_f64.sqrt() / 2.0), 0.06_f64.powi(3) / 6.0);
}

/// A box of which one face says that its normal is against that of its plane, which its edges contradict: in a closed shell the
/// edges count, in an open one the flag does.
#[test]
fn a_normal_against_the_bounds_is_turned_in_a_closed_shell() {
    for is_closed in [true, false] {
        let mut text = Text::new();
        let (solid, faces) = text.cuboid(DVec3::new(100.0, 200.0, 300.0), DQuat::IDENTITY, DVec3::ZERO);
        let context = text.millimetres();
        let item = if is_closed {
            solid
        } else {
            let shell = text.add(format!("OPEN_SHELL('',{})", list(&faces)));
            text.add(format!("SHELL_BASED_SURFACE_MODEL('',(#{shell}))"))
        };
        text.product("thing", &[item], context);
        let whole = text.finish();
        let line = whole.lines().find(|line| line.starts_with(&format!("#{} =", faces[3]))).unwrap();
        assert!(line.ends_with(",.T.);"));
        let wrong = whole.replace(line, &line.replace(",.T.);", ",.F.);"));
        let normals = |text: &str| -> Vec<DVec3> {
            let normal = |(face, _): &(Face, FaceColour)| {
                let normal = face.surface.normal(DVec2::ZERO);
                if face.is_reversed { -normal } else { normal }
            };
            read(text).parts[0].faces.iter().map(normal).collect()
        };
        let mut expected = normals(&whole);
        let notes = read(&wrong).notes;
        if is_closed {
            assert_near(totals(&read(&wrong).parts[0])[1], 0.006, 1e-9);
            assert_eq!(notes, ["1 face of \"thing\": the normal is against the bounds and is turned"]);
        } else {
            expected[3] = -expected[3];
            assert_eq!(notes, read(&whole).notes);
        }
        assert_eq!(normals(&wrong), expected);
    }
}
