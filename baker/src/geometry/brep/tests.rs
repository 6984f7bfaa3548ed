//! Rays meet what brute force over the faces meets, closed bodies keep them in, and triangles and faces hide each other.

use super::*;
use crate::geometry::{SceneSurfaces, Surfaces};
use crate::random::Stream;
use crate::scene::Scene;
use crate::scene::assembly::AssemblySettings;
use glam::{Affine3A, DMat3, DQuat};
use rebounce_cad::face::Face;
use rebounce_cad::frame::Frame;
use rebounce_cad::model::{Assembly, Part, PartInstance};
use rebounce_cad::surface::Surface as CadSurface;
use rebounce_cad::trim::{TrimEdge, TrimLoop};
use std::f64::consts::{PI, TAU};

fn rectangle(low: DVec2, high: DVec2) -> TrimLoop {
    let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    (0..4).map(|i| TrimEdge::Segment { from: corners[i], to: corners[(i + 1) % 4] }).collect()
}

fn circle(radius: f64) -> TrimLoop {
    let arc = |angles| TrimEdge::Arc { centre: DVec2::ZERO, radii: DVec2::splat(radius), angles };
    vec![arc([0.0, PI]), arc([PI, TAU])].into_iter().collect()
}

fn frame(origin: DVec3, z: DVec3) -> Frame {
    Frame::new(origin, z, z.any_orthogonal_vector()).unwrap()
}

/// A closed can about the z axis.
fn can(radius: f64, height: f64) -> Part {
    let face = |surface, is_reversed, edges: TrimLoop| {
        (Face { surface, is_reversed, loops: vec![edges] }, Some(Vec3::splat(0.5)))
    };
    let disk = |at: f64, z| {
        let origin = DVec3::new(0.0, 0.0, at);
        face(CadSurface::Plane(frame(origin, z)), false, circle(radius))
    };
    let side = CadSurface::Cylinder { frame: frame(DVec3::ZERO, DVec3::Z), radius };
    Part {
        name: "can".to_owned(),
        faces: vec![
            face(side, false, rectangle(DVec2::ZERO, DVec2::new(TAU, height))),
            disk(0.0, DVec3::NEG_Z),
            disk(height, DVec3::Z),
        ],
        is_closed: true,
    }
}

fn globe(radius: f64) -> Part {
    let surface = CadSurface::Sphere { frame: frame(DVec3::ZERO, DVec3::Z), radius };
    let whole = rectangle(DVec2::new(0.0, -0.5 * PI), DVec2::new(TAU, 0.5 * PI));
    let face = Face { surface, is_reversed: false, loops: vec![whole] };
    Part { name: "globe".to_owned(), faces: vec![(face, Some(Vec3::splat(0.8)))], is_closed: true }
}

/// Part of a torus, open.
fn ring() -> Part {
    let surface = CadSurface::Torus { frame: frame(DVec3::ZERO, DVec3::Z), major: 1.0, minor: 0.4 };
    let some = rectangle(DVec2::new(0.3, -2.0), DVec2::new(5.0, 2.5));
    let face = Face { surface, is_reversed: true, loops: vec![some] };
    Part { name: String::new(), faces: vec![(face, None)], is_closed: false }
}

fn placed(parts: Vec<Part>, places: &[(usize, DAffine3)]) -> Scene {
    let instance = |&(part, world_from_part): &(usize, DAffine3)| PartInstance {
        part,
        path: Vec::new(),
        world_from_part,
    };
    let assembly = Assembly { parts, instances: places.iter().map(instance).collect(), notes: Vec::new() };
    Scene::of_assembly("test", "test".to_owned(), &assembly, &AssemblySettings::default()).unwrap()
}

/// Parts at random places, one of them mirrored.
fn heap() -> Scene {
    let mut s = Stream::new(5, 0);
    let places: Vec<(usize, DAffine3)> = (0..40)
        .map(|i| {
            let turn = DQuat::from_axis_angle(s.sphere().as_dvec3(), 3.0 * f64::from(s.unit()));
            let mirror = if i == 7 { DVec3::new(1.0, 1.0, -1.0) } else { DVec3::ONE };
            let matrix = DMat3::from_quat(turn) * DMat3::from_diagonal(mirror * (0.3 + f64::from(s.unit())));
            (
                i % 3,
                DAffine3 { matrix3: matrix, translation: 8.0 * s.sphere().as_dvec3() * f64::from(s.unit()) },
            )
        })
        .collect();
    placed(vec![can(0.7, 1.5), globe(0.9), ring()], &places)
}

