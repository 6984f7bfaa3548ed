//! Rays against tori.

use super::*;
use rebounce_shared::elementary::Elementary;

/// On the side of the hole a torus bends outward along its circles: a ray beside one is met twice outside, not within.
#[test]
fn grazing_rays_in_the_hole_of_a_torus() {
    let mut random = SplitMix(15);
    let frame = random.frame();
    for (major, minor) in [(1.0, 0.4), (1.0, 0.01), (0.7, 0.6)] {
        let surface = Surface::Torus { frame, major, minor };
        let patch = [DVec2::ZERO, DVec2::splat(TAU)];
        for _ in 0..20_000 {
            let at = DVec2::new(random.between(0.0, TAU), random.between(2.0, TAU - 2.0));
            let [place, along_u, _] = surface.derivatives(at);
            let [direction, normal] = [along_u.normalize(), surface.normal(at)];
            let reach = 0.05 * minor;
            let mut found = SurfaceHits::default();
            for (offset, expected) in [(1e-7 * minor, 2), (-1e-7 * minor, 0)] {
                let origin = place + offset * normal - reach * direction;
                surface.meet(&Ray { origin, direction }, &patch, [0.0, 2.0 * reach], &mut found);
                assert_eq!(found.len(), expected, "{major} {minor} {at} {offset}");
            }
        }
    }
}

/// Rays in a torus's planes of symmetry and along its circles, whose meetings are known.
#[test]
fn rays_that_are_hard_for_a_torus() {
    let count = |major: f64, minor: f64, origin: DVec3, direction: DVec3| {
        let surface = Surface::Torus { frame: Frame::default(), major, minor };
        let patch = [DVec2::ZERO, DVec2::splat(TAU)];
        let mut found = SurfaceHits::default();
        surface.meet(&Ray { origin, direction }, &patch, [f64::NEG_INFINITY, f64::INFINITY], &mut found);
        for meeting in found.iter() {
            let place = origin + meeting.distance * direction;
            let off = (surface.point(meeting.at) - place).length();
            assert!(
                off < 1e-11 * (major + minor),
                "{major} {minor} {origin} {direction} {meeting:?} {off:e}"
            );
        }
        found.len()
    };
    for (major, minor) in [(1.0, 0.25), (1.0, 1e-2), (1.0, 1e-4), (3e3, 1.0), (1e-6, 3e-7)] {
        for offset in [1e-7, 1e-5, 1e-3] {
            let inside = 1.0 - offset;
            let outside = 1.0 + offset;
            let hole = major - minor;
            // In the equatorial plane, past the outer rim and past the rim of the hole.
            for (height, expected) in [
                (outside * (major + minor), 0),
                ((major + minor) - offset * minor, 2),
                (hole + offset * minor, 2),
                (hole - offset * minor, 4),
                (0.0, 4),
            ] {
                let origin = DVec3::new(-1e4 * major, height, 0.0);
                // What is left of the offset when the origin is far.
                assert_eq!(
                    count(major, minor, origin, DVec3::X),
                    expected,
                    "{major} {minor} {offset} {height}"
                );
                let origin = DVec3::new(0.0, height, 0.0);
                assert_eq!(
                    count(major, minor, origin, DVec3::X),
                    expected,
                    "{major} {minor} {offset} {height}"
                );
            }
            // Parallel to the axis: through the hole's rim, the tube, past the outer rim; along the axis.
            for (from_axis, expected) in [
                (0.0, 0),
                (hole - offset * minor, 0),
                (hole + offset * minor, 2),
                (major, 2),
                (major + minor - offset * minor, 2),
                (major + minor + offset * minor, 0),
            ] {
                let origin = DVec3::new(0.6 * from_axis, 0.8 * from_axis, -1e3 * major);
                assert_eq!(count(major, minor, origin, DVec3::Z), expected, "{major} {minor} {from_axis}");
            }
            // Along the top circle: contact of order four. Through the whole torus along a diameter of it: the tube twice.
            let origin = DVec3::new(major, 0.0, inside * minor);
            assert_eq!(count(major, minor, origin, DVec3::Y), 2, "{major} {minor} {offset}");
            let origin = DVec3::new(major, 0.0, outside * minor);
            assert_eq!(count(major, minor, origin, DVec3::Y), 0, "{major} {minor} {offset}");
            let origin = DVec3::new(0.0, 0.0, inside * minor);
            assert_eq!(count(major, minor, origin, DVec3::X), 4, "{major} {minor} {offset}");
            // Villarceau's plane touches twice; a line in it through the centre, moved up or down, meets four times.
            let (sine, cosine) = (minor / major, (1.0 - (minor / major).powi(2)).sqrt());
            let bitangent = DVec3::new(cosine, 0.0, sine);
            let up = DVec3::new(-sine, 0.0, cosine) * (offset * minor);
            // Towards one point of touch it is outside, towards the other inside.
            assert_eq!(count(major, minor, up, bitangent), 2, "{major} {minor} {offset}");
            assert_eq!(count(major, minor, -up, bitangent), 2, "{major} {minor} {offset}");
            // Turned about the centre.
            let turned = |angle: f64| bitangent + angle * DVec3::new(-sine, 0.0, cosine);
            let [steeper, flatter] = [turned(offset * sine), turned(-offset * sine)];
            assert_eq!(count(major, minor, DVec3::ZERO, steeper), 0, "{major} {minor} {offset}");
            assert_eq!(count(major, minor, DVec3::ZERO, flatter), 4, "{major} {minor} {offset}");
        }
    }
    // An apple along its axis, and across its dimple above and below the pole.
    let pole = (0.9f64 * 0.9 - 0.5 * 0.5).sqrt();
    assert_eq!(count(0.5, 0.9, DVec3::new(0.0, 0.0, -7.0), DVec3::Z), 2);
    assert_eq!(count(0.5, 0.9, DVec3::new(-7.0, 0.0, pole + 1e-6), DVec3::X), 4);
    assert_eq!(count(0.5, 0.9, DVec3::new(-7.0, 0.0, pole - 1e-6), DVec3::X), 2);
}

/// Rays a distance of 1e-7 and of 1e-13 of the size within and outside of a tangent, for tori from R / r = 1e5 to 1/3.
#[test]
fn no_pair_is_lost_at_any_thickness() {
    let mut random = SplitMix(16);
    let patch = [DVec2::ZERO, DVec2::splat(TAU)];
    let mut found = SurfaceHits::default();
    for offset in [1e-7, 1e-13] {
        for _ in 0..20_000 {
            let minor = 10f64.power(random.between(-5.0, 0.5));
            let surface = Surface::Torus { frame: Frame::default(), major: 1.0, minor };
            // The greater one as a part of r: through a thin torus a ray comes out on the other side.
            let offset = offset * if offset > 1e-10 { minor } else { 1.0 + minor };
            // Where it bends inward in all directions.
            let at = DVec2::new(random.between(0.0, TAU), random.between(-1.4, 1.4));
            let [place, along_u, along_v] = surface.derivatives(at);
            let turn = random.between(0.0, TAU);
            let direction = turn.cosine() * along_u.normalize() + turn.sine() * along_v.normalize();
            for (offset, expected) in [(-offset, 2), (offset, 0)] {
                let origin = place + offset * surface.normal(at);
                surface.meet(&Ray { origin, direction }, &patch, [-1e9, 1e9], &mut found);
                assert_eq!(found.len(), expected, "{minor} {at} {turn} {offset}");
            }
        }
    }
}
