//! Laws of virtual meshes, for each kind of surface.

use super::*;
use crate::curve::Curve;
use crate::curve::nurbs::NurbsCurve;
use crate::frame::Frame;
use crate::random::SplitMix;
use crate::surface::NurbsSurface;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The border of a rectangle of parameters.
fn rectangle(low: DVec2, high: DVec2) -> Vec<TrimEdge> {
    let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    (0..4).map(|i| TrimEdge::Segment { from: corners[i], to: corners[(i + 1) % 4] }).collect()
}

/// A curve in the plane of the axis and x of a frame, placed there by its own.
fn profile_frame(frame: &Frame, out: f64, along: f64, angle: f64) -> Frame {
    let x = angle.cosine() * frame.x + angle.sine() * frame.z;
    Frame::new(frame.place(DVec3::new(out, 0.0, along)), -frame.y, x).unwrap()
}

/// A wavy B-spline surface, rational.
fn wavy(numbers: &mut SplitMix, degree: usize) -> NurbsSurface {
    let counts = [degree + 3, degree + 2];
    let knots = counts.map(|count| {
        let inner = (1..count - degree).map(|i| i as f64 / (count - degree) as f64);
        let ends = |end: f64| std::iter::repeat_n(end, degree + 1);
        ends(0.0).chain(inner).chain(ends(1.0)).collect()
    });
    let mut poles = Vec::new();
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            let flat = DVec3::new(i as f64, 0.0, j as f64);
            poles.push(flat + 0.3 * numbers.vector() + numbers.between(0.0, 1.5) * DVec3::Y);
        }
    }
    let weights = poles.iter().map(|_| numbers.between(0.5, 2.0)).collect();
    NurbsSurface::new([degree; 2], knots, counts, poles, weights).unwrap()
}

