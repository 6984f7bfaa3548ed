//! First view of a scene without cameras and lights: the camera and the lamp added by a bake.

use boxes::add_box;
use glam::{Vec2, Vec3, vec3};
use rebounce::bake::{BakeSettings, Preset, lights_and_cameras};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Hit, Ray, Surfaces};
use rebounce::light::direct;
use rebounce::random::Stream;
use rebounce::scene::Scene;
use rebounce_shared::camera::CameraFrame;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::meta::Material;

use crate::common::boxes;

/// Boxes, each with its own material; in a room, the first box faces in.
fn scene(blocks: &[(Vec3, Vec3)], is_room: bool) -> Scene {
    let mut scene = Scene::default();
    for (number, (low, high)) in blocks.iter().enumerate() {
        let shade = 0.3 + 0.5 * number as f32 / blocks.len() as f32;
        let base_color = [shade, 0.6, 0.9 - shade, 1.0];
        scene.materials.push(Material { base_color, name: number.to_string(), ..Material::default() });
        add_box(&mut scene, [*low, *high], is_room && number == 0, number as u32);
    }
    scene
}

/// A room of random size with furniture on its floor.
fn room(stream: &mut Stream, scale: f32) -> Scene {
    let size = vec3(3.5 + 6.0 * stream.unit(), 2.3 + 2.0 * stream.unit(), 3.5 + 6.0 * stream.unit());
    let mut blocks = vec![(Vec3::ZERO, size)];
    for _ in 0..(stream.unit() * 7.0) as usize {
        let extent = vec3(0.3 + 1.3 * stream.unit(), 0.4 + 1.4 * stream.unit(), 0.3 + 1.0 * stream.unit());
        let at = (size - extent) * vec3(stream.unit(), 0.0, stream.unit());
        blocks.push((at, at + extent));
    }
    let blocks: Vec<_> = blocks.iter().map(|(low, high)| (*low * scale, *high * scale)).collect();
    scene(&blocks, true)
}

/// A plate with a few blocks.
fn object(stream: &mut Stream, scale: f32) -> Scene {
    let plate = vec3(1.0 + 2.0 * stream.unit(), 0.05 + 0.2 * stream.unit(), 1.0 + 2.0 * stream.unit());
    let mut blocks = vec![(Vec3::ZERO, plate)];
    for _ in 0..1 + (stream.unit() * 4.0) as usize {
        let extent = vec3(0.1 + 0.8 * stream.unit(), 0.2 + 2.0 * stream.unit(), 0.1 + 0.8 * stream.unit());
        let at =
            (plate - extent).max(Vec3::ZERO) * vec3(stream.unit(), 0.0, stream.unit()) + plate.y * Vec3::Y;
        blocks.push((at, at + extent));
    }
    let blocks: Vec<_> = blocks.iter().map(|(low, high)| (*low * scale, *high * scale)).collect();
    scene(&blocks, false)
}

/// An object on a far larger plain.
fn landscape(stream: &mut Stream) -> Scene {
    let mut house = object(stream, 1.0);
    let first = house.positions.len() as u32;
    for (x, z) in [(-3e3, -3e3), (-3e3, 3e3), (3e3, 3e3), (3e3, -3e3)] {
        house.positions.push(vec3(x, 0.0, z));
        house.normals.push(Vec3::Y);
        house.uvs.push(Vec2::ZERO);
    }
    house.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    house.triangle_material.extend([0, 0]);
    house
}

/// A hollow vessel, open at the top, as a surface of revolution: radii and heights of the outside profile from
/// below; the inside is offset by the thickness.
fn vessel(profile: &[Vec2], thickness: f32, scale: f32) -> Scene {
    const SIDES: u32 = 32;
    let inside = profile.iter().rev().map(|p| Vec2::new((p.x - thickness).max(1e-3), p.y.max(thickness)));
    let outline: Vec<Vec2> = profile.iter().copied().chain(inside).collect();
    let mut scene = Scene { materials: vec![Material::default()], ..Scene::default() };
    let at = |side: u32, p: Vec2| {
        let (sin, cos) = (std::f32::consts::TAU * (side % SIDES) as f32 / SIDES as f32).sin_cos();
        scale * vec3(p.x * cos, p.y, p.x * sin)
    };
    for pair in outline.windows(2) {
        for side in 0..SIDES {
            let corners =
                [at(side, pair[0]), at(side, pair[1]), at(side + 1, pair[1]), at(side + 1, pair[0])];
            let normal = (corners[1] - corners[0]).cross(corners[3] - corners[0]).normalize_or(Vec3::Y);
            let first = scene.positions.len() as u32;
            scene.positions.extend(corners);
            scene.normals.extend([normal; 4]);
            scene.uvs.extend([Vec2::ZERO; 4]);
            scene.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            scene.triangle_material.extend([0; 2]);
        }
    }
    scene
}

struct Seen {
    surfaces: TriangleSurfaces,
    frame: CameraFrame,
    light: Light,
}

