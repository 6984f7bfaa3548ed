//! Tests of rays against patches.

use super::*;
use crate::random::SplitMix;
use crate::spline::patches;
use crate::spline::samples::{sphere, torus, wavy};
use crate::surface::NurbsSurface;
use glam::DVec2;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::TAU;

const ALL: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

fn meet_all(patches: &[BezierPatch], ray: &Ray, distances: [f64; 2]) -> Vec<SurfaceHit> {
    let mut found = Vec::new();
    for patch in patches {
        patch.meet(ray, distances, &mut found);
    }
    found.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    found
}

/// The largest distance of meetings between the point of the ray and that of the surface.
fn gap(surface: &NurbsSurface, ray: &Ray, found: &[SurfaceHit]) -> f64 {
    found.iter().fold(0.0, |gap, meeting| {
        let place = ray.origin + meeting.distance * ray.direction;
        gap.max(place.distance(surface.derivatives(meeting.at)[0]))
    })
}

/// Where a ray meets a sphere about the origin.
fn closed_form(radius: f64, ray: &Ray) -> Vec<f64> {
    let middle = -ray.origin.dot(ray.direction) / ray.direction.length_squared();
    let offset = (ray.origin + middle * ray.direction).length();
    let under = (radius - offset) * (radius + offset);
    let half = under.max(0.0).sqrt() / ray.direction.length();
    if under < 0.0 { vec![] } else { vec![middle - half, middle + half] }
}

#[test]
fn random_rays_meet_a_sphere_where_the_closed_form_says() {
    let mut random = SplitMix(10);
    let surface = sphere(2.0);
    let patches = patches(&surface);
    for _ in 0..20_000 {
        let direction = random.between(0.1, 10.0) * random.direction();
        let ray = Ray { origin: random.place(2.5) - random.between(0.0, 5.0) * direction, direction };
        let expected = closed_form(2.0, &ray);
        let found = meet_all(&patches, &ray, ALL);
        assert_eq!(found.len(), expected.len(), "{ray:?}");
        for (meeting, distance) in found.iter().zip(&expected) {
            let half = 0.5 * (expected[1] - expected[0]) * ray.direction.length();
            assert!((meeting.distance - distance).abs() * ray.direction.length() < 1e-11 / half.min(1.0));
        }
        assert!(gap(&surface, &ray, &found) < 1e-11);
        // Only those within the distances asked for.
        if let [first, second] = expected[..] {
            let middle = 0.5 * (first + second);
            assert_eq!(meet_all(&patches, &ray, [middle, f64::INFINITY]).len(), 1);
            assert_eq!(meet_all(&patches, &ray, [first - 2.0, first - 1.0]).len(), 0);
        }
    }
}

#[test]
fn grazing_rays_meet_a_sphere_twice_or_not() {
    let mut random = SplitMix(11);
    let surface = sphere(2.0);
    let patches = patches(&surface);
    for index in 0..4000 {
        let normal = random.direction();
        let (tangent, other) = normal.any_orthonormal_pair();
        let (sin, cos) = random.between(0.0, TAU).sine_cosine();
        let direction = cos * tangent + sin * other;
        let offset = if index % 2 == 0 { 1e-7 } else { -1e-7 };
        let ray =
            Ray { origin: 2.0 * (1.0 + offset) * normal - random.between(0.0, 9.0) * direction, direction };
        let found = meet_all(&patches, &ray, ALL);
        assert_eq!(found.len(), if offset > 0.0 { 0 } else { 2 }, "{ray:?}");
        assert!(gap(&surface, &ray, &found) < 1e-11);
    }
}