/// Surfaces of every kind, with a patch of each.
fn surfaces() -> Vec<(&'static str, Surface, [DVec2; 2])> {
    let mut numbers = SplitMix(41);
    let frame = numbers.frame();
    let patch = |a: f64, b: f64, c: f64, d: f64| [DVec2::new(a, b), DVec2::new(c, d)];
    let turned = |profile: Curve| Surface::Revolution { frame, profile };
    let spline = NurbsCurve::new(
        3,
        vec![0.0, 0.0, 0.0, 0.0, 0.4, 1.0, 1.0, 1.0, 1.0],
        [[1.0, 0.0], [1.5, 0.5], [0.4, 1.0], [0.8, 1.8], [0.0, 2.0]]
            .map(|[out, along]| frame.place(DVec3::new(out, 0.0, along)))
            .to_vec(),
        vec![1.0, 2.0, 0.7, 1.0, 1.0],
    )
    .unwrap();
    let skew = Curve::Line { origin: frame.place(DVec3::new(1.0, 0.0, 0.0)), direction: numbers.direction() };
    let line = |out: f64, direction: DVec3| Curve::Line {
        origin: frame.place(DVec3::new(out, 0.0, 0.3)),
        direction: frame.turn(direction),
    };
    let [across, along] = [profile_frame(&frame, 0.0, 0.2, 0.0), profile_frame(&frame, 0.0, 0.2, FRAC_PI_2)];
    vec![
        ("plane", Surface::Plane(frame), patch(-1.0, 2.0, 3.0, 2.5)),
        ("cylinder", Surface::Cylinder { frame, radius: 0.7 }, patch(-1.0, -2.0, TAU - 1.0, 1.0)),
        ("cone", Surface::Cone { frame, radius: 0.5, half_angle: 0.4 }, patch(0.0, -0.3, 4.0, 2.0)),
        (
            "cone from its apex",
            Surface::Cone { frame, radius: 0.0, half_angle: 0.9 },
            patch(0.0, 0.0, TAU, 2.0),
        ),
        ("both nappes", Surface::Cone { frame, radius: 0.2, half_angle: 0.6 }, patch(0.0, -2.0, 1.0, 1.0)),
        ("sphere", Surface::Sphere { frame, radius: 1.7 }, patch(0.0, -FRAC_PI_2, TAU, FRAC_PI_2)),
        ("part of a sphere", Surface::Sphere { frame, radius: 1.7 }, patch(-2.0, -1.0, 1.0, 1.4)),
        ("torus", Surface::Torus { frame, major: 2.0, minor: 0.9 }, patch(0.0, 0.0, TAU, TAU)),
        ("lemon", Surface::Torus { frame, major: 0.4, minor: 1.0 }, patch(0.0, -1.9, 3.0, 1.9)),
        ("disk", turned(line(0.0, DVec3::X)), patch(0.0, 0.0, TAU, 2.0)),
        ("ring", turned(line(3.0, DVec3::new(-2.0, 0.0, 0.0))), patch(0.5, 0.0, 2.0, 1.2)),
        ("cone of a line", turned(line(1.0, DVec3::new(0.5, 0.0, 1.0))), patch(0.0, -1.0, 3.0, 2.0)),
        ("tube", turned(line(1.0, DVec3::Z)), patch(0.0, -1.0, 3.0, 2.0)),
        ("hyperboloid of a line", turned(skew), patch(0.0, -2.0, 3.0, 2.0)),
        (
            "oblate spheroid",
            turned(Curve::Ellipse { frame: across, radii: [2.0, 0.8] }),
            patch(0.0, -FRAC_PI_2, TAU, FRAC_PI_2),
        ),
        (
            "prolate spheroid",
            turned(Curve::Ellipse { frame: along, radii: [2.0, 0.8] }),
            patch(0.0, 0.0, TAU, PI),
        ),
        (
            "other half of a spheroid",
            turned(Curve::Ellipse { frame: across, radii: [0.8, 2.0] }),
            patch(0.0, FRAC_PI_2 + 0.1, TAU, 1.5 * PI - 0.3),
        ),
        (
            "sphere of a circle",
            turned(Curve::Circle { frame: along, radius: 1.2 }),
            patch(0.0, 0.2, 3.0, 2.9),
        ),
        (
            "torus of a circle",
            turned(Curve::Circle { frame: profile_frame(&frame, 3.0, 0.0, 0.7), radius: 1.2 }),
            patch(0.0, -1.0, 3.0, 4.0),
        ),
        (
            "core of an apple",
            turned(Curve::Circle { frame: profile_frame(&frame, 0.5, 0.0, 0.0), radius: 1.2 }),
            patch(0.0, 2.1, 3.0, 4.0),
        ),
        (
            "hyperboloid of one sheet",
            turned(Curve::Hyperbola { frame: across, radii: [0.6, 1.1] }),
            patch(0.0, -1.0, TAU, 1.5),
        ),
        (
            "hyperboloid of two sheets",
            turned(Curve::Hyperbola { frame: along, radii: [0.6, 1.1] }),
            patch(0.0, 0.0, TAU, 1.5),
        ),
        (
            "paraboloid",
            turned(Curve::Parabola { frame: along, focal_distance: 0.4 }),
            patch(0.0, -1.5, TAU, 0.0),
        ),
        (
            "bell of an ellipse aside",
            turned(Curve::Ellipse { frame: profile_frame(&frame, 2.0, 0.0, 0.3), radii: [1.0, 0.4] }),
            patch(0.0, 0.0, 2.0, TAU),
        ),
        ("vase", turned(Curve::Nurbs(spline.clone())), patch(0.0, 0.0, TAU, 1.0)),
        (
            "extruded circle",
            Surface::Extrusion {
                profile: Curve::Circle { frame, radius: 1.1 },
                along: frame.turn(DVec3::new(0.3, 0.0, 2.0)),
            },
            patch(0.0, 0.0, TAU, 1.0),
        ),
        (
            "extruded spline",
            Surface::Extrusion {
                profile: Curve::Nurbs(spline),
                along: frame.turn(DVec3::new(0.0, 1.5, 0.2)),
            },
            patch(0.0, -1.0, 1.0, 1.0),
        ),
        ("bilinear patch", Surface::Nurbs(wavy(&mut numbers, 1)), patch(0.0, 0.0, 1.0, 1.0)),
        ("cubic NURBS", Surface::Nurbs(wavy(&mut numbers, 3)), patch(0.0, 0.0, 1.0, 1.0)),
    ]
}

fn mesh(surface: &Surface, loops: Vec<Vec<TrimEdge>>) -> VirtualMesh {
    VirtualMesh::new(&Face { surface: surface.clone(), is_reversed: false, loops }).unwrap()
}

