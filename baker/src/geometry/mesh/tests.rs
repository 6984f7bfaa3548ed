mod backs;
mod packet_traversal;
mod tlas;

use super::geometry::Triangle;
use super::triangle::{Corners, ShearedRay};
use super::*;
use crate::geometry::{Primitive, SurfaceCoordinates};
use crate::random::Stream;
use crate::scene::texture::{Sampler, Texels};
use glam::Vec2;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::rbn::meta::{Alpha, Material, Wrap};
use std::sync::Arc;

fn triangle(positions: [Vec3; 3], material: u32) -> Triangle {
    let [a, b, c] = positions;
    let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
    let uvs = [Vec2::ZERO, Vec2::X, Vec2::ONE];
    Triangle { positions, normals: [normal; 3], uvs, material }
}

fn white() -> Material {
    Material { base_color: [0.5, 0.5, 0.5, 1.0], ..Material::default() }
}

fn surfaces(triangles: Vec<Triangle>, materials: &[Material]) -> TriangleSurfaces {
    let surfaces = materials.iter().map(|m| Surface::new(m, |_| None)).collect();
    TriangleSurfaces::new(Geometry { triangles, surfaces, ..Geometry::default() })
}

/// Returns a closed, finely divided, axis-aligned box with a bulging floor, and loose triangles of all sizes inside.
fn scrap(seed: u64) -> Vec<Triangle> {
    let mut stream = Stream::new(seed, 0);
    let mut out = Vec::new();
    let n = 12;
    let at = |i: usize| i as f32 / n as f32 * 2.0 - 1.0;
    for axis in 0..3 {
        for side in [-1.0f32, 1.0] {
            let point = |i: usize, j: usize| {
                let mut p = [0.0; 3];
                p[axis] = side
                    + if axis == 1 && side < 0.0 {
                        -0.1 * (at(i) * at(i) - 1.0) * (at(j) * at(j) - 1.0)
                    } else {
                        0.0
                    };
                p[(axis + 1) % 3] = at(i);
                p[(axis + 2) % 3] = at(j);
                Vec3::from(p)
            };
            for i in 0..n {
                for j in 0..n {
                    out.push(triangle([point(i, j), point(i + 1, j), point(i + 1, j + 1)], 0));
                    out.push(triangle([point(i, j), point(i + 1, j + 1), point(i, j + 1)], 0));
                }
            }
        }
    }
    for _ in 0..1500 {
        let centre = (stream.sphere() * 0.9).clamp(Vec3::splat(-0.9), Vec3::splat(0.9));
        let size = 0.3 * stream.unit().powi(4) + 1e-4;
        out.push(triangle(std::array::from_fn(|_| centre + size * stream.sphere()), 0));
    }
    out
}

fn brute_force(triangles: &[Triangle], ray: &Ray) -> Option<(u32, f32)> {
    let mut best: Option<(u32, f32)> = None;
    for (i, t) in triangles.iter().enumerate() {
        let corners = Corners::new(t.positions);
        if let Some(m) = corners.meet(&ShearedRay::new(ray.origin, ray.direction), ray.max_distance)
            && best.is_none_or(|(_, d)| m.distance < d)
        {
            best = Some((i as u32, m.distance));
        }
    }
    best
}

#[test]
fn hits_equal_brute_force() {
    let triangles = scrap(1);
    let surfaces = surfaces(triangles.clone(), &[white()]);
    let mut stream = Stream::new(2, 0);
    let mut hits = 0;
    for k in 0..100_000 {
        let mut direction = stream.sphere();
        // Kinds of rays: any, along an axis, in an axis plane, and through a shared corner.
        let mut origin = stream.sphere() * 0.95 * stream.unit();
        match k % 4 {
            1 => direction = [Vec3::X, -Vec3::Y, Vec3::Z][k % 3],
            2 => direction = (direction * Vec3::new(0.0, 1.0, 1.0)).normalize(),
            3 => {
                let t = &triangles[stream.bits() as usize % 1700];
                if k % 8 == 3 {
                    origin = (origin * 12.0).round() / 12.0;
                }
                direction = (t.positions[0] - origin).normalize();
            }
            _ => {}
        }
        let max_distance = if k % 5 == 0 { stream.unit() } else { f32::INFINITY };
        let ray = Ray { origin, direction, max_distance, spread: 0.0 };
        let expected = brute_force(&triangles, &ray);
        let found = surfaces.cast(&ray, 0);
        assert_eq!(
            found.map(|h| h.distance),
            expected.map(|e| e.1),
            "ray {k}: {ray:?}, triangle {expected:?}"
        );
        if let (Some(hit), Some((number, _))) = (found, expected) {
            let t = &triangles[number as usize];
            let along = ray.origin + ray.direction * hit.distance;
            assert!(hit.position.distance(along) < 1e-5);
            assert!((hit.position - t.positions[0]).dot(t.normals[0]).abs() < 1e-5);
            hits += 1;
        }
        if expected.is_none() {
            assert!(max_distance <= 1.0, "a closed box lets a ray out: {ray:?}");
        }
        if k % 4 != 0 {
            continue;
        }
        let to = ray.origin + ray.direction * 0.7;
        let length = (to - origin).length();
        let straight = Ray {
            origin,
            direction: (to - origin) / length,
            max_distance: length - surfaces.epsilon(),
            spread: 0.0,
        };
        let hidden = brute_force(&triangles, &straight).is_some();
        assert_eq!(
            surfaces.transmittance(origin, to),
            Vec3::splat(if hidden { 0.0 } else { 1.0 }),
            "ray {k}"
        );
    }
    assert!(hits > 80_000);
}

