//! TLAS of models: hits equal brute force over the triangles of every copy.

use super::*;
use glam::{Affine3A, Mat3A, Quat};

/// Returns transforms with rotation, translation, various sizes and some stretched; the last two are equal.
fn places(count: usize) -> Vec<Affine3A> {
    let mut stream = Stream::new(5, 0);
    let place = |i: usize| {
        let size = 0.05 + 0.4 * stream.unit().powi(2);
        let pulled = if i.is_multiple_of(3) { Vec3::new(1.0, 0.2 + stream.unit(), 1.0) } else { Vec3::ONE };
        let turn = Quat::from_axis_angle(stream.sphere(), 6.0 * stream.unit());
        Affine3A::from_scale_rotation_translation(size * pulled, turn, 0.7 * stream.sphere())
    };
    let mut places: Vec<Affine3A> = (0..count).map(place).collect();
    places.push(places[count - 1]);
    places
}

/// Returns a closed room with copies of two models: loose triangles of [`scrap`], and a single triangle.
pub(super) fn crowd() -> Geometry {
    let mut triangles = scrap(1);
    let alone = triangles.len();
    let mut model: Vec<Triangle> = scrap(7).into_iter().step_by(9).collect();
    model.iter_mut().for_each(|t| t.material = 1);
    triangles.extend(model);
    let end = triangles.len();
    triangles.push(triangle([Vec3::X, Vec3::Y, Vec3::Z], 1));
    let models = vec![
        Placed { triangles: alone..end, local_from_model: places(20) },
        Placed { triangles: end..end + 1, local_from_model: places(7) },
    ];
    let materials = [white(), Material { double_sided: true, ..white() }];
    let surfaces = materials.iter().map(|m| Surface::new(m, |_| None)).collect();
    Geometry { triangles, models, surfaces, ..Geometry::default() }
}

fn ray(stream: &mut Stream) -> Ray {
    let origin = 0.9 * stream.sphere() * stream.unit();
    Ray { origin, direction: stream.sphere(), max_distance: f32::INFINITY, spread: 0.0 }
}

