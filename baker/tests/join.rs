//! A scene put into another has the triangles of both.

use glam::{DVec3, Vec3};
use rebounce::scene::Scene;

fn load(name: &str) -> Scene {
    rebounce::io::load(&format!("builtin:{name}")).unwrap()
}

/// Corners in world space, and the colour of the material, of every triangle, with every instance of a model.
fn triangles(scene: &Scene) -> Vec<([DVec3; 3], [f32; 4])> {
    let end = scene.models.first().map_or(scene.triangles.len(), |m| m.triangles.start as usize);
    let color = |t: usize| scene.materials[scene.triangle_material[t] as usize].base_color;
    let corner = |i: u32| scene.positions[i as usize];
    let world = |p: Vec3| p.as_dvec3() + DVec3::from(scene.origin);
    let mut out: Vec<_> =
        (0..end).map(|t| (scene.triangles[t].map(|i| world(corner(i))), color(t))).collect();
    for model in &scene.models {
        for place in &model.local_from_model {
            for t in model.triangles.start as usize..model.triangles.end as usize {
                let corners = scene.triangles[t].map(|i| world(place.transform_point3(corner(i))));
                out.push((corners, color(t)));
            }
        }
    }
    out
}

#[test]
fn both_scenes_are_there_the_other_one_moved() {
    let at = DVec3::new(20.0, 1.0, -3.0);
    for [own, other] in [["cornell-box", "gallery"], ["gallery", "cornell-box"], ["gallery", "gallery"]] {
        let (own, other) = (load(own), load(other));
        let mut all = own.clone();
        all.add(other.clone(), at).unwrap();
        let mut expected = triangles(&own);
        expected
            .extend(triangles(&other).into_iter().map(|(corners, color)| (corners.map(|p| p + at), color)));
        let mut found = triangles(&all);
        let key = |(corners, _): &([DVec3; 3], [f32; 4])| corners.map(|p| (p * 256.0).round().to_array());
        expected.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap());
        found.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap());
        assert_eq!(found.len(), expected.len());
        let sum = |all: &[([DVec3; 3], [f32; 4])]| {
            all.iter().fold((DVec3::ZERO, 0.0), |(p, c), (corners, color)| {
                (p + corners.iter().sum::<DVec3>(), c + f64::from(color[0]) * corners[0].x)
            })
        };
        let (a, b) = (sum(&found), sum(&expected));
        let scale = 1e-4 * found.len() as f64;
        assert!(a.0.distance(b.0) < scale && (a.1 - b.1).abs() < scale, "{a:?}, {b:?}");
        // A sky stays behind.
        let lamps = other.lights.iter().filter(|light| light.kind().is_lamp()).count();
        assert_eq!(all.lights.len(), own.lights.len() + lamps);
        assert_eq!(all.normals.len(), all.positions.len());
        let shift = (DVec3::from(other.origin) + at - DVec3::from(own.origin)).as_vec3();
        let (own, other) = (own.bounds(), other.bounds());
        let (low, high) = (own.0.min(other.0 + shift), own.1.max(other.1 + shift));
        let bounds = all.bounds();
        assert!(bounds.0.distance(low) < 1e-4 && bounds.1.distance(high) < 1e-4);
    }
}
