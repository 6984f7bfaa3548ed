//! Files for an environment: convex things are open, the light is the operator's, linear, turned with the scene, and of
//! emissive surfaces too.

use crate::gloss::{SKY, add_ball, colours, empty, lighting, matt, metal, still_life};
use glam::{Mat3, Quat, Vec3};
use rayon::ThreadPoolBuilder;
use rebounce::bake::{BakeError, BakeSettings, Preset, Purpose, bake};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::scene::Scene;
use rebounce::transport::environment::{TransferSettings, keep_for_environment};
use rebounce::verify::render::Relit;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::diffuse_transfer::{DistantLight, Received, TransferField, open};
use rebounce_shared::environment::Environment;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::bulk::Point;
use rebounce_shared::rbn::{GLOSS_SECTIONS, container};
use rebounce_shared::relight;
use std::f32::consts::PI;
use std::sync::Arc;

fn settings(functions: usize) -> BakeSettings {
    let mut settings = BakeSettings::new(Preset::Draft).for_environment();
    (settings.place.levels, settings.place.functions) = (4, functions);
    settings.operator.rays = vec![256];
    settings.normalised()
}

fn baked(scene: &Scene, functions: usize) -> BakedScene {
    let file = bake(scene, &settings(functions), &()).unwrap().0;
    assert!(file.is_for_environment());
    BakedScene::from_bytes(&file.to_bytes().unwrap()).unwrap()
}

/// Irradiance of the points.
fn received(file: &BakedScene, lights: &[Light], environment: Option<&Arc<Environment>>) -> Vec<Received> {
    TransferField::new(file).irradiance(&DistantLight::new(&lighting(file, lights, environment)))
}

/// RMS difference over the finest points, relative to the RMS of the second.
fn difference(file: &BakedScene, ours: &[Vec3], truth: &[Vec3]) -> f32 {
    let finest = file.display();
    let sum = |f: &dyn Fn(usize) -> f32| finest.clone().map(f).sum::<f32>();
    (sum(&|i| ours[i].distance_squared(truth[i])) / sum(&|i| truth[i].length_squared())).sqrt()
}

fn all(received: &[Received]) -> Vec<Vec3> {
    received.iter().map(|received| received.direct + received.bounced).collect()
}

#[test]
fn a_ball_is_open_all_around_and_needs_few_vectors() {
    let mut scene = empty(vec![matt([0.8, 0.5, 0.2])], Vec3::Z * 3.0);
    add_ball(&mut scene, Vec3::ZERO, 1.0, 0);
    let file = baked(&scene, 2_000);
    let stored = file.diffuse_transfer.stored();
    assert!(stored * 10 < file.points.len(), "{stored} of {}", file.points.len());
    let white = received(&file, &[SKY], None);
    for received in &white {
        assert!((received.direct - PI).abs().max_element() < 0.01 * PI, "{}", received.direct);
        assert!(received.bounced.max_element() < 0.01);
    }
    // Under colours it is the closed form by normals.
    let light = DistantLight::new(&lighting(&file, &[SKY], Some(&colours())));
    let received: Vec<Vec3> =
        received(&file, &[SKY], Some(&colours())).iter().map(|received| received.direct).collect();
    let closed =
        |point: &Point| -> Vec3 { open(point.normal()).iter().zip(&light.sky).map(|(t, l)| *l * *t).sum() };
    let closed: Vec<Vec3> = file.points.iter().map(closed).collect();
    let off = difference(&file, &received, &closed);
    assert!(off < 0.01, "{off}");
}

#[test]
fn light_is_that_of_the_operator_that_it_was_made_from() {
    let scene = still_life(Mat3::IDENTITY);
    let mut room = settings(2_000);
    room.purpose = Purpose::Room;
    let linked = bake(&scene, &room, &()).unwrap().0;
    let mut file = linked.clone();
    keep_for_environment(&mut file, &TransferSettings::default());
    for turn in [0.0, 100.0] {
        let sky = Light::Environment { file: None, rotation_deg: turn, intensity: 1.0, color: [1.0; 3] };
        let light = lighting(&linked, std::slice::from_ref(&sky), Some(&colours()));
        let direct = relight::from_sources(&linked, &linked.sources.strengths(light.sky.as_deref(), &[]));
        let bounced = relight::relight(&linked, direct[..linked.direct_count()].to_vec());
        let received = received(&file, &[sky], Some(&colours()));
        let ours: Vec<Vec3> = received.iter().map(|received| received.direct).collect();
        let off = difference(&file, &ours, &direct);
        assert!(off < 0.03, "{off}");
        let ours: Vec<Vec3> = received.iter().map(|received| received.bounced).collect();
        let off = difference(&file, &ours, &bounced);
        assert!(off < 0.1, "{off}");
    }
    let bytes = file.to_bytes().unwrap();
    assert!(bytes.len() < linked.to_bytes().unwrap().len());
    // Metals reflect by matrices.
    let sections = container::read(&bytes).unwrap();
    assert!(GLOSS_SECTIONS.iter().all(|name| sections.iter().any(|section| section.name == *name)));
}