#[test]
fn a_leaving_ray_does_not_hit_its_own_surface() {
    let triangles = scrap(3);
    let surfaces = surfaces(triangles, &[white()]);
    let mut stream = Stream::new(4, 0);
    for _ in 0..20_000 {
        let ray = Ray {
            origin: Vec3::new(0.0, 0.95, 0.0),
            direction: stream.sphere(),
            max_distance: f32::INFINITY,
            spread: 0.0,
        };
        let Some(hit) = surfaces.cast(&ray, 0) else { continue };
        let direction = stream.cosine_hemisphere(hit.geometric_normal);
        let origin = hit.offset_origin(direction, surfaces.epsilon());
        // Along the plane's normal the origin must be on the correct side, as computed in f32.
        assert!((origin - hit.position).dot(hit.geometric_normal) > 0.0);
        let back = Ray { origin, direction, max_distance: 0.5 * surfaces.epsilon(), spread: 0.0 };
        assert!(surfaces.cast(&back, 0).is_none_or(|h| h.geometric_normal.dot(hit.geometric_normal) < 0.999));
    }
}

/// Returns a square at z = 0 with the material `front`, in front of a square at z = −1.
fn two_squares(front: Material, texture: Option<Sampler>) -> TriangleSurfaces {
    let square = |z: f32, material| {
        let [a, b, c, d] =
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, z));
        let uv = |p: Vec3| Vec2::new(p.x, p.y) * 0.5 + 0.5;
        [[a, b, c], [a, c, d]].map(|positions| Triangle {
            positions,
            normals: [Vec3::Z; 3],
            uvs: positions.map(uv),
            material,
        })
    };
    let triangles = [square(0.0, 0), square(-1.0, 1)].concat();
    let front = Material { base_color_texture: texture.as_ref().map(|_| 0), ..front };
    let surfaces = vec![Surface::new(&front, |_| texture.clone()), Surface::new(&white(), |_| None)];
    TriangleSurfaces::new(Geometry { triangles, surfaces, ..Geometry::default() })
}

fn down(x: f32, y: f32) -> Ray {
    Ray { origin: Vec3::new(x, y, 1.0), direction: -Vec3::Z, max_distance: f32::INFINITY, spread: 0.0 }
}

#[test]
fn masked_texels_are_no_hits() {
    let texels = Texels::new(2, 1, vec![[255, 255, 255, 120], [255, 255, 255, 130]]);
    let sampler =
        Sampler { texels: Arc::new(texels), wrap_u: Wrap::Repeat, wrap_v: Wrap::Repeat, linear_filter: true };
    let mask = Material { alpha: Alpha::Mask { cutoff: 0.5 }, ..white() };
    let s = two_squares(Material { base_color: [0.5, 0.5, 0.5, 1.0], ..mask }, Some(sampler));
    assert_eq!(s.cast(&down(-0.3, 0.1), 0).unwrap().distance.round(), 2.0);
    assert_eq!(s.cast(&down(0.3, 0.1), 0).unwrap().distance.round(), 1.0);
    let through = |x: f32| s.transmittance(Vec3::new(x, 0.1, 1.0), Vec3::new(x, 0.1, -0.5)).x;
    assert_eq!((through(-0.3), through(0.3)), (1.0, 0.0));
}