#[test]
fn poles_seams_corners_and_tangents_are_met() {
    let surface = sphere(2.0);
    let patches = patches(&surface);
    let mut random = SplitMix(12);
    // Through the poles, from all sides.
    for sign in [-1.0, 1.0] {
        for _ in 0..500 {
            let direction = random.direction();
            let ray = Ray { origin: 2.0 * sign * DVec3::Z - 3.0 * direction, direction };
            let found = meet_all(&patches, &ray, ALL);
            assert_eq!(found.len(), 2, "{ray:?} {found:?}");
            assert!(found.iter().any(|meeting| (meeting.distance - 3.0).abs() < 1e-11));
            assert!(gap(&surface, &ray, &found) < 1e-11);
        }
    }
    // Through corners of patches, and through the seam.
    for _ in 0..500 {
        let direction = random.direction();
        let angle = random.between(-1.5, 1.5);
        for target in [DVec3::X, DVec3::Y, -DVec3::X, DVec3::new(angle.cosine(), 0.0, angle.sine())] {
            let ray = Ray { origin: 2.0 * target - 3.0 * direction, direction };
            let found = meet_all(&patches, &ray, ALL);
            assert_eq!(found.len(), 2, "{ray:?} {found:?}");
            assert!(found.iter().any(|meeting| (meeting.distance - 3.0).abs() < 1e-10));
        }
    }
    let axis = Ray { origin: -5.0 * DVec3::Z, direction: DVec3::Z };
    assert_eq!(
        meet_all(&patches, &axis, ALL).iter().map(|m| m.distance.round()).collect::<Vec<_>>(),
        [3.0, 7.0]
    );
    // Touching, at the pole and beside it.
    for origin in [DVec3::new(-3.0, 0.0, 2.0), DVec3::new(-3.0, 2.0, 0.0)] {
        let ray = Ray { origin, direction: DVec3::X };
        let found = meet_all(&patches, &ray, ALL);
        assert!(!found.is_empty() && found.len() <= 2, "{found:?}");
        assert!(gap(&surface, &ray, &found) < 1e-11);
    }
}

#[test]
fn rays_meet_a_torus_where_its_equation_says() {
    let mut random = SplitMix(13);
    let surface = torus(3.0, 1.0);
    let patches = patches(&surface);
    let outside = |place: DVec3| (place.truncate().length() - 3.0).hypotenuse(place.z) - 1.0;
    for _ in 0..3000 {
        let ray = Ray { origin: random.place(4.0), direction: random.direction() };
        let found = meet_all(&patches, &ray, ALL);
        assert!(gap(&surface, &ray, &found) < 1e-11);
        // Changes of sign along the ray.
        let mut changes = 0;
        let mut least = f64::INFINITY;
        let steps = 4000;
        let place = |step: usize| ray.origin + (24.0 * step as f64 / steps as f64 - 12.0) * ray.direction;
        for step in 0..steps {
            let [here, next] = [outside(place(step)), outside(place(step + 1))];
            changes += usize::from((here > 0.0) != (next > 0.0));
            let turn = step > 0 && (outside(place(step - 1)) - here) * (here - next) < 0.0;
            if turn {
                least = least.min(here.abs());
            }
        }
        // Extremes nearer to the surface than the curvature over a step are not told apart.
        if least > 1e-4 {
            assert_eq!(found.len(), changes, "{ray:?}");
        }
    }
}

#[test]
fn random_rays_meet_a_wavy_surface_where_triangles_are() {
    let mut random = SplitMix(14);
    let surface = wavy(7);
    let patches = patches(&surface);
    const SIDE: usize = 400;
    let [low, high] = surface.domain();
    let at = |i: usize, j: usize| low + (high - low) * DVec2::new(i as f64, j as f64) / SIDE as f64;
    let places: Vec<_> = (0..=SIDE)
        .flat_map(|i| (0..=SIDE).map(move |j| (i, j)))
        .map(|(i, j)| surface.derivatives(at(i, j))[0])
        .collect();
    let mut told = 0;
    for _ in 0..2000 {
        let direction = random.direction();
        let ray = Ray { origin: random.place(1.0) - 4.0 * direction, direction };
        let found = meet_all(&patches, &ray, ALL);
        assert!(gap(&surface, &ray, &found) < 1e-11);
        // In coordinates across the ray, triangles that hold 0.
        let (across, beside) = direction.any_orthonormal_pair();
        let flat = |i: usize, j: usize| {
            let from = places[i * (SIDE + 1) + j] - ray.origin;
            DVec2::new(from.dot(across), from.dot(beside))
        };
        let mut expected = Vec::new();
        for i in 0..SIDE {
            for j in 0..SIDE {
                let [a, b, c, d] = [flat(i, j), flat(i + 1, j), flat(i + 1, j + 1), flat(i, j + 1)];
                for [p, q, r] in [[a, b, c], [a, c, d]] {
                    let [x, y, z] = [p.perp_dot(q), q.perp_dot(r), r.perp_dot(p)];
                    if (x > 0.0 && y > 0.0 && z > 0.0) || (x < 0.0 && y < 0.0 && z < 0.0) {
                        expected.push(at(i, j));
                    }
                }
            }
        }
        // Silhouettes and the outer border, where a chord may hit what the surface does not, or the other way round.
        let is_unclear = |at: DVec2| {
            let [_, by_u, by_v] = surface.derivatives(at);
            let cosine = by_u.cross(by_v).normalize().dot(direction).abs();
            cosine < 0.05 || (at - low).min(high - at).min_element() < 0.02
        };
        let step = 2.0 * (high - low).max_element() / SIDE as f64;
        for &place in &expected {
            if !is_unclear(place) {
                told += 1;
                assert!(found.iter().any(|meeting| meeting.at.distance(place) < step), "{ray:?} {place}");
            }
        }
        for meeting in &found {
            if !is_unclear(meeting.at) {
                assert!(
                    expected.iter().any(|place| meeting.at.distance(*place) < step),
                    "{ray:?} {meeting:?}"
                );
            }
        }
    }
    assert!(told > 1000);
}

