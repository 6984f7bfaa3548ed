//! Backs of one-sided triangles: culled for cameras; of two faces back to back a ray hits the face towards its origin.

use super::*;

/// Returns a ray with the origin inside the box of [`scrap`], or outside for a large `reach`.
fn ray(stream: &mut Stream, reach: f32) -> Ray {
    let origin = reach * stream.sphere() * stream.unit();
    Ray { origin, direction: stream.sphere(), max_distance: f32::INFINITY, spread: 0.0 }
}

/// Returns the triangle with reversed orientation, from another first corner, moved along its normal by `by`.
fn reversed(t: &Triangle, by: f32) -> Triangle {
    let [a, b, c] = t.positions.map(|position| position + t.normals[0] * by);
    triangle([b, a, c], t.material)
}

#[test]
fn a_camera_sees_what_there_is_without_the_backs() {
    let mut triangles = scrap(4);
    triangles.iter_mut().enumerate().for_each(|(i, t)| t.material = (i % 3 == 0) as u32);
    let surfaces = surfaces(triangles.clone(), &[white(), Material { double_sided: true, ..white() }]);
    let mut stream = Stream::new(9, 0);
    let (mut through, mut ended) = (0, 0);
    for _ in 0..5_000 {
        let ray = ray(&mut stream, 3.0);
        let is_there = |t: &&Triangle| t.material == 1 || t.normals[0].dot(ray.direction) < 0.0;
        let fronts: Vec<Triangle> = triangles.iter().filter(is_there).copied().collect();
        let expected = brute_force(&fronts, &ray).map(|found| found.1);
        let seen = surfaces.see(&ray, 0);
        assert_eq!(seen.map(|hit| hit.distance), expected, "{ray:?}");
        assert!(seen.is_none_or(|hit| hit.faces(ray.direction)), "{ray:?}");
        let place = surfaces.find_seen(&ray, 0);
        assert_eq!(place.map(|(_, distance)| distance), expected, "{ray:?}");
        let cast = surfaces.cast(&ray, 0).map(|hit| hit.distance);
        through += (cast != expected) as u32;
        ended += expected.is_some() as u32;
    }
    assert!(through > 500 && ended > 2_000, "{through} through backs, {ended} ended");
}

#[test]
fn of_two_faces_back_to_back_a_ray_finds_the_one_that_faces_it() {
    let fronts = scrap(6);
    // Distance of the faces, as a fraction of the offset of ray origins: separately written faces differ by rounding.
    for (apart, missed) in [(0.0, 0), (0.4, 10), (-0.4, 10)] {
        let epsilon = surfaces(fronts.clone(), &[white()]).epsilon();
        let mut pairs = fronts.clone();
        pairs.extend(fronts.iter().map(|t| reversed(t, apart * epsilon)));
        let one = surfaces(fronts.clone(), &[Material { double_sided: true, ..white() }]);
        let pairs = surfaces(pairs, &[white()]);
        let mut stream = Stream::new(3, 1);
        let (mut dark, mut far) = (0, 0);
        for _ in 0..20_000 {
            let ray = ray(&mut stream, 0.95);
            let (Some(hit), Some(expected)) = (pairs.cast(&ray, 0), one.cast(&ray, 0)) else {
                panic!("a closed box lets a ray out: {ray:?}");
            };
            dark += !hit.faces(ray.direction) as u32;
            assert_eq!(pairs.find(&ray, 0).is_some(), hit.faces(ray.direction), "{ray:?}");
            let steep = expected.geometric_normal.dot(ray.direction).abs();
            far += ((hit.distance - expected.distance).abs() * steep > 2.0 * epsilon) as u32;
            // A ray leaving the face does not hit the opposite face.
            let origin = hit.offset_origin(hit.normal, epsilon);
            let on = Ray::visibility(origin, hit.normal);
            assert!(pairs.cast(&on, 0).is_none_or(|next| next.distance > 0.1 * epsilon), "{ray:?}");
        }
        // A ray past an edge, nearer than the distance of the faces, hits one of the faces only: one ray in several
        // thousand.
        assert!(dark <= missed && far <= missed, "{apart}: {dark} dark, {far} elsewhere");
    }
}

#[test]
fn together_rays_find_the_same_faces_of_pairs() {
    let mut triangles = scrap(1);
    let pairs: Vec<Triangle> = triangles.iter().step_by(2).map(|t| reversed(t, 0.0)).collect();
    triangles.extend(pairs);
    packet_traversal::find_the_same(&surfaces(triangles.clone(), &[white()]), &triangles);
    // A copy's face on a face without instances, and two copies back to back.
    let mut crowd = tlas::crowd();
    crowd.surfaces[1].double_sided = false;
    let model = crowd.models[0].triangles.clone();
    let at = crowd.models[0].local_from_model[0];
    let placed = |t: &Triangle| triangle(t.positions.map(|p| at.transform_point3(p)), 0);
    let alone: Vec<Triangle> =
        crowd.triangles[model.clone()].iter().map(|t| reversed(&placed(t), 0.0)).collect();
    let first = model.start;
    crowd.triangles.splice(first..first, alone.iter().copied());
    for model in &mut crowd.models {
        model.triangles = model.triangles.start + alone.len()..model.triangles.end + alone.len();
    }
    let corners = crowd.triangles.clone();
    let surfaces = TriangleSurfaces::new(crowd);
    packet_traversal::find_the_same(&surfaces, &corners);
    // From outside the model, at the copy: whichever face is first, a ray hits a face towards its origin.
    let mut stream = Stream::new(8, 0);
    let (mut met, mut dark) = (0, 0);
    for t in alone.iter().cycle().take(5_000) {
        let [a, b, c] = t.positions;
        let (u, v) = (0.1 + 0.4 * stream.unit(), 0.1 + 0.4 * stream.unit());
        let place = a + (b - a) * u + (c - a) * v;
        let direction = stream.cosine_hemisphere(t.normals[0]) * if stream.unit() < 0.5 { 1.0 } else { -1.0 };
        let ray = Ray { origin: place - direction * 1e-3, direction, max_distance: 1.5e-3, spread: 0.0 };
        let Some(hit) = surfaces.cast(&ray, 0).filter(|hit| (hit.distance - 1e-3).abs() < 1e-5) else {
            continue;
        };
        met += 1;
        dark += !hit.faces(direction) as u32;
    }
    assert!(met > 2_000 && dark <= met / 1_000, "{dark} dark of {met}");
}
