//! Rays against surfaces.

use super::*;
use crate::surface::angle::angle_within;
use crate::surface::local_ray::LocalRay;
use rebounce_shared::elementary::Elementary;

/// A function of places that changes sign at the surface, about a length.
fn implicit(surface: &Surface, place: DVec3) -> f64 {
    // Not `hypot`, which is slower.
    let from_axis = place.truncate().length();
    match surface {
        Surface::Cylinder { radius, .. } => from_axis - radius,
        Surface::Cone { radius, half_angle, .. } => {
            from_axis - (radius + place.z * half_angle.tangent()).abs()
        }
        Surface::Sphere { radius, .. } => place.length() - radius,
        Surface::Torus { major, minor, .. } => DVec2::new(from_axis - major, place.z).length() - minor,
        _ => place.z,
    }
}

/// Every meeting is on ray and surface, and in steps of the ray as many as the implicit function changes sign an odd number of times,
/// and in the others an even number. Steps with an end within 1e-11 of the size of the surface are not looked at.
#[test]
fn meetings_are_where_the_sign_changes() {
    const STEPS: usize = 2000;
    const RAYS: usize = 20_000;
    let mut random = SplitMix(7);
    for Case { name, surface, size, patch } in cases() {
        let frame = frame_of(&surface);
        let has_ends = matches!(surface, Surface::Plane(_) | Surface::Cylinder { .. } | Surface::Cone { .. });
        let mut found = SurfaceHits::default();
        let mut met = 0;
        for i in 0..RAYS {
            let far = if i % 10 == 0 { 1e4 * size } else { 2.0 * size };
            let through = random.between(0.0, 1.3 * size) * random.direction();
            let direction = match i % 7 {
                0 => DVec3::Z,
                1 => DVec3::new(random.unit() - 0.5, random.unit() - 0.5, 0.0).normalize(),
                2 => (DVec3::Z + 1e-5 * random.direction()).normalize(),
                _ => random.direction(),
            };
            let through = if i % 21 == 1 { through.with_z(0.0) } else { through };
            let length = 10f64.power(random.between(-3.0, 3.0));
            let ray = Ray {
                origin: frame.place(through - far * direction),
                direction: frame.turn(direction * length),
            };
            let [from, to] = [(far - 2.0 * size) / length, (far + 2.0 * size) / length];
            assert!(surface.meet(&ray, &patch, [from, to], &mut found));
            met += found.len();
            let mut before = from;
            for meeting in found.iter() {
                let place = ray.origin + meeting.distance * ray.direction;
                let off = (surface.point(meeting.at) - place).length();
                // Rounding of a far origin.
                let tolerance = size * if far > 1e3 * size { 1e-11 } else { 1e-13 };
                assert!(off < tolerance, "{name} {off:e} {ray:?} {meeting:?}");
                assert!(before <= meeting.distance && meeting.distance <= to, "{name}");
                before = meeting.distance;
            }
            // The ray as the computation has it, not as it was meant: its own digits count.
            let local = LocalRay::new(&ray, &frame, DVec3::ZERO).unwrap();
            let base = local.distance(0.0);
            let value = |step: usize| {
                let distance = from + (to - from) * step as f64 / STEPS as f64;
                let place = local.at((distance - base) * length);
                // Beyond the ends of the patch nothing is known.
                let is_beyond = has_ends && !(patch[0].y < place.z && place.z < patch[1].y);
                let is_beyond = is_beyond && !matches!(surface, Surface::Plane(_));
                (distance, implicit(&surface, place), is_beyond)
            };
            let mut last = value(0);
            let mut rest = found.iter().peekable();
            for step in 1..=STEPS {
                let next = value(step);
                let mut count = 0;
                while rest.next_if(|meeting| meeting.distance < next.0).is_some() {
                    count += 1;
                }
                let is_near = last.1.abs().min(next.1.abs()) < 1e-11 * size;
                let has_changed = (last.1 < 0.0) != (next.1 < 0.0);
                // The plane's patch has ends along both parameters: what lies outside is left out below.
                let is_outside = matches!(surface, Surface::Plane(_)) && has_changed && {
                    let place = local.at((0.5 * (last.0 + next.0) - base) * length);
                    place.truncate().abs().max_element() > patch[1].x - 1e-2 * size
                };
                if !(is_near || is_outside || last.2 || next.2) {
                    assert_eq!(count % 2 == 1, has_changed, "{name} {ray:?} {:?} {last:?} {next:?}", &*found);
                }
                last = next;
            }
        }
        assert!(met > RAYS / 10, "{name} {met}");
    }
}

