//! No light passes through walls, for any size of functions beside the walls.

use glam::{DVec3, Vec3};
use rebounce::bake::{BakeSettings, Preset, bake};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Ray, Surfaces};
use rebounce::random::Stream;
use rebounce::scene::Scene;
use rebounce::verify::render::Relit;
use rebounce_shared::baked::BakedScene;

/// Mean bounced irradiance on visible surfaces, seen from the middle of the lit room and of the dark room, and the
/// maximum in the dark room.
fn rooms(name: &str, functions: usize) -> (f32, f32, f32) {
    let scene = rebounce::io::load(name).unwrap();
    let mut settings = BakeSettings::new(Preset::Draft);
    settings.place.functions = functions;
    settings.operator.rays = vec![512, 256, 256, 128, 128];
    let (file, _) = bake(&scene, &settings, &()).unwrap();
    seen_in_rooms(&scene, &file)
}

/// Mean and greatest bounced irradiance of what is seen from a place, local space.
pub fn light_from(surfaces: &TriangleSurfaces, relit: &Relit, place: DVec3) -> (f32, f32) {
    let mut stream = Stream::new(3, 3);
    let (mut sum, mut greatest, count) = (0.0, 0f32, 20_000);
    for _ in 0..count {
        let (origin, direction) = (place.as_vec3(), stream.sphere());
        let ray = Ray { origin, direction, max_distance: f32::INFINITY, spread: 0.0 };
        let hit = surfaces.cast(&ray, 0).unwrap();
        let light = relit.indirect(surfaces, &hit, &mut stream).dot(Vec3::splat(1.0 / 3.0));
        sum += light;
        greatest = greatest.max(light);
    }
    (sum / count as f32, greatest)
}

/// The figures of [`rooms`] for a baked file.
pub fn seen_in_rooms(scene: &Scene, file: &BakedScene) -> (f32, f32, f32) {
    let surfaces = TriangleSurfaces::from_scene(scene);
    let relit = Relit::new(file, &surfaces, &scene.lights, true);
    let seen_from = |world: DVec3| light_from(&surfaces, &relit, world - DVec3::from(scene.origin));
    let ((lit, _), (other, greatest)) =
        (seen_from(DVec3::new(-2.0, 1.2, 2.0)), seen_from(DVec3::new(2.0, 1.2, 2.0)));
    (lit, other, greatest)
}

#[test]
fn a_room_next_to_a_lit_one_is_black() {
    // Functions of 20 and of 8 cm across; the wall is 5 cm thick.
    for functions in [3000, 16_000] {
        let (lit, other, greatest) = rooms("builtin:two-rooms", functions);
        assert!(lit > 1.0, "{lit}");
        assert!(other <= 1e-3 * lit && greatest <= 1e-2 * lit, "{other} and at most {greatest} beside {lit}");
    }
}

#[test]
fn an_open_door_lets_light_through() {
    let (lit, other, _) = rooms("builtin:two-rooms-door", 3000);
    assert!((0.02..0.5).contains(&(other / lit)), "{other} beside {lit}");
}

#[test]
#[ignore = "takes much processor time: docs/dev/testing.md"]
fn no_light_comes_through_a_curtain_where_it_meets_a_pillar() {
    let scene = rebounce::io::load("builtin:arcade").unwrap();
    let (file, _) = bake(&scene, &BakeSettings::new(Preset::Draft), &()).unwrap();
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let relit = Relit::new(&file, &surfaces, &scene.lights, false);
    // Sides of the pillars behind the curtains, with the folds leaning over: the sides get darker towards the
    // folds.
    let light = |x: f64| {
        let places =
            (1..=4).flat_map(|k| (0..24).map(move |j| (2.2 * k as f64 + 0.25, 0.8 + 0.08 * j as f64)));
        let at = |(z, y): (f64, f64)| (DVec3::new(x, y, z) - DVec3::from(scene.origin)).as_vec3();
        places.map(|place| relit.interpolated(at(place), Vec3::Z, 0).dot(Vec3::splat(1.0 / 3.0))).sum::<f32>()
    };
    let (beside, away) = (light(-0.235) + light(-0.25), light(-0.34) + light(-0.36));
    assert!(beside < 1.5 * away, "{beside} beside the curtains, {away} away from them");
}
