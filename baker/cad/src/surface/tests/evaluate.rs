//! Evaluation, inversion, boxes and areas.

use super::*;
use rebounce_shared::elementary::Elementary;

#[test]
fn derivatives_are_those_of_differences() {
    let mut random = SplitMix(2);
    for Case { name, surface, patch, .. } in cases() {
        for _ in 0..1000 {
            let at = random.point(patch[0], patch[1]);
            let [_, along_u, along_v] = surface.derivatives(at);
            let h = 1e-5;
            for (axis, slope) in [(DVec2::X, along_u), (DVec2::Y, along_v)] {
                let difference = (surface.point(at + h * axis) - surface.point(at - h * axis)) / (2.0 * h);
                assert!((difference - slope).length() < 1e-8, "{name} {at} {difference} {slope}");
            }
            let cross = along_u.cross(along_v);
            let normal = surface.normal(at);
            assert!((normal.length() - 1.0).abs() < 1e-14, "{name}");
            assert!((normal.dot(cross) - cross.length()).abs() < 1e-12, "{name} {at}");
        }
    }
}

#[test]
fn normals_have_limits_at_poles_and_apexes() {
    let frame = SplitMix(3).frame();
    let sphere = Surface::Sphere { frame, radius: 2.0 };
    assert!((sphere.normal(DVec2::new(1.0, FRAC_PI_2)) - frame.z).length() < 1e-15);
    assert!((sphere.normal(DVec2::new(1.0, -FRAC_PI_2)) + frame.z).length() < 1e-15);
    let cone = Surface::Cone { frame, radius: 0.0, half_angle: 0.7 };
    let limit = cone.normal(DVec2::new(1.0, 1e-9));
    assert!((cone.normal(DVec2::new(1.0, 0.0)) - limit).length() < 1e-15);
    let apple = Surface::Torus { frame, major: 0.5, minor: 0.9 };
    let [_, pole] = outer([0.5, 0.9]);
    let limit = apple.normal(DVec2::new(1.0, pole - 1e-9));
    assert!((apple.normal(DVec2::new(1.0, pole)) - limit).length() < 1e-8);
}

#[test]
fn a_normal_where_derivatives_vanish() {
    // A line turned about an axis that it meets: a cone's apex.
    let profile = Curve::Line { origin: DVec3::ZERO, direction: DVec3::new(1.0, 0.0, 1.0) };
    let surface = Surface::Revolution { frame: Frame::default(), profile };
    let normal = surface.normal(DVec2::ZERO);
    assert!((normal.length() - 1.0).abs() < 1e-12);
    assert!(normal.dot(surface.normal(DVec2::new(1e-6, 1e-3))) > 0.999_999);
}

#[test]
fn inversion_gives_back_parameters() {
    let mut random = SplitMix(4);
    for Case { name, surface, size, patch } in cases() {
        for i in 0..10_000 {
            let mut at = random.point(patch[0], patch[1]);
            // Some near the ends of the patch: poles, apexes.
            if i % 4 == 0 {
                let near = 10f64.power(random.between(-6.0, -1.0));
                at.y = if i % 8 == 0 { patch[0].y + near } else { patch[1].y - near };
            }
            let place = surface.point(at);
            let plain = surface.invert(place, None);
            let near = at + DVec2::new(random.between(-3.0, 3.0), 0.0);
            let chosen = surface.invert(place, Some(near));
            assert!((surface.point(plain) - place).length() < 1e-14 * (size + 3.0), "{name} {at} {plain}");
            // Near an axis a length of rounding is a greater angle.
            let [_, along_u, along_v] = surface.derivatives(at);
            let tolerance = DVec2::new(along_u.length(), along_v.length()).recip() * 1e-14 * (size + 3.0);
            let off = (chosen - at).abs();
            assert!(off.x <= tolerance.x && off.y <= tolerance.y, "{name} {at} {chosen}");
            if surface.periods()[0].is_some() {
                assert!((0.0..=TAU).contains(&plain.x), "{name}");
                let far = surface.invert(place, Some(at + 40.0 * PI));
                assert!((far.x - at.x - 40.0 * PI).abs() <= tolerance.x + 1e-13, "{name}");
            }
        }
    }
}

#[test]
fn inversion_finds_the_nearest_point() {
    let mut random = SplitMix(5);
    for Case { name, surface, size, patch } in cases() {
        for _ in 0..200 {
            let place = frame_of(&surface).place(random.between(0.0, 1.2 * size) * random.direction());
            let nearest = (surface.point(surface.invert(place, None)) - place).length();
            for _ in 0..500 {
                let sample = (surface.point(random.point(patch[0], patch[1])) - place).length();
                assert!(nearest <= sample + 1e-12, "{name} {nearest} {sample}");
            }
        }
    }
}