/// A ray at a point's tangent, moved along the normal: within the surface twice met, outside not.
#[test]
fn grazing_rays_meet_twice_or_not_at_all() {
    let mut random = SplitMix(8);
    for Case { name, surface, size, patch } in cases() {
        // The centre of curvature lies within, or the surface is not curved so.
        let range_of_v = match surface {
            Surface::Plane(_) => continue,
            Surface::Torus { .. } => [-1.4, 1.4],
            // Half of it, away from apex and ends.
            _ => [0.5 * patch[1].y, 0.9 * patch[1].y],
        };
        for _ in 0..20_000 {
            let at = DVec2::new(random.between(0.0, TAU), random.between(range_of_v[0], range_of_v[1]));
            let [place, along_u, along_v] = surface.derivatives(at);
            let turn = match surface {
                Surface::Cylinder { .. } | Surface::Cone { .. } => random.between(-1.0, 1.0),
                _ => random.between(0.0, TAU),
            };
            let direction = turn.cosine() * along_u.normalize() + turn.sine() * along_v.normalize();
            let inside = match surface {
                Surface::Torus { minor, .. } => 1e-7 * minor,
                _ => 1e-7 * size,
            };
            let mut found = SurfaceHits::default();
            // Where a cone's tangent meets the other nappe is of no account: as far as the roots can be apart.
            let reach = match surface {
                Surface::Cone { .. } => 0.01 * size,
                _ => 10.0 * size,
            };
            let ray = |offset: f64| Ray {
                origin: place + offset * surface.normal(at) - reach * direction,
                direction,
            };
            let whole = [DVec2::new(0.0, f64::NEG_INFINITY), DVec2::new(TAU, f64::INFINITY)];
            let patch = match surface {
                Surface::Torus { .. } => patch,
                _ => whole,
            };
            surface.meet(&ray(-inside), &patch, [0.0, 2.0 * reach], &mut found);
            assert_eq!(found.len(), 2, "{name} inside {at} {turn}");
            surface.meet(&ray(inside), &patch, [0.0, 2.0 * reach], &mut found);
            assert_eq!(found.len(), 0, "{name} outside {at} {turn}");
        }
    }
}

#[test]
fn cones_are_met_on_the_nappe_of_the_patch() {
    let frame = SplitMix(9).frame();
    let surface = Surface::Cone { frame, radius: 0.0, half_angle: 0.5 };
    let ray = Ray { origin: frame.place(DVec3::new(0.1, 0.0, -9.0)), direction: frame.z };
    let mut found = SurfaceHits::default();
    let met = |from: f64, to: f64, found: &mut SurfaceHits| {
        let patch = [DVec2::new(-PI, from), DVec2::new(PI, to)];
        surface.meet(&ray, &patch, [0.0, f64::INFINITY], found);
        found.len()
    };
    assert_eq!(met(-3.0, 3.0, &mut found), 2);
    assert!((found[0].at.x.abs() - PI).abs() < 1e-12 && found[0].at.y < 0.0);
    assert!(found[1].at.x.abs() < 1e-12 && found[1].at.y > 0.0);
    assert_eq!(met(0.0, 3.0, &mut found), 1);
    assert_eq!(met(-3.0, 0.0, &mut found), 1);
    // Through the apex, at all angles: on either nappe, or at the apex itself.
    let mut random = SplitMix(10);
    for _ in 0..10_000 {
        let direction = random.direction();
        let ray = Ray { origin: frame.origin - 3.0 * direction, direction };
        let whole = [DVec2::new(0.0, -9.0), DVec2::new(TAU, 9.0)];
        surface.meet(&ray, &whole, [0.0, f64::INFINITY], &mut found);
        assert!(found.len() % 2 == 0);
        for meeting in found.iter() {
            let place = ray.origin + meeting.distance * direction;
            assert!((surface.point(meeting.at) - place).length() < 1e-13);
            // Rounding of the ray against the apex, divided by the angle between ray and generator.
            let across = frame.local_direction(direction);
            let between = (across.truncate().length() - 0.5f64.tangent() * across.z.abs()).abs();
            assert!((meeting.distance - 3.0).abs() * between < 1e-14, "{meeting:?} {between}");
        }
    }
}