#[test]
fn blend_lets_its_share_through() {
    let s = two_squares(Material { base_color: [0.5, 0.5, 0.5, 0.3], alpha: Alpha::Blend, ..white() }, None);
    let n = 100_000;
    let stopped = (0..n).filter(|&seed| s.cast(&down(0.3, 0.1), seed).unwrap().distance < 1.5).count();
    assert!((stopped as f32 / n as f32 - 0.3).abs() < 0.006, "{stopped}");
    assert_eq!(s.cast(&down(0.3, 0.1), 7).unwrap().distance, s.cast(&down(0.3, 0.1), 7).unwrap().distance);
    let left = s.transmittance(Vec3::new(0.3, 0.1, 1.0), Vec3::new(0.3, 0.1, -0.5)).x;
    assert!((left - 0.7).abs() < 1e-6);
    assert_eq!(s.transmittance(Vec3::new(0.3, 0.1, 1.0), Vec3::new(0.3, 0.1, -2.0)), Vec3::ZERO);
}

#[test]
fn the_back_of_a_one_sided_surface_blocks_and_reflects_nothing() {
    let up = Ray {
        origin: Vec3::new(0.3, 0.1, -0.5),
        direction: Vec3::Z,
        max_distance: f32::INFINITY,
        spread: 0.0,
    };
    let emission = [1.0, 2.0, 3.0];
    let one_sided = two_squares(Material { emission, ..white() }, None).cast(&up, 0).unwrap();
    assert_eq!((one_sided.albedo, one_sided.emission), (Vec3::ZERO, Vec3::ZERO));
    assert!(!one_sided.faces(up.direction) && one_sided.geometric_normal == -Vec3::Z);
    let two_sided =
        two_squares(Material { double_sided: true, emission, ..white() }, None).cast(&up, 0).unwrap();
    assert_eq!((two_sided.albedo, two_sided.normal), (Vec3::splat(0.5), -Vec3::Z));
    assert_eq!(two_sided.emission, Vec3::new(1.0, 2.0, 3.0));
}

#[test]
fn nothing_at_all_is_a_scene_too() {
    let s = surfaces(Vec::new(), &[]);
    assert!(s.cast(&down(0.0, 0.0), 0).is_none());
    assert_eq!(s.transmittance(Vec3::ZERO, Vec3::ONE), Vec3::ONE);
}

#[test]
fn a_baked_file_is_hit_where_its_scene_is() {
    use rebounce_shared::octahedral::pack_snorm16;
    use rebounce_shared::rbn::bulk::Vertex;
    use rebounce_shared::rbn::meta::Draw;
    let scene = crate::io::load("builtin:cornell-box").unwrap();
    let mut baked = BakedScene::default();
    baked.meta.materials = scene.materials.clone();
    baked.vertices = (scene.positions.iter().zip(&scene.normals).zip(&scene.uvs))
        .map(|((p, &n), uv)| Vertex { position: p.to_array(), normal: pack_snorm16(n), uv: uv.to_array() })
        .collect();
    for material in 0..scene.materials.len() as u32 {
        let of_material =
            scene.triangles.iter().zip(&scene.triangle_material).filter(|(_, m)| **m == material);
        let first_index = baked.indices.len() as u32;
        baked.indices.extend(of_material.flat_map(|(t, _)| *t));
        let index_count = baked.indices.len() as u32 - first_index;
        baked.meta.draws.push(Draw { material, first_index, index_count });
    }
    let (loaded, baked) =
        (TriangleSurfaces::from_scene(&scene), TriangleSurfaces::from_baked(&baked).unwrap());
    assert_eq!(loaded.bounds(), baked.bounds());
    let mut hits = 0;
    for i in 0..5_000 {
        let direction = Stream::new(9, i).sphere();
        let ray =
            Ray { origin: Vec3::new(0.5, 1.9, 1.0), direction, max_distance: f32::INFINITY, spread: 0.0 };
        match (loaded.cast(&ray, 0), baked.cast(&ray, 0)) {
            (Some(a), Some(b)) => {
                hits += 1;
                assert_eq!((a.distance, a.albedo), (b.distance, b.albedo));
                assert!(a.normal.distance(b.normal) < 1e-3);
            }
            (a, b) => assert!(a.is_none() && b.is_none()),
        }
    }
    assert!(hits > 3_000);
}