/// A loop within a patch, that is no rectangle: an arc and a corner.
fn trimmed([low, high]: [DVec2; 2]) -> Vec<TrimEdge> {
    let side = high - low;
    let at = |x: f64, y: f64| low + side * DVec2::new(x, y);
    let [a, b, c] = [at(0.9, 0.5), at(0.1, 0.5), at(0.3, 0.1)];
    vec![
        TrimEdge::Arc { centre: at(0.5, 0.5), radii: 0.4 * side, angles: [0.0, PI] },
        TrimEdge::Segment { from: b, to: c },
        TrimEdge::Segment { from: c, to: a },
    ]
}

#[test]
fn jacobian_is_constant() {
    let mut numbers = SplitMix(42);
    for (name, surface, patch) in surfaces() {
        for loops in [rectangle(patch[0], patch[1]), trimmed(patch)] {
            let mesh = mesh(&surface, vec![loops]);
            let [mut checked, mut kinks] = [0; 2];
            while checked < 300 {
                let st = numbers.point(DVec2::splat(0.002), DVec2::splat(0.998));
                let h = 1e-5;
                // Tables have no points beyond the domain.
                if [DVec2::new(h, h), DVec2::new(-h, h), DVec2::new(h, -h), DVec2::new(-h, -h)]
                    .iter()
                    .any(|corner| !mesh.is_real(st + 4.0 * *corner))
                {
                    continue;
                }
                checked += 1;
                let difference = |along: DVec2| mesh.point(st + h * along) - mesh.point(st - h * along);
                let [along_s, along_t] = [difference(DVec2::X), difference(DVec2::Y)];
                let jacobian = along_s.cross(along_t).length() / (4.0 * h * h * mesh.area());
                // At a pole differences are no derivatives, and at knots they have two.
                let speed = along_s.length().max(along_t.length()) / (2.0 * h);
                let is_kink = speed * speed > 400.0 * mesh.area();
                kinks += i32::from(is_kink);
                assert!((jacobian - 1.0).abs() < 1e-4 || is_kink, "{name} at {st}: {jacobian}");
            }
            assert!(kinks < 10, "{name}: {kinks}");
        }
    }
}

#[test]
fn whole_patches_have_the_area_of_the_surface() {
    for (name, surface, patch) in surfaces() {
        let mesh = mesh(&surface, vec![rectangle(patch[0], patch[1])]);
        // Between knots, where the surface is smooth.
        let side = (patch[1] - patch[0]) / 6.0;
        let part = |i: u32| patch[0] + side * DVec2::new(f64::from(i % 6), f64::from(i / 6));
        let exact: f64 = (0..36).map(|i| surface.area([part(i), part(i) + side])).sum();
        assert!((mesh.area() / exact - 1.0).abs() < 1e-4, "{name}: {} and {exact}", mesh.area());
        assert!((mesh.real_area() / exact - 1.0).abs() < 1e-4, "{name}: {}", mesh.real_area());
        assert!((mesh.real_share([DVec2::ZERO, DVec2::ONE]) - 1.0).abs() < 1e-6, "{name}");
        assert_eq!(mesh.coverage([DVec2::ZERO, DVec2::splat(0.5)]), Coverage::Plain, "{name}");
    }
}