#[test]
fn a_patch_holds_what_of_the_whole_lies_in_it() {
    let mut random = SplitMix(11);
    for Case { name, surface, size, patch } in cases() {
        let frame = frame_of(&surface);
        let [mut all, mut some] = [SurfaceHits::default(), SurfaceHits::default()];
        for _ in 0..20_000 {
            let ray = Ray {
                origin: frame.place(random.between(0.0, 2.0 * size) * random.direction()),
                direction: random.direction(),
            };
            let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
            surface.meet(&ray, &patch, everywhere, &mut all);
            // A part of it, by whole turns anywhere.
            let [a, b] = [random.point(patch[0], patch[1]), random.point(patch[0], patch[1])];
            let mut part = [a.min(b), a.max(b)];
            let [turn_u, turn_v] = surface.periods().map(|period| period.unwrap_or(0.0));
            let shift = DVec2::new(turn_u, turn_v) * random.between(-3.0, 3.0).floor();
            part = part.map(|end| end + shift);
            let distances = [random.between(-size, 0.0), random.between(0.0, size)];
            surface.meet(&ray, &part, distances, &mut some);
            let expected = all.iter().filter(|meeting| {
                let at = meeting.at + shift;
                distances[0] <= meeting.distance
                    && meeting.distance <= distances[1]
                    && at.cmpge(part[0]).all()
                    && at.cmple(part[1]).all()
            });
            assert_eq!(expected.clone().count(), some.len(), "{name} {ray:?} {part:?}");
            for (expected, meeting) in expected.zip(some.iter()) {
                assert!(
                    (expected.at + shift - meeting.at).length() < 1e-13 * (1.0 + shift.length()),
                    "{name}"
                );
                // A narrow cone's middle is elsewhere.
                assert!((expected.distance - meeting.distance).abs() < 1e-9, "{name}");
            }
        }
    }
}

#[test]
fn patches_side_by_side_have_no_gap() {
    // Angles at random, also those of the border, brought into patches that border on each other turns away.
    let mut random = SplitMix(12);
    for _ in 0..100_000 {
        let border = random.between(-20.0, 20.0);
        let other = border + random.between(0.1, TAU - 0.1);
        let turns = TAU * random.between(-4.0, 4.0).floor();
        for angle in [border + turns, other + turns, random.between(0.0, TAU)] {
            let here = angle_within(angle, [border, other]);
            let there = angle_within(angle, [other, border + TAU]);
            assert!(here.is_some() || there.is_some(), "{border} {other} {angle}");
            assert!(angle_within(angle, [border, border + TAU]).is_some());
        }
    }
    assert_eq!(angle_within(0.1, [5.0, 7.0]), Some(0.1 + TAU));
    assert_eq!(angle_within(2.0, [5.0, 7.0]), None);
    assert_eq!(angle_within(6.0, [-1.0, 1.0]), Some(6.0 - TAU));
}

#[test]
fn odd_input_meets_nothing() {
    let whole = [DVec2::NEG_INFINITY, DVec2::INFINITY];
    let mut found = SurfaceHits::default();
    for Case { name, surface, size, .. } in cases() {
        for direction in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY, DVec3::X] {
            for origin in [DVec3::NAN, DVec3::INFINITY, DVec3::ZERO] {
                if origin.is_finite() && direction == DVec3::X {
                    continue;
                }
                let ray = Ray { origin, direction };
                assert!(surface.meet(&ray, &whole, [f64::NEG_INFINITY, f64::INFINITY], &mut found));
                assert!(found.is_empty(), "{name} {ray:?}");
            }
        }
        // Directions of any length give the same places.
        let middle = frame_of(&surface).place(DVec3::new(0.2, 0.1, 0.0) * size);
        let direction = DVec3::new(0.3, -0.5, 0.9);
        let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
        surface.meet(&Ray { origin: middle, direction }, &whole, everywhere, &mut found);
        let places = found;
        for length in [1e-200, 1e200] {
            let ray = Ray { origin: middle, direction: direction * length };
            surface.meet(&ray, &whole, everywhere, &mut found);
            assert_eq!(found.len(), places.len(), "{name}");
            for (one, other) in found.iter().zip(places.iter()) {
                assert!((one.at - other.at).length() < 1e-12, "{name}");
            }
        }
    }
}