#[test]
fn rays_cross_a_closed_surface_an_even_number_of_times() {
    let mut random = SplitMix(19);
    let surface = torus(3.0, 1.0);
    let patches = patches(&surface);
    for index in 0..20_000 {
        let direction = random.direction();
        let origin = if index % 2 == 0 {
            random.place(4.0)
        } else {
            // All but touching, from a little inside to a little outside.
            let [u, v] = [random.between(0.0, 4.0), random.between(0.0, 4.0)];
            let [place, by_u, by_v] = surface.derivatives(DVec2::new(u, v));
            let normal = by_u.cross(by_v).normalize();
            let along = direction.reject_from(normal).normalize();
            let ray =
                Ray { origin: place + random.between(-1e-6, 1e-6) * normal - 20.0 * along, direction: along };
            let found = meet_all(&patches, &ray, ALL);
            assert!(found.len().is_multiple_of(2), "{ray:?} {found:?}");
            assert!(gap(&surface, &ray, &found) < 1e-11);
            continue;
        };
        let ray = Ray { origin: origin - 20.0 * direction, direction };
        assert!(meet_all(&patches, &ray, ALL).len().is_multiple_of(2), "{ray:?}");
    }
}

#[test]
fn a_ray_at_any_point_of_a_surface_meets_it_there() {
    let mut random = SplitMix(20);
    // Degree 3 in pieces, and one piece of degree 8.
    let steep = NurbsSurface::new(
        [8, 8],
        [0, 1].map(|_| [[0.0; 9], [1.0; 9]].concat()),
        [9, 9],
        (0..81)
            .map(|index| DVec3::new((index / 9) as f64, (index % 9) as f64, random.between(-3.0, 3.0)))
            .collect(),
        (0..81).map(|_| random.between(0.2, 5.0)).collect(),
    )
    .unwrap();
    for (surface, count) in [(wavy(7), 20_000), (steep, 2_000)] {
        let patches = patches(&surface);
        let [low, high] = surface.domain();
        for index in 0..count {
            let mut at = low + (high - low) * DVec2::new(random.between(0.0, 1.0), random.between(0.0, 1.0));
            // On corners and borders of the patches, and within them.
            for direction in 0..2 {
                if index % 3 == 0 || index % 3 == 1 + direction {
                    let knots = &surface.knots[direction];
                    at[direction] = knots[random.between(0.0, knots.len() as f64) as usize];
                }
            }
            let [place, by_u, by_v] = surface.derivatives(at);
            let mut direction = random.direction();
            let normal = by_u.cross(by_v).normalize();
            let is_tangent = index % 4 == 0;
            if is_tangent {
                direction = direction.reject_from(normal).normalize();
            }
            let distance = random.between(0.0, 30.0);
            let ray = Ray { origin: place - distance * direction, direction };
            let found = meet_all(&patches, &ray, ALL);
            assert!(gap(&surface, &ray, &found) < 1e-10, "{ray:?} {}", gap(&surface, &ray, &found));
            // A touch is as wide as the root of what rounding errors and the tolerance leave of it.
            let error = if is_tangent { 1e-5 } else { 1e-9 / direction.dot(normal).abs().max(1e-4) };
            let on_border = (at - low).min(high - at).min_element() < 1e-9;
            // At the border of a surface, rounding may take a touching ray past it.
            if !on_border || !is_tangent {
                assert!(
                    found.iter().any(|meeting| (meeting.distance - distance).abs() < error),
                    "{index} {ray:?} {at} {distance} {found:?}"
                );
            }
        }
    }
}