/// Returns the number and the distance of the nearest triangle.
fn brute_force(geometry: &Geometry, surfaces: &TriangleSurfaces, ray: &Ray) -> Option<(usize, f32)> {
    let line = LocalRay { origin: ray.origin, direction: ray.direction };
    let nearest = |line: &LocalRay, range: std::ops::Range<usize>| {
        let sheared = ShearedRay::new(line.origin, line.direction);
        let meet = |i: usize| {
            Some((i, Corners::new(geometry.triangles[i].positions).meet(&sheared, f32::INFINITY)?))
        };
        range.filter_map(meet).map(|(i, m)| (i, m.distance)).min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let mut found = vec![nearest(&line, 0..geometry.models[0].triangles.start)];
    for copy in &surfaces.instances.all {
        let model = &geometry.models[copy.model as usize];
        found.push(nearest(&copy.line(&line), model.triangles.clone()));
    }
    found.into_iter().flatten().min_by(|a, b| a.1.total_cmp(&b.1))
}

#[test]
fn hits_among_copies_equal_brute_force() {
    let geometry = crowd();
    let surfaces = TriangleSurfaces::new(geometry.clone());
    assert_eq!(surfaces.triangle_count(), geometry.triangles.len());
    let more = |m: &Placed| m.triangles.len() * m.local_from_model.len();
    let primitives = geometry.models[0].triangles.start + geometry.models.iter().map(more).sum::<usize>();
    assert_eq!(surfaces.primitives().unwrap().count(), primitives);
    let mut stream = Stream::new(2, 0);
    let mut of_copies = 0;
    for k in 0..20_000 {
        let ray = ray(&mut stream);
        let expected = brute_force(&geometry, &surfaces, &ray);
        let found = surfaces.nearest(&ray, 0);
        assert_eq!(found.map(|(_, m)| m.distance), expected.map(|e| e.1), "ray {k}: {ray:?}");
        assert!(found.is_some(), "a closed box lets a ray out: {ray:?}");
        of_copies += found.is_some_and(|(found, _)| found.copy.is_some()) as u32;
        let to = ray.origin + 0.7 * ray.direction;
        let length = (to - ray.origin).length();
        let straight = Ray { direction: (to - ray.origin) / length, ..ray };
        let hidden =
            brute_force(&geometry, &surfaces, &straight).is_some_and(|e| e.1 <= length - surfaces.epsilon());
        assert_eq!(
            surfaces.transmittance(ray.origin, to),
            Vec3::splat(if hidden { 0.0 } else { 1.0 }),
            "ray {k}"
        );
    }
    println!("{of_copies} of 20000 rays end at copies");
    assert!((4_000..16_000).contains(&of_copies));
}

#[test]
fn a_hit_is_where_and_what_its_piece_says() {
    let surfaces = TriangleSurfaces::new(crowd());
    let primitives = surfaces.primitives().unwrap();
    let mut stream = Stream::new(3, 0);
    for _ in 0..20_000 {
        let ray = ray(&mut stream);
        let (Some(hit), Some((place, distance))) = (surfaces.cast(&ray, 0), primitives.find(&ray, 0)) else {
            continue;
        };
        assert!(hit.position.distance(ray.origin + ray.direction * hit.distance) < 1e-5);
        let (spot, primitive) = (primitives.spot(place, 0.0), primitives.primitive(place.primitive));
        assert_eq!(hit.distance, distance);
        assert!(spot.position.distance(hit.position) < 1e-5);
        assert!(
            spot.normal.dot(hit.normal) > 0.9999 && spot.albedo == hit.albedo && hit.normal.is_normalized()
        );
        assert!(hit.geometric_normal.dot(hit.normal).abs() > 0.999, "flat triangles");
        assert!(primitive.middle.distance(hit.position) <= primitive.sides[0] + primitive.sides[1]);
        // A ray leaving the hit does not hit the surface again.
        let direction = stream.cosine_hemisphere(hit.geometric_normal);
        let origin = hit.offset_origin(direction, surfaces.epsilon());
        assert!((origin - hit.position).dot(hit.geometric_normal) > 0.0);
        let back = Ray { origin, direction, max_distance: 0.5 * surfaces.epsilon(), spread: 0.0 };
        assert!(surfaces.cast(&back, 0).is_none_or(|h| h.geometric_normal.dot(hit.geometric_normal) < 0.999));
    }
}

#[test]
fn of_copies_at_one_place_the_first_counts_and_chance_is_their_own() {
    let flat = triangle([Vec3::new(-9.0, -9.0, 0.0), Vec3::new(9.0, -9.0, 0.0), Vec3::new(0.0, 9.0, 0.0)], 0);
    let behind = Affine3A::from_translation(-Vec3::Z);
    let with = |places: Vec<Affine3A>, alpha: Alpha, opacity: f32| {
        let material = Material { base_color: [0.5, 0.5, 0.5, opacity], alpha, ..white() };
        let models = vec![Placed { triangles: 0..1, local_from_model: places }];
        let surfaces = vec![Surface::new(&material, |_| None)];
        TriangleSurfaces::new(Geometry { triangles: vec![flat], models, surfaces, ..Geometry::default() })
    };
    let two = with(vec![Affine3A::IDENTITY; 2], Alpha::Opaque, 1.0);
    let (found, _) = two.nearest(&down(0.1, 0.1), 0).unwrap();
    assert!(std::ptr::eq(found.copy.unwrap(), two.instances.all.iter().min_by_key(|c| c.number()).unwrap()));
    let panes = with(vec![Affine3A::IDENTITY, behind], Alpha::Blend, 0.5);
    let (from, to) = (Vec3::new(0.1, 0.1, 1.0), Vec3::new(0.1, 0.1, -2.0));
    assert!((panes.transmittance(from, to).x - 0.25).abs() < 1e-6);
    // 50% of the rays stop at the first pane, 25% at the second.
    let stops = |z: f32| {
        let stops = |seed: &u32| panes.cast(&down(0.1, 0.1), *seed).is_some_and(|h| h.position.z == z);
        (0..40_000).filter(stops).count()
    };
    let (first, second) = (stops(0.0), stops(-1.0));
    assert!(first.abs_diff(20_000) < 500 && second.abs_diff(10_000) < 500, "{first}, {second}");
}

#[test]
fn of_too_many_pieces_none_are_told() {
    let with = |copies: usize| {
        let triangles: Vec<Triangle> = scrap(1);
        let places = (0..copies).map(|i| Affine3A::from_translation(Vec3::new(3.0 * i as f32, 0.0, 0.0)));
        let models = vec![Placed { triangles: 0..triangles.len(), local_from_model: places.collect() }];
        let surfaces = vec![Surface::new(&white(), |_| None)];
        TriangleSurfaces::new(Geometry { triangles, models, surfaces, ..Geometry::default() })
    };
    let most = (MOST_PRIMITIVES / scrap(1).len() as u64) as usize;
    let (few, many) = (with(most), with(most + 1));
    assert!(few.primitives().is_some() && many.primitives().is_none());
    assert!(many.piece_count() > MOST_PRIMITIVES && many.triangle_count() == few.triangle_count());
    // Both have every copy, including the last.
    for surfaces in [few, many] {
        let last = surfaces.bounds().1.x - 1.0;
        let ray =
            Ray { origin: Vec3::new(last, 0.95, 0.0), direction: Vec3::Y, max_distance: 1.0, spread: 0.0 };
        assert!(surfaces.cast(&ray, 0).is_some());
    }
}

#[test]
fn boxes_hold_their_copies() {
    let mut stream = Stream::new(9, 0);
    for place in places(50) {
        let (low, high) =
            crate::scene::model::bounds_of_copy(&place, [Vec3::new(-1.0, 0.0, -2.0), Vec3::ONE]);
        for _ in 0..200 {
            let inside = Vec3::new(2.0 * stream.unit() - 1.0, stream.unit(), 3.0 * stream.unit() - 2.0);
            let p = place.transform_point3(inside);
            assert!((low - 1e-6).cmple(p).all() && p.cmple(high + 1e-6).all());
        }
        assert!(Mat3A::determinant(&place.matrix3) > 0.0);
    }
}