#[test]
fn densities_of_natural_parameters_are_area_elements() {
    let mut numbers = SplitMix(46);
    let mut uneven = 0;
    for (name, surface, patch) in surfaces() {
        for loops in [rectangle(patch[0], patch[1]), trimmed(patch)] {
            let face = Face { surface: surface.clone(), is_reversed: false, loops: vec![loops] };
            let [equal, mesh] = [VirtualMesh::new, VirtualMesh::natural].map(|map| map(&face).unwrap());
            assert!(equal.is_equal_area() && equal.density(DVec2::splat(0.3)) == 1.0);
            uneven += i32::from(!mesh.is_equal_area());
            let [area, expected] = [mesh.real_area(), equal.real_area()];
            // At the creases of one the area element jumps.
            let most = if name == "bilinear patch" { 5e-3 } else { 3e-4 };
            assert!((area / expected - 1.0).abs() < most, "{name}: {area} and {expected}");
            // Parts add up.
            let cell = |i: u32| {
                let low = DVec2::new(f64::from(i % 8), f64::from(i / 8)) / 8.0;
                [low, low + 0.125]
            };
            let [mut all, mut real, mut by_shares] = [0.0; 3];
            for cell in (0..64).map(cell) {
                all += mesh.mean_density(cell) / 64.0;
                real += mesh.real_density(cell) / 64.0;
                by_shares += mesh.real_share(cell) * mesh.mean_density(cell) / 64.0;
            }
            assert!((all - 1.0).abs() < 1e-12, "{name}: {all}");
            assert!((real * mesh.area() / area - 1.0).abs() < 1e-12, "{name}: {real}");
            assert!((by_shares - real).abs() < 1e-9, "{name}: {by_shares} and {real}");
            for _ in 0..100 {
                let st = numbers.point(DVec2::splat(0.01), DVec2::splat(0.99));
                if !mesh.is_real(st) {
                    continue;
                }
                let h = 1e-6;
                let along = |axis: DVec2| (mesh.point(st + h * axis) - mesh.point(st - h * axis)) / (2.0 * h);
                let element = along(DVec2::X).cross(along(DVec2::Y)).length();
                let error = (mesh.area() * mesh.density(st) - element).abs() / mesh.area();
                assert!(error < 1e-4, "{name} at {st}: {error}");
            }
        }
    }
    assert!(uneven > 30, "{uneven}");
}

#[test]
fn trimmed_faces_have_their_area() {
    for (name, surface, patch) in surfaces() {
        let loops = vec![trimmed(patch)];
        let mesh = mesh(&surface, loops.clone());
        let map = TrapezoidalMap::new(&loops).unwrap();
        // By the area element in a grid, whose cells on the boundary have their share.
        let cells = 402;
        let side = (patch[1] - patch[0]) / f64::from(cells);
        let mut exact = 0.0;
        for i in 0..cells * cells {
            let low = patch[0] + side * DVec2::new(f64::from(i % cells), f64::from(i / cells));
            if map.coverage([low, low + side]) != Coverage::Empty {
                let [_, along_u, along_v] = surface.derivatives(low + 0.5 * side);
                exact += map.area_within([low, low + side]) * along_u.cross(along_v).length();
            }
        }
        let area = mesh.real_area();
        assert!((area / exact - 1.0).abs() < 1e-4, "{name}: {area} and {exact}");
        assert!(area <= mesh.area() * (1.0 + 1e-9), "{name}");
        // A plane has it exactly.
        if let Surface::Plane(_) = surface {
            assert!((area / map.area() - 1.0).abs() < 3e-5, "{area} and {}", map.area());
        }
    }
}

#[test]
fn points_come_back_both_ways() {
    let mut numbers = SplitMix(43);
    for (name, surface, patch) in surfaces() {
        for loops in [rectangle(patch[0], patch[1]), trimmed(patch)] {
            let mesh = mesh(&surface, vec![loops.clone()]);
            let map = TrapezoidalMap::new(&[loops]).unwrap();
            for _ in 0..300 {
                let uv = numbers.point(patch[0], patch[1]);
                if map.contains(uv) {
                    let back = mesh.parameters(mesh.square(uv));
                    let error = ((back - uv) / (patch[1] - patch[0])).abs().max_element();
                    assert!(error < 1e-6, "{name} at {uv}: {back}");
                    let point = mesh.point(mesh.square(uv));
                    assert!(point.distance(surface.point(uv)) < 1e-6, "{name} at {uv}");
                }
                let st = numbers.point(DVec2::ZERO, DVec2::ONE);
                if mesh.is_real(st) {
                    let back = mesh.square(mesh.parameters(st));
                    assert!(back.distance(st) < 1e-6, "{name} at {st}: {back}");
                }
            }
        }
    }
}