fn rays(count: u64, reach: f32) -> impl Iterator<Item = Ray> {
    (0..count).map(move |i| {
        let mut s = Stream::new(17, i);
        Ray::visibility(reach * s.sphere() * s.unit(), s.sphere())
    })
}

/// The nearest distance and the face's normal there, over all pieces.
fn brute_force(brep: &Brep, ray: &Ray) -> Option<(f64, DVec3)> {
    let mut best: Option<(f64, DVec3)> = None;
    for placed in &brep.instances {
        let part_from_local = placed.local_from_part.inverse();
        let local = CadRay {
            origin: part_from_local.transform_point3(ray.origin.as_dvec3()),
            direction: part_from_local.transform_vector3(ray.direction.as_dvec3()),
        };
        for face in &brep.faces[placed.faces.start as usize..placed.faces.end as usize] {
            for piece in &face.pieces {
                let limit = best.map_or(f64::INFINITY, |best| best.0);
                if let Some(hit) = face.cast.nearest(piece, &local, &mut None, [0.0, limit], |_| true) {
                    let normal = placed.local_from_part.matrix3 * face.cast.normal(hit.at);
                    best = Some((hit.distance, normal.normalize()));
                }
            }
        }
    }
    best
}

#[test]
fn the_hierarchy_finds_the_hits_of_brute_force() {
    let scene = heap();
    let surfaces = SceneSurfaces::from_scene(&scene);
    let brep = scene.brep.as_ref().unwrap();
    let mut hits = 0;
    for ray in rays(20_000, 9.0) {
        let (found, expected) = (surfaces.cast(&ray, 0), brute_force(brep, &ray));
        assert_eq!(found.is_some(), expected.is_some(), "{ray:?}");
        let (Some(found), Some((distance, normal))) = (found, expected) else { continue };
        assert!(
            (f64::from(found.distance) - distance).abs() < 1e-5,
            "{ray:?}: {} {distance}",
            found.distance
        );
        assert!(found.position.distance(ray.origin + found.distance * ray.direction) < 1e-5);
        assert!(found.geometric_normal.as_dvec3().dot(normal).abs() > 1.0 - 1e-6);
        assert!(found.geometric_normal.dot(ray.direction) <= 0.0);
        hits += 1;
        let beyond = ray.origin + ray.direction * (found.distance + 0.01);
        assert_eq!(surfaces.transmittance(ray.origin, beyond), Vec3::ZERO);
        let before = ray.origin + ray.direction * (found.distance * 0.99);
        assert_eq!(surfaces.transmittance(ray.origin, before), Vec3::ONE);
    }
    assert!(hits > 5_000, "{hits}");
}

#[test]
fn fronts_and_backs_are_those_of_the_bodies() {
    let scene = placed(vec![globe(1.0)], &[(0, DAffine3::from_scale(DVec3::splat(2.0)))]);
    let surfaces = SceneSurfaces::from_scene(&scene);
    let outside = surfaces.cast(&Ray::visibility(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z), 0).unwrap();
    assert!((outside.distance - 3.0).abs() < 1e-6 && outside.normal.distance(Vec3::Z) < 1e-6);
    assert_eq!(outside.albedo, Vec3::splat(0.8));
    let within = Ray::visibility(Vec3::ZERO, Vec3::X);
    let back = surfaces.cast(&within, 0).unwrap();
    assert!((back.distance - 2.0).abs() < 1e-6 && back.albedo == Vec3::ZERO && !back.faces(Vec3::X));
    assert!(surfaces.see(&within, 0).is_none());
    // An open surface reflects on both sides.
    let scene = placed(vec![ring()], &[(0, DAffine3::IDENTITY)]);
    let surfaces = SceneSurfaces::from_scene(&scene);
    let from = (DVec3::new(-1.0, 0.1, 0.0) - DVec3::from(scene.origin)).as_vec3();
    let tube = surfaces.see(&Ray::visibility(from, Vec3::Z), 0).unwrap();
    assert!(tube.faces(Vec3::Z) && tube.albedo == Vec3::splat(0.6));
}