#[test]
fn rays_within_a_flat_patch_end() {
    let flat = NurbsSurface::new(
        [3, 3],
        [vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0], vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]],
        [4, 4],
        (0..16).map(|index| DVec3::new((index / 4) as f64, (index % 4) as f64, 0.0)).collect(),
        vec![1.0; 16],
    )
    .unwrap();
    let patches = patches(&flat);
    let mut random = SplitMix(15);
    for _ in 0..100 {
        let direction = DVec2::from_angle(random.between(0.0, TAU)).extend(0.0);
        let through = DVec3::new(random.between(0.5, 2.5), random.between(0.5, 2.5), 0.0);
        let ray = Ray { origin: through - 6.0 * direction, direction };
        let found = meet_all(&patches, &ray, ALL);
        assert!(!found.is_empty());
        assert!(gap(&flat, &ray, &found) < 1e-10, "{ray:?} {found:?} {}", gap(&flat, &ray, &found));
    }
}

#[test]
fn odd_rays_meet_nothing() {
    let patches = patches(&sphere(1.0));
    for (origin, direction) in [
        (DVec3::ZERO, DVec3::ZERO),
        (DVec3::NAN, DVec3::X),
        (DVec3::ZERO, DVec3::INFINITY),
        (DVec3::MAX, DVec3::X),
    ] {
        assert!(meet_all(&patches, &Ray { origin, direction }, ALL).is_empty());
    }
    let ray = Ray { origin: DVec3::ZERO, direction: DVec3::X };
    assert!(meet_all(&patches, &ray, [f64::NAN; 2]).is_empty());
}

/// Rays a second against one patch. Run by name.
#[test]
#[ignore = "a measurement"]
fn speed() {
    let mut random = SplitMix(16);
    for (name, surface) in [("sphere", sphere(1.0)), ("wavy", wavy(7))] {
        let patches = patches(&surface);
        let patch = &patches[patches.len() / 2];
        let [least, greatest] = patch.bounds();
        let rays: Vec<_> = (0..100_000)
            .map(|_| {
                let direction = random.direction();
                let spread = DVec3::from_array([0; 3].map(|_| random.between(0.0, 1.0)));
                Ray { origin: least + spread * (greatest - least) - 4.0 * direction, direction }
            })
            .collect();
        let mut found = Vec::new();
        let start = std::time::Instant::now();
        for ray in &rays {
            patch.meet(ray, ALL, &mut found);
            found.truncate(0);
        }
        let seconds = start.elapsed().as_secs_f64();
        println!("{name}: {:.0} rays a second through a patch's box", rays.len() as f64 / seconds);
        // Rays that touch, the dearest that are no accident.
        let touching: Vec<_> = (0..2000)
            .map(|_| {
                let unit = DVec2::new(random.between(0.0, 1.0), random.between(0.0, 1.0));
                let at = patch.range[0] + unit * (patch.range[1] - patch.range[0]);
                let [place, by_u, by_v] = surface.derivatives(at);
                let direction = random.direction().reject_from(by_u.cross(by_v).normalize()).normalize();
                Ray { origin: place - 4.0 * direction, direction }
            })
            .collect();
        let start = std::time::Instant::now();
        for ray in &touching {
            patch.meet(ray, ALL, &mut found);
            found.truncate(0);
        }
        println!(
            "{name}: {:.0} touching rays a second",
            touching.len() as f64 / start.elapsed().as_secs_f64()
        );
    }
}