#[test]
fn a_wide_ray_sees_the_mean_of_a_chequered_square() {
    // 64 x 64 texels over a square of 2 x 2, alternately black and white.
    let rgba = (0..64 * 64).map(|i| if (i + i / 64) % 2 == 0 { [255; 4] } else { [0, 0, 0, 255] }).collect();
    let texture = Sampler {
        texels: Arc::new(Texels::new(64, 64, rgba)),
        wrap_u: Wrap::Repeat,
        wrap_v: Wrap::Repeat,
        linear_filter: false,
    };
    let surfaces = two_squares(Material { base_color: [1.0; 4], ..white() }, Some(texture));
    let mut narrow = 0;
    for i in 0..200 {
        let ray = down(0.009 * i as f32 - 0.9, 0.3);
        let seen = |spread| surfaces.cast(&Ray { spread, ..ray }, 0).unwrap().albedo.x;
        let line = seen(0.0);
        assert!(!(1e-6..=0.999).contains(&line), "{line}");
        narrow += (line > 0.5) as u32;
        // Footprints: twice as wide as a texel at the square, and wider than the square.
        for spread in [0.15, 10.0] {
            assert!((seen(spread) - 0.5).abs() < 0.01, "{} at a spread of {spread}", seen(spread));
        }
    }
    assert!((50..150).contains(&narrow));
}

#[test]
fn a_place_says_what_a_hit_does() {
    let mut triangles = scrap(7);
    let mut stream = Stream::new(8, 0);
    // Bent normals, within half a right angle.
    for t in &mut triangles {
        t.normals = t.normals.map(|normal| (normal + 0.5 * stream.sphere()).normalize());
        t.uvs = std::array::from_fn(|_| stream.square());
    }
    let texels = Texels::new(8, 8, (0..64).map(|i| [i as u8 * 4, 90, 255 - i as u8, 255]).collect());
    let (wrap_u, wrap_v, linear_filter) = (Wrap::Repeat, Wrap::Repeat, true);
    let sampler = Sampler { texels: Arc::new(texels), wrap_u, wrap_v, linear_filter };
    for double_sided in [false, true] {
        let material = Material { double_sided, base_color_texture: Some(0), ..white() };
        let surface = Surface::new(&material, |_| Some(sampler.clone()));
        let geometry =
            Geometry { triangles: triangles.clone(), surfaces: vec![surface], ..Geometry::default() };
        let surfaces = TriangleSurfaces::new(geometry);
        assert_eq!(surfaces.count(), triangles.len());
        let (mut same, mut backs, mut missed) = (0, 0, 0);
        for k in 0..20_000 {
            let origin = stream.sphere() * 0.9 * stream.unit();
            let ray = Ray { origin, direction: stream.sphere(), max_distance: f32::INFINITY, spread: 0.0 };
            let hit = surfaces.cast(&ray, k).unwrap();
            let Some((place, distance)) = surfaces.find(&ray, k) else {
                assert!(!double_sided, "a surface that reflects on both sides is found");
                missed += 1;
                continue;
            };
            assert_eq!(distance, hit.distance);
            backs += place.is_back as u32;
            assert!(place.at.min_element() >= -1e-5 && place.at.element_sum() < 1.0 + 1e-5, "{place:?}");
            let spot = surfaces.spot(place, 0.0);
            assert!(spot.position.distance(hit.position) < 1e-5);
            assert_eq!(spot.opacity, 1.0);
            // The side is the side of the true surface; the bent normal towards the ray may be on the other side.
            if hit.normal.dot(spot.normal) > 0.0 && hit.faces(ray.direction) {
                assert!(hit.normal.distance(spot.normal) < 1e-4, "{} {}", hit.normal, spot.normal);
                assert!(hit.albedo.distance(spot.albedo) < 1e-3, "{} {}", hit.albedo, spot.albedo);
                same += 1;
            }
            let Primitive { sides, has_back, .. } = surfaces.primitive(place.primitive);
            assert_eq!(has_back, double_sided);
            let at = |x: f32, y: f32| {
                surfaces.spot(SurfaceCoordinates { at: Vec2::new(x, y), ..place }, 0.0).position
            };
            let (first, second, third) = (
                at(1.0, 0.0).distance(at(0.0, 0.0)),
                at(0.0, 1.0).distance(at(0.0, 0.0)),
                at(1.0, 0.0).distance(at(0.0, 1.0)),
            );
            assert!((sides[0] - first).abs() < 1e-5 && (sides[1] - second).abs() < 1e-5);
            assert!(third >= first.max(second) - 1e-5, "{first} {second} {third}");
        }
        assert!(same > 15_000 || !double_sided && same + missed > 15_000, "{same} {missed}");
        assert!((backs > 1_000) == double_sided, "{backs}");
        assert!((missed > 1_000) != double_sided, "{missed}");
    }
}