#[test]
fn coverage_is_never_wrong_and_shares_add_up() {
    let mut numbers = SplitMix(44);
    for (name, surface, patch) in surfaces() {
        let hole_low = patch[0].lerp(patch[1], 0.45);
        let hole = rectangle(hole_low, patch[0].lerp(patch[1], 0.55));
        let mesh = mesh(&surface, vec![trimmed(patch), hole]);
        let side = 1.0 / 16.0;
        let mut sum = 0.0;
        let mut counts = [0; 3];
        for i in 0..256 {
            let low = side * DVec2::new(f64::from(i % 16), f64::from(i / 16));
            let cell = [low, low + side];
            let share = mesh.real_share(cell);
            sum += share / 256.0;
            let coverage = mesh.coverage(cell);
            counts[coverage as usize] += 1;
            for _ in 0..10 {
                let at = numbers.point(cell[0], cell[1]);
                match coverage {
                    Coverage::Plain => assert!(mesh.is_real(at), "{name}: {at}"),
                    Coverage::Empty => assert!(!mesh.is_real(at), "{name}: {at}"),
                    Coverage::Boundary => {}
                }
            }
            match coverage {
                Coverage::Plain => assert!(share > 1.0 - 1e-9, "{name}: {share}"),
                Coverage::Empty => assert!(share < 1e-9, "{name}: {share}"),
                Coverage::Boundary => {}
            }
        }
        assert!((sum - mesh.real_share([DVec2::ZERO, DVec2::ONE])).abs() < 1e-9, "{name}: {sum}");
        assert!(counts.iter().all(|&count| count > 0), "{name}: {counts:?}");
    }
}

#[test]
fn nearest_real_points_of_planes_are_the_nearest() {
    let patch = [DVec2::new(-1.0, 0.5), DVec2::new(1.0, 2.0)];
    let whole = mesh(&Surface::Plane(Frame::default()), vec![rectangle(patch[0], patch[1])]);
    assert_eq!(whole.nearest_real(DVec2::new(0.3, 0.7)), DVec2::new(0.3, 0.7));
    assert!(whole.nearest_real(DVec2::new(0.3, 1.0)).distance(DVec2::new(0.3, 1.0 - 1e-4)) < 1e-9);
    assert!(whole.well_inside(DVec2::new(0.3, 1e-4), 0.01).distance(DVec2::new(0.3, 0.01)) < 1e-9);
    let mesh = mesh(&Surface::Plane(Frame::default()), vec![trimmed(patch)]);
    let mut numbers = SplitMix(45);
    let many: Vec<DVec2> =
        (0..40_000).map(|_| numbers.point(DVec2::ZERO, DVec2::ONE)).filter(|&at| mesh.is_real(at)).collect();
    let many: Vec<DVec3> = many.into_iter().map(|at| mesh.point(at)).collect();
    for _ in 0..200 {
        let st = numbers.point(DVec2::ZERO, DVec2::ONE);
        let found = mesh.nearest_real(st);
        assert!(mesh.is_real(found));
        let point = mesh.point(st);
        let distance = mesh.point(found).distance(point);
        let least = many.iter().map(|other| other.distance(point)).fold(f64::INFINITY, f64::min);
        assert!(distance < least + 1e-3, "{distance} {least}");
        assert!(!mesh.is_real(st) || found == st);
        let inside = mesh.well_inside(st, 0.01);
        assert!(mesh.is_real(inside) && inside.distance(found) < 0.02);
    }
}

#[test]
fn normals_are_those_of_the_face() {
    let face = |is_reversed| Face {
        surface: Surface::Sphere { frame: Frame::default(), radius: 2.0 },
        is_reversed,
        loops: vec![rectangle(DVec2::new(0.0, -FRAC_PI_2), DVec2::new(TAU, FRAC_PI_2))],
    };
    for is_reversed in [false, true] {
        let mesh = VirtualMesh::new(&face(is_reversed)).unwrap();
        let [point, normal] = mesh.point_and_normal(DVec2::new(0.3, 0.6));
        let sign = if is_reversed { -0.5 } else { 0.5 };
        assert!(normal.distance(sign * point) < 1e-12 && normal == mesh.normal(DVec2::new(0.3, 0.6)));
    }
}

#[test]
fn faces_without_area_have_none() {
    let plane = Surface::Plane(Frame::default());
    let segment = |from, to| TrimEdge::Segment { from, to };
    let line = vec![segment(DVec2::ZERO, DVec2::ONE), segment(DVec2::ONE, DVec2::ZERO)];
    let face = |loops| Face { surface: plane.clone(), is_reversed: false, loops };
    assert!(VirtualMesh::new(&face(vec![line])).is_err());
    assert!(VirtualMesh::new(&face(vec![])).is_err());
}