impl Seen {
    fn new(scene: &Scene) -> Self {
        let (lights, cameras) = lights_and_cameras(scene, &BakeSettings::new(Preset::Draft)).unwrap();
        let surfaces = TriangleSurfaces::from_scene(scene);
        assert_eq!((lights.len(), cameras.len()), (1, 1));
        Self { surfaces, frame: cameras[0].frame(scene.origin), light: lights[0].clone() }
    }

    fn lamp(&self) -> Vec3 {
        Vec3::from(self.light.position().unwrap().map(|x| x as f32))
    }

    /// Position of a place in a picture of 16:9, from -1 to 1, right and up.
    fn at(&self, place: Vec3) -> Vec2 {
        let (to, t) = (place - self.frame.eye, self.frame.tan_half_yfov);
        let depth = to.dot(self.frame.forward);
        assert!(depth > 0.0, "behind the eye");
        vec2_of(to.dot(self.frame.right) * 9.0 / 16.0, to.dot(self.frame.up)) / (t * depth)
    }

    fn look(&self, x: f32, y: f32) -> Option<Hit> {
        let direction = self.frame.direction(160.0 + 160.0 * x, 90.0 - 90.0 * y, 320, 180);
        self.surfaces.see(&Ray::visibility(self.frame.eye, direction), 0).filter(|hit| hit.faces(direction))
    }

    /// Checks the lamp: in the left or right third of the picture, unoccluded, and with light on the view's target.
    fn check_lamp(&self, what: &str) {
        let (lamp, at) = (self.lamp(), self.at(self.lamp()));
        assert!((1.0 / 3.0..0.9).contains(&at.x.abs()) && at.y > 0.0 && at.y < 0.9, "{what}: lamp at {at}");
        let to = lamp - self.frame.eye;
        let ray = Ray { max_distance: to.length(), ..Ray::visibility(self.frame.eye, to.normalize()) };
        assert!(self.surfaces.see(&ray, 0).is_none(), "{what}: hidden");
        let lights = [self.light.source([0.0; 3])];
        let lit = self.lit();
        // The middle of a picture may show a gap.
        if let Some(target) = self.look(0.0, 0.0) {
            assert!(direct::at_hit(&self.surfaces, &lights, &target).x > 0.0, "{what}: the target is dark");
        }
        // Lit surfaces have a plausible radiance: the intensity is neither far too high nor far too low.
        let mean = geometric_mean(&lit);
        assert!((0.3..6.0).contains(&mean), "{what}: irradiance {mean}");
        let hits = self.seen().count();
        assert!(lit.len() * 10 > hits * 2, "{what}: {} of {hits} lit", lit.len());
    }

    /// Hits of camera rays across the picture.
    fn seen(&self) -> impl Iterator<Item = Hit> {
        let places = (0..400).map(|i| (i % 20, i / 20)).map(|(x, y)| [x, y].map(|k| k as f32 / 10.0 - 0.95));
        places.filter_map(|[x, y]| self.look(x, y))
    }

    /// Irradiance of the lit hits of [`Self::seen`].
    fn lit(&self) -> Vec<f32> {
        let lights = [self.light.source([0.0; 3])];
        let irradiance = self.seen().map(|hit| direct::at_hit(&self.surfaces, &lights, &hit).x);
        irradiance.filter(|light| *light > 0.0).collect()
    }

    /// Distance from the lamp to the nearest surface.
    fn free(&self) -> f32 {
        let distance = |i: u64| {
            let ray = Ray::visibility(self.lamp(), Stream::new(5, i).sphere());
            self.surfaces.cast(&ray, 0).map_or(f32::INFINITY, |hit| hit.distance)
        };
        (0..400).map(distance).fold(f32::INFINITY, f32::min)
    }
}

fn geometric_mean(light: &[f32]) -> f32 {
    (light.iter().map(|light| light.ln()).sum::<f32>() / light.len().max(1) as f32).exp()
}

fn vec2_of(x: f32, y: f32) -> Vec2 {
    Vec2::new(x, y)
}