#[test]
fn light_adds_up_and_is_multiplied() {
    let file = baked(&still_life(Mat3::IDENTITY), 800);
    let sun = Light::Directional {
        direction: [-0.6, -0.7, 0.2],
        intensity: 3.0,
        color: [1.0, 0.8, 0.6],
        radius_deg: 0.5,
    };
    let colours = colours();
    let [sky, sun_alone, both] =
        [vec![SKY], vec![sun.clone()], vec![SKY, sun]].map(|lights| received(&file, &lights, Some(&colours)));
    let mut reached = 0;
    for ((sky, sun), both) in sky.iter().zip(&sun_alone).zip(&both) {
        // A lamp gives its direct light itself. Light that would be below 0 is 0.
        assert_eq!(both.direct, sky.direct);
        let sum = sky.bounced + sun.bounced;
        if sky.bounced.min_element() > 0.0 && sun.bounced.min_element() > 0.0 {
            assert!(both.bounced.distance(sum) < 1e-4 * (1.0 + sum.length()), "{} {sum}", both.bounced);
        }
        reached += (sun.bounced.length() > 0.05) as usize;
    }
    assert!(reached > 50, "the sun bounces: {reached}");
    let twice = Light::Environment { file: None, rotation_deg: 0.0, intensity: 2.0, color: [1.0; 3] };
    for (once, twice) in sky.iter().zip(received(&file, &[twice], Some(&colours))) {
        assert!((*once * 2.0).direct.distance(twice.direct) <= 1e-4 * twice.direct.length());
    }
}

#[test]
fn a_turned_scene_under_a_turned_sky_has_the_same_light() {
    let degrees = 137.0f64;
    let light = |turned: bool| {
        let turn =
            Mat3::from_quat(Quat::from_rotation_y(if turned { degrees.to_radians() as f32 } else { 0.0 }));
        let rotation_deg = if turned { degrees } else { 0.0 };
        let sky = Light::Environment { file: None, rotation_deg, intensity: 1.0, color: [1.0; 3] };
        let scene = still_life(turn);
        let file = baked(&scene, 1_500);
        let surfaces = TriangleSurfaces::from_scene(&scene);
        let relit = Relit::lit(&file, &surfaces, lighting(&file, &[sky], Some(&colours())), false);
        // Places on the floor and on the wall.
        let floor = (0..64)
            .map(|i| (Vec3::new((i % 8) as f32 / 3.0 - 1.1, -0.9, (i / 8) as f32 / 3.0 - 1.1), Vec3::Y));
        let wall = (0..16)
            .map(|i| (Vec3::new(-1.6, (i % 4) as f32 / 3.0 - 0.4, (i / 4) as f32 / 3.0 - 0.5), Vec3::X));
        let at = |(place, normal): (Vec3, Vec3)| {
            let light = relit.light_at(turn * place, turn * normal, 0);
            light.bounced + light.from_sources
        };
        floor.chain(wall).map(at).collect::<Vec<_>>()
    };
    let [still, turned] = [light(false), light(true)];
    let sum = |f: &dyn Fn(usize) -> f32| (0..still.len()).map(f).sum::<f32>();
    let off = (sum(&|i| still[i].distance_squared(turned[i])) / sum(&|i| still[i].length_squared())).sqrt();
    assert!(off < 0.04, "{off}");
}

#[test]
fn surfaces_that_shine_light_the_rest_in_their_strength() {
    let mut scene = still_life(Mat3::IDENTITY);
    scene.materials[2].emission = [3.0, 2.0, 1.0];
    let file = baked(&scene, 1_500);
    assert_eq!(file.diffuse_transfer.layout.groups, 1);
    let emissive = |intensity: f64| Light::Emissive { group: 0, intensity, color: [1.0; 3] };
    let [one, half] = [1.0, 0.5].map(|intensity| all(&received(&file, &[emissive(intensity)], None)));
    let lit = one.iter().zip(&half).filter(|(one, half)| {
        assert!((**one * 0.5).distance(**half) <= 1e-3 + 0.01 * half.length());
        one.length() > 0.1
    });
    assert!(lit.count() > 300);
    // As the operator has it.
    let mut room = settings(1_500);
    room.purpose = Purpose::Room;
    let linked = bake(&scene, &room, &()).unwrap().0;
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let [ours, theirs] = [&file, &linked].map(|of| {
        let relit = Relit::lit(of, &surfaces, lighting(of, &[emissive(1.0)], None), false);
        let at = |i: usize| {
            let point = &file.points[i];
            let light = relit.light_at(point.position(), point.normal(), 0);
            light.bounced + light.from_sources
        };
        (0..file.points.len()).map(at).collect::<Vec<_>>()
    });
    let off = difference(&file, &ours, &theirs);
    assert!(off < 0.1, "{off}");
}

#[test]
fn a_closed_room_is_refused_and_any_number_of_threads_writes_the_same_bytes() {
    let room = rebounce::io::load("builtin:furnace").unwrap();
    assert!(matches!(bake(&room, &settings(500), &()), Err(BakeError::NoSky)));
    let mut scene = still_life(Mat3::IDENTITY);
    scene.materials[1] = metal([0.8, 0.6, 0.4], 0.5);
    let bytes = [1, 3].map(|threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| baked(&scene, 600)).to_bytes().unwrap()
    });
    assert!(bytes[0] == bytes[1]);
}