#[test]
fn undetermined_angles_are_those_nearby() {
    let frame = SplitMix(6).frame();
    let near = DVec2::new(13.0, 0.3);
    let surfaces = [
        Surface::Cylinder { frame, radius: 1.0 },
        Surface::Cone { frame, radius: 1.0, half_angle: 0.4 },
        Surface::Sphere { frame, radius: 1.0 },
        Surface::Torus { frame, major: 1.0, minor: 2.0 },
    ];
    for surface in surfaces {
        for z in [1.0, -5.0] {
            assert_eq!(surface.invert(frame.origin + z * frame.z, Some(near)).x, 13.0, "{surface:?}");
        }
    }
    let sphere = Surface::Sphere { frame, radius: 1.0 };
    assert_eq!(sphere.invert(frame.origin, Some(near)), near);
    let torus = Surface::Torus { frame, major: 2.0, minor: 1.0 };
    let at = torus.invert(frame.origin + 2.0 * frame.x, Some(DVec2::new(0.1, 9.0)));
    assert!(at.x.abs() < 1e-15 && at.y == 9.0);
}

#[test]
fn bounds_hold_the_patch_and_are_tight() {
    let mut random = SplitMix(13);
    for Case { name, surface, size, patch } in cases() {
        for i in 0..200 {
            let [a, b] = [random.point(patch[0], patch[1]), random.point(patch[0], patch[1])];
            let shift = DVec2::X * if i % 3 == 0 { random.between(-9.0, 9.0) } else { 0.0 };
            let part = [a.min(b) + shift, a.max(b) + shift];
            let [low, high] = surface.bounds(part);
            let [mut least, mut greatest] = [DVec3::INFINITY, DVec3::NEG_INFINITY];
            let mut look = |at: DVec2| {
                let place = surface.point(at);
                assert!(place.cmpge(low).all() && place.cmple(high).all(), "{name} {part:?} {at}");
                least = least.min(place);
                greatest = greatest.max(place);
            };
            for u in 0..=100 {
                for v in 0..=100 {
                    let fraction = DVec2::new(f64::from(u), f64::from(v)) / 100.0;
                    look(part[0] + (part[1] - part[0]) * fraction);
                }
            }
            // A grid's step misses an extremum by its square.
            let slack = 2.0 * size * ((part[1] - part[0]) / 100.0).length_squared() + 1e-12;
            assert!((least - low).max_element() < slack, "{name} {part:?}");
            assert!((high - greatest).max_element() < slack, "{name} {part:?}");
        }
    }
}

#[test]
fn areas_are_those_of_quadrature() {
    let mut random = SplitMix(14);
    for Case { name, surface, patch, .. } in cases() {
        for _ in 0..100 {
            let [a, b] = [random.point(patch[0], patch[1]), random.point(patch[0], patch[1])];
            let mut parts = vec![[a.min(b), a.max(b)]];
            // |σᵤ × σᵥ| has a kink at an apex.
            if let Surface::Cone { radius, half_angle, .. } = surface {
                let apex = (-radius / half_angle.tangent()).clamp(parts[0][0].y, parts[0][1].y);
                let [low, high] = parts[0];
                parts = vec![[low, DVec2::new(high.x, apex)], [DVec2::new(low.x, apex), high]];
            }
            let expected: f64 = parts.iter().map(|&part| area::integral(&surface, part)).sum();
            let area = surface.area([a.min(b), a.max(b)]);
            assert!((area - expected).abs() <= 1e-6 * expected, "{name} {area} {expected}");
        }
    }
    // Known areas.
    let frame = Frame::default();
    let turn = [DVec2::ZERO, DVec2::splat(TAU)];
    let torus = Surface::Torus { frame, major: 2.0, minor: 0.5 };
    assert!((torus.area(turn) - TAU * TAU).abs() < 1e-12);
    // An apple's inner part does not count, wherever the turn of v begins.
    let apple = Surface::Torus { frame, major: 0.5, minor: 0.9 };
    let pole = (-0.5f64 / 0.9).arc_cosine();
    let expected = TAU * 0.9 * (2.0 * 0.5 * pole + 2.0 * 0.9 * pole.sine());
    for from in [-PI, 0.0, 2.0, -50.0] {
        let patch = [DVec2::new(0.0, from), DVec2::new(TAU, from + TAU)];
        assert!((apple.area(patch) - expected).abs() < 1e-12, "{from}");
    }
}