#[test]
fn a_closed_body_keeps_rays_in() {
    let turn = DAffine3::from_quat(DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.7));
    let scene = placed(vec![can(0.7, 1.5)], &[(0, turn)]);
    let surfaces = SceneSurfaces::from_scene(&scene);
    let (low, high) = surfaces.bounds();
    let middle = 0.5 * (low + high);
    // Towards the rims too, where two faces share an edge.
    for i in 0..100_000u64 {
        let mut s = Stream::new(3, i);
        let origin = middle + 0.3 * s.sphere() * s.unit();
        let at = f64::from(s.unit()) * TAU;
        let rim = turn.transform_point3(DVec3::new(0.7 * at.cos(), 0.7 * at.sin(), 1.5 * (i % 2) as f64));
        let target = (rim - DVec3::from(scene.origin)).as_vec3() + 1e-6 * s.sphere();
        let direction = if i % 3 == 0 { s.sphere() } else { (target - origin).normalize() };
        assert!(surfaces.cast(&Ray::visibility(origin, direction), 0).is_some(), "{origin} {direction}");
    }
}

#[test]
fn triangles_for_pictures_are_near_the_faces_and_face_their_way() {
    let scene = heap();
    let surfaces = SceneSurfaces::from_scene(&scene);
    let (low, high) = scene.bounds();
    let near = 3e-4 * (high - low).length();
    let (mut count, mut far) = (0, 0);
    // Each model once, where its first instance stands.
    let end = scene.models.first().map_or(scene.triangles.len(), |model| model.triangles.start as usize);
    let alone = (0..end).map(|t| (t, Affine3A::IDENTITY));
    let instanced = scene.models.iter().flat_map(|model| {
        let place = model.local_from_model[0];
        (model.triangles.start as usize..model.triangles.end as usize).map(move |t| (t, place))
    });
    for (triangle, place) in alone.chain(instanced) {
        let triangle = scene.triangles[triangle];
        let corners = triangle.map(|i| place.transform_point3(scene.positions[i as usize]));
        let normals = triangle.map(|i| place.transform_vector3(scene.normals[i as usize]));
        let middle = corners.iter().sum::<Vec3>() / 3.0;
        let spanned = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let normal: Vec3 = normals.iter().sum::<Vec3>().normalize();
        assert!(spanned.dot(normal) > 0.0, "{corners:?} {normals:?}");
        let origin = middle + 2.0 * near * normal;
        let ray = Ray { max_distance: 4.0 * near, ..Ray::visibility(origin, -normal) };
        // Bodies of the heap lie in one another: now and then another face is nearer.
        let is_near = surfaces.cast(&ray, 0).is_some_and(|hit| hit.position.distance(middle) < near);
        count += 1;
        far += usize::from(!is_near);
    }
    assert!(count > 5_000 && far * 100 < count, "{far} of {count}");
}

#[cfg(feature = "demo-scenes")]
#[test]
fn triangles_and_faces_hide_each_other() {
    let mut scene = crate::io::load("builtin:cornell-box").unwrap();
    let room = SceneSurfaces::from_scene(&scene);
    scene.add(placed(vec![globe(0.5)], &[(0, DAffine3::IDENTITY)]), DVec3::new(0.3, 3.5, -2.0)).unwrap();
    let surfaces = SceneSurfaces::from_scene(&scene);
    let globe = |ray: &Ray| {
        let offset = ray.origin + Vec3::from(scene.origin.map(|x| x as f32)) - Vec3::new(0.3, 3.5, -2.0);
        let (b, c) = (offset.dot(ray.direction), offset.length_squared() - 0.25);
        let root = (b * b - c).sqrt();
        [-b - root, -b + root].into_iter().find(|distance| *distance > 0.0)
    };
    let (mut on_globe, mut on_room) = (0, 0);
    for ray in rays(20_000, 2.7) {
        let expected = [globe(&ray), room.cast(&ray, 0).map(|hit| hit.distance)];
        let expected = expected.into_iter().flatten().min_by(f32::total_cmp);
        let found = surfaces.cast(&ray, 0).map(|hit| hit.distance);
        assert_eq!(found.is_some(), expected.is_some());
        if let (Some(found), Some(expected)) = (found, expected) {
            assert!((found - expected).abs() < 1e-4, "{ray:?}: {found} {expected}");
            let is_globe = globe(&ray) == Some(expected);
            on_globe += usize::from(is_globe);
            on_room += usize::from(!is_globe);
        }
    }
    assert!(on_globe > 300 && on_room > 5_000, "{on_globe} {on_room}");
}