#[test]
fn a_room_is_seen_from_the_height_of_eyes_over_its_floor_and_its_lamp_hangs_in_the_picture() {
    for i in 0..40 {
        let mut stream = Stream::new(0x726f_6f6d, i);
        // Files may use units other than metres.
        let scale = if i % 4 == 3 { 100.0 } else { 1.0 };
        let scene = room(&mut stream, scale);
        let what = format!("room {i}");
        let seen = Seen::new(&scene);
        let (low, high) = seen.surfaces.bounds();
        let eye = seen.frame.eye;
        assert!(eye.cmpgt(low).all() && eye.cmplt(high).all(), "{what}: outside");
        assert!(seen.frame.forward.y.abs() < 1e-3 && seen.frame.up.y > 0.999, "{what}: not level");
        let floor = seen.surfaces.cast(&Ray::visibility(eye, -Vec3::Y), 0).unwrap();
        assert!(floor.position.y < low.y + 1e-3 * scale, "{what}: on the furniture");
        if scale == 1.0 {
            assert!((floor.distance - 1.6).abs() < 1e-3, "{what}: {} above the floor", floor.distance);
        }
        // The view is of far walls: the visible distance in the middle of the picture is at least about half of the
        // room's depth.
        let size = high - low;
        let distances: Vec<f32> =
            (-8..=8).filter_map(|x| seen.look(x as f32 / 9.0, 0.0)).map(|hit| hit.distance).collect();
        let mean = distances.iter().sum::<f32>() / distances.len() as f32;
        assert!(mean > 0.45 * size.x.min(size.z), "{what}: {mean} in a room of {size}");
        // Floor and further surfaces are in the picture.
        let kinds = (0..400)
            .filter_map(|i| seen.look((i % 20) as f32 / 10.0 - 0.95, (i / 20) as f32 / 10.0 - 0.95))
            .map(|hit| hit.geometric_normal.round().to_array().map(|x| x as i32))
            .collect::<std::collections::HashSet<_>>();
        assert!(kinds.contains(&[0, 1, 0]) && kinds.len() >= 3, "{what}: {kinds:?}");
        seen.check_lamp(&what);
        assert!(seen.lamp().y < high.y && seen.lamp().cmpgt(low).all(), "{what}: not below the ceiling");
        assert!(seen.free() > 0.08 * size.y, "{what}: {} free", seen.free());
        // Only a small part of the ceiling is overexposed.
        let lit = seen.lit();
        let mean = geometric_mean(&lit);
        let burnt = lit.iter().filter(|light| **light > 6.0 * mean).count() as f32 / lit.len() as f32;
        assert!(burnt < 0.07, "{what}: {burnt} of the picture is burnt out");
        assert!(matches!(seen.light, Light::Point { .. }));
    }
}

#[test]
fn an_object_fills_the_picture_and_its_lamp_hangs_beside_it() {
    for i in 0..40 {
        let mut stream = Stream::new(0x6f62_6a65, i);
        let scale = [1.0, 0.01, 30.0][i as usize % 3];
        let scene = object(&mut stream, scale);
        let what = format!("object {i}");
        let seen = Seen::new(&scene);
        let (low, high) = seen.surfaces.bounds();
        let corners = (0..8)
            .map(|k| seen.at(Vec3::select(glam::BVec3::new(k & 1 != 0, k & 2 != 0, k & 4 != 0), high, low)));
        let most = corners.clone().fold(Vec2::ZERO, |most, at| most.max(at.abs()));
        let filled = most.y.max(most.x * 16.0 / 9.0 / 1.3);
        assert!((0.8..0.88).contains(&filled), "{what}: {most}");
        assert!(seen.frame.forward.y < -0.1 && seen.frame.right.y.abs() < 1e-3, "{what}: not from above");
        seen.check_lamp(&what);
        let lamp = seen.lamp();
        assert!(lamp.cmplt(low).any() || lamp.cmpgt(high).any() || seen.free() > 0.0, "{what}");
        assert!(seen.free() > 0.03 * (high - low).length(), "{what}: {} free", seen.free());
        let Light::Spot { direction, outer_cone_deg, .. } = &seen.light else { panic!("{:?}", seen.light) };
        // The lamp points at the object.
        let aim = Vec3::from(direction.map(|x| x as f32)).normalize();
        let to = (0.5 * (low + high) - lamp).normalize();
        assert!(aim.dot(to) > 0.999 && *outer_cone_deg >= 15.0, "{what}");
    }
}

#[test]
fn a_vessel_is_seen_from_outside_though_one_could_look_around_in_it() {
    let of = |places: &[(f32, f32)]| places.iter().map(|(x, y)| Vec2::new(*x, *y)).collect::<Vec<_>>();
    let vase = of(&[(1e-3, 0.0), (0.35, 0.0), (0.5, 0.25), (0.42, 0.6), (0.2, 0.9), (0.28, 1.1)]);
    let bucket = of(&[(1e-3, 0.0), (0.45, 0.0), (0.45, 1.0)]);
    for (name, profile, scale) in
        [("vase", &vase, 1.0), ("vase", &vase, 2.5), ("vase", &vase, 100.0), ("bucket", &bucket, 1.0)]
    {
        let seen = Seen::new(&vessel(profile, 0.03, scale));
        let (low, high) = seen.surfaces.bounds();
        let eye = seen.frame.eye;
        assert!(eye.cmplt(low).any() || eye.cmpgt(high).any(), "{name} x {scale}: from within, at {eye}");
        assert!(seen.look(0.0, 0.0).is_some(), "{name} x {scale}: not in the middle");
    }
}

#[test]
fn the_lamp_of_a_landscape_lights_what_has_the_detail() {
    for i in 0..12 {
        let scene = landscape(&mut Stream::new(0x6c61_6e64, i));
        let seen = Seen::new(&scene);
        assert!(seen.surfaces.main_part() != seen.surfaces.bounds(), "landscape {i}");
        seen.check_lamp(&format!("landscape {i}"));
    }
}

#[test]
fn the_first_view_is_the_same_every_time() {
    let scene = room(&mut Stream::new(1, 2), 1.0);
    let settings = BakeSettings::new(Preset::Draft);
    assert_eq!(
        lights_and_cameras(&scene, &settings).unwrap(),
        lights_and_cameras(&scene, &settings).unwrap()
    );
}
