//! Glossy transfer: an even light stays even, light adds up, turned scenes look the same, a wall hides what the closed form
//! says, and files without metal keep their bytes.

use glam::{Mat3, Quat, Vec2, Vec3};
use rayon::ThreadPoolBuilder;
use rebounce::bake::{BakeSettings, Preset, bake};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::{Only, Picture};
use rebounce::scene::Scene;
use rebounce::transport::gloss::{GlossSettings, Transfer};
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::Relit;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::environment::Environment;
use rebounce_shared::gloss::GlossyField;
use rebounce_shared::harmonics::COUNT;
use rebounce_shared::light::Light;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::rbn::meta::Material;
use rebounce_shared::rbn::{GLOSS_SECTIONS, container};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

pub const SKY: Light = Light::Environment { file: None, rotation_deg: 0.0, intensity: 1.0, color: [1.0; 3] };
/// Value of the first of the harmonics.
const FIRST: f32 = 0.282_094_8;

pub fn metal(albedo: [f32; 3], roughness: f32) -> Material {
    let [r, g, b] = albedo;
    Material { base_color: [r, g, b, 1.0], metallic: 1.0, roughness, specular: 0.5, ..Material::default() }
}

pub fn matt([r, g, b]: [f32; 3]) -> Material {
    Material { base_color: [r, g, b, 1.0], ..Material::default() }
}

/// A scene under the sky, seen from a place that looks at the origin; its local space is world space.
pub fn empty(materials: Vec<Material>, eye: Vec3) -> Scene {
    let camera =
        Camera { position: eye.as_dvec3().to_array(), target: [0.0; 3], up: [0.0, 1.0, 0.0], yfov_deg: 40.0 };
    Scene { name: "metal".into(), materials, lights: vec![SKY], cameras: vec![camera], ..Scene::default() }
}

/// Adds a parallelogram; its front is on the side of u × v.
pub fn add_quad(scene: &mut Scene, middle: Vec3, [u, v]: [Vec3; 2], material: u32) {
    let first = scene.positions.len() as u32;
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    scene.positions.extend(corners.map(|[a, b]| middle + a * u + b * v));
    scene.normals.extend([u.cross(v).normalize(); 4]);
    scene.uvs.extend([Vec2::ZERO; 4]);
    scene.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    scene.triangle_material.extend([material; 2]);
}

/// Adds a smooth-shaded ball.
pub fn add_ball(scene: &mut Scene, middle: Vec3, radius: f32, material: u32) {
    const AROUND: u32 = 96;
    const ALONG: u32 = 48;
    let first = scene.positions.len() as u32;
    for row in 0..=ALONG {
        for column in 0..=AROUND {
            let (theta, phi) = (PI * row as f32 / ALONG as f32, TAU * column as f32 / AROUND as f32);
            let normal = Vec3::new(theta.sin() * phi.cos(), theta.cos(), -theta.sin() * phi.sin());
            scene.positions.push(middle + radius * normal);
            scene.normals.push(normal);
            scene.uvs.push(Vec2::ZERO);
        }
    }
    for row in 0..ALONG {
        for column in 0..AROUND {
            let a = first + row * (AROUND + 1) + column;
            let [b, c, d] = [a + 1, a + AROUND + 2, a + AROUND + 1];
            if row > 0 {
                scene.triangles.push([a, d, b]);
            }
            if row + 1 < ALONG {
                scene.triangles.push([b, d, c]);
            }
        }
    }
    scene.triangle_material.resize(scene.triangles.len(), material);
}

fn settings(functions: usize) -> BakeSettings {
    let mut settings = BakeSettings::new(Preset::Draft);
    (settings.place.levels, settings.place.functions) = (4, functions);
    settings.operator.rays = vec![256];
    // Links have laws of their own.
    settings.gloss = Some(GlossSettings { transfer: Transfer::Matrices, ..GlossSettings::default() });
    settings.normalised()
}

fn baked(scene: &Scene, functions: usize) -> BakedScene {
    bake(scene, &settings(functions), &()).unwrap().0
}

pub fn lighting(file: &BakedScene, lights: &[Light], environment: Option<&Arc<Environment>>) -> Lighting {
    Lighting::new(lights, environment, file.meta.origin, file.sources.groups.len())
}

/// The picture of a scene's camera with gloss.
fn picture(scene: &Scene, file: &BakedScene, lighting: Lighting, samples: u32) -> Picture {
    let surfaces = TriangleSurfaces::from_scene(scene);
    let relit = Relit::lit(file, &surfaces, lighting, false).with_gloss(file, &surfaces);
    let exposure = Exposure { size: [96, 96], samples, seed: 7 };
    relit.picture(file, &surfaces, &scene.cameras[0], exposure, Only::All, || ())
}

/// A metal ball over a red floor, beside a wall.
pub fn still_life(turn: Mat3) -> Scene {
    let eye = turn * Vec3::new(0.5, 2.0, 4.5);
    let materials = vec![metal([0.9, 0.8, 0.6], 0.3), matt([0.7, 0.15, 0.1]), matt([0.6; 3])];
    let mut scene = empty(materials, eye);
    add_ball(&mut scene, Vec3::ZERO, 0.8, 0);
    add_quad(&mut scene, Vec3::Y * -0.9, [Vec3::Z * 2.0, Vec3::X * 2.0], 1);
    add_quad(&mut scene, Vec3::new(-1.6, 0.2, 0.0), [Vec3::Y * 1.1, Vec3::Z * 1.5], 2);
    scene.positions.iter_mut().chain(&mut scene.normals).for_each(|vector| *vector = turn * *vector);
    scene
}

/// A sky of every colour, brighter on one side.
pub fn colours() -> Arc<Environment> {
    let (width, height) = (64, 32);
    let at = |i: u32| {
        let direction = rebounce_shared::environment::direction_at(
            (f64::from(i % width) + 0.5) / f64::from(width),
            (f64::from(i / width) + 0.5) / f64::from(height),
        );
        Vec3::splat(0.3) + (direction + 1.0) * (1.0 + 2.0 * direction.x.max(0.0).powi(2))
    };
    Arc::new(Environment { width, height, pixels: (0..width * height).map(at).collect() })
}

#[test]
fn a_white_metal_ball_in_an_even_light_is_not_to_be_seen() {
    for roughness in [0.1, 0.3, 0.5, 0.8] {
        let mut scene = empty(vec![metal([1.0; 3], roughness)], Vec3::Z * 3.2);
        add_ball(&mut scene, Vec3::ZERO, 1.0, 0);
        let file = baked(&scene, 2_000);
        assert!(!file.gloss.is_empty());
        let picture = picture(&scene, &file, lighting(&file, &[SKY], None), 16);
        let off = picture.pixels.iter().map(|pixel| (*pixel - 1.0).abs().max_element());
        let worst = off.fold(0.0f32, f32::max);
        assert!(worst < 0.01, "roughness {roughness}: off by {worst}");
        assert!(picture.pixels.iter().any(|pixel| *pixel != Vec3::ONE));
    }
}

#[test]
fn arriving_light_is_linear_in_the_light() {
    let file = baked(&still_life(Mat3::IDENTITY), 2_000);
    let sun = Light::Directional {
        direction: [-0.6, -1.0, -0.2],
        intensity: 3.0,
        color: [1.0, 0.9, 0.5],
        radius_deg: 0.3,
    };
    let colours = colours();
    let of = |lights: &[Light]| GlossyField::new(&file, &lighting(&file, lights, Some(&colours)), &[]);
    let twice = Light::Environment { file: None, rotation_deg: 0.0, intensity: 2.0, color: [1.0; 3] };
    let [sky, sun, both] = [of(&[SKY]), of(std::slice::from_ref(&sun)), of(&[twice, sun])];
    let (mut compared, mut bounced) = (0, 0.0f32);
    for point in 0..file.points.len() {
        let (Some(sky), Some(sun), Some(both)) = (sky.at(point), sun.at(point), both.at(point)) else {
            continue;
        };
        for i in 0..COUNT {
            let expected = 2.0 * sky[i].truncate() + sun[i].truncate();
            let off = both[i].truncate().distance(expected);
            assert!(off < 1e-4 * (1.0 + expected.length()), "{point}, {i}: off by {off}");
            assert_eq!((sky[i].w, sun[i].w), (both[i].w, both[i].w));
            bounced = bounced.max(sun[i].truncate().length());
        }
        compared += 1;
    }
    assert!(compared > 100 && bounced > 0.1, "{compared} {bounced}");
}

#[test]
fn a_scene_turned_with_its_sky_looks_the_same() {
    // Points are placed anew; both pictures have the errors of theirs.
    const MOST: f64 = 0.03;
    let (degrees, colours) = (50.0f64, colours());
    let taken = |degrees: f64| {
        let scene = still_life(Mat3::from_quat(Quat::from_rotation_y(degrees.to_radians() as f32)));
        let file = baked(&scene, 4_000);
        let sky = Light::Environment { file: None, rotation_deg: degrees, intensity: 1.0, color: [1.0; 3] };
        picture(&scene, &file, lighting(&file, &[sky], Some(&colours)), 16)
    };
    let (still, turned) = (taken(0.0), taken(degrees));
    let off = rebounce::verify::compare::compare(&turned, &still, None).unwrap().error.figure();
    assert!(off < MOST, "{off}");
    // Under the same sky it does not.
    let scene = still_life(Mat3::from_quat(Quat::from_rotation_y(degrees.to_radians() as f32)));
    let file = baked(&scene, 1_000);
    let other = picture(&scene, &file, lighting(&file, &[SKY], Some(&colours)), 4);
    let other = rebounce::verify::compare::compare(&other, &still, None).unwrap().error.figure();
    assert!(other > 3.0 * MOST, "{other}");
}

#[test]
fn a_scene_without_gloss_has_no_sections_of_it_and_the_bytes_of_before() {
    let mut scene = empty(vec![matt([0.7, 0.3, 0.2]), metal([0.9; 3], 0.95)], Vec3::new(0.5, 2.0, 4.5));
    add_ball(&mut scene, Vec3::ZERO, 0.8, 0);
    add_quad(&mut scene, Vec3::Y * -0.9, [Vec3::Z * 2.0, Vec3::X * 2.0], 1);
    let without = BakeSettings { gloss: None, ..settings(500) };
    let [with, without] = [settings(500), without].map(|settings| {
        let file = bake(&scene, &settings, &()).unwrap().0;
        assert!(file.sources.has_sky);
        file.to_bytes().unwrap()
    });
    assert!(with == without);
    let sections = container::read(&with).unwrap();
    assert!(sections.iter().all(|section| !GLOSS_SECTIONS.contains(&section.name)));
    // The same scene in metal has all of them.
    scene.materials[0] = metal([0.7, 0.3, 0.2], 0.4);
    let metal = baked(&scene, 500).to_bytes().unwrap();
    let sections = container::read(&metal).unwrap();
    assert!(GLOSS_SECTIONS.iter().all(|name| sections.iter().any(|section| section.name == *name)));
}

#[test]
fn transfer_survives_the_file_and_is_the_same_with_any_number_of_threads() {
    let scene = still_life(Mat3::IDENTITY);
    let bytes: Vec<Vec<u8>> = [1, 2, 5]
        .map(|threads| {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let file = pool.install(|| baked(&scene, 800));
            assert!(file.gloss.matrices() > 50);
            let bytes = file.to_bytes().unwrap();
            let back = BakedScene::from_bytes(&bytes).unwrap();
            assert!(back.gloss == file.gloss);
            assert!(back.to_bytes().unwrap() == bytes);
            bytes
        })
        .to_vec();
    assert!(bytes[0] == bytes[1] && bytes[0] == bytes[2]);
}

#[test]
fn a_ceiling_over_a_metal_plate_hides_its_solid_angle_of_the_sky() {
    // Of 2π: the fixed directions, interpolation between points, and rounding to bytes.
    const MOST: f32 = 0.01;
    const HEIGHT: f32 = 0.8;
    let half = Vec2::new(0.9, 0.5);
    let mut scene = empty(vec![metal([0.9; 3], 0.4), matt([0.0; 3])], Vec3::new(0.0, 2.0, 4.0));
    add_quad(&mut scene, Vec3::ZERO, [Vec3::Z, Vec3::X], 0);
    add_quad(&mut scene, Vec3::Y * HEIGHT, [Vec3::X * half.x, Vec3::Z * half.y], 1);
    // With matrices wherever they differ.
    let gloss = Some(GlossSettings { epsilon: 0.03, ..GlossSettings::default() });
    let file = bake(&scene, &BakeSettings { gloss, ..settings(2_000) }, &()).unwrap().0;
    let field = GlossyField::new(&file, &lighting(&file, &[SKY], None), &[]);
    // A rectangle with one corner over the place.
    let of_corner = |x: f32, z: f32| (x * z / (HEIGHT * (x * x + z * z + HEIGHT * HEIGHT).sqrt())).atan();
    let (mut compared, mut least, mut most, mut off) = (0, f32::MAX, 0.0f32, 0.0f32);
    for point in file.display() {
        let at = file.points[point].position();
        let Some(arriving) = field.at(point).filter(|_| at.y.abs() < 1e-3) else { continue };
        let [left, right, back, front] = [at.x + half.x, half.x - at.x, at.z + half.y, half.y - at.z];
        let hidden =
            of_corner(left, back) + of_corner(left, front) + of_corner(right, back) + of_corner(right, front);
        // Half of the mirrored sphere.
        let open = 0.5 * arriving[0].w / FIRST;
        let expected = TAU - hidden;
        off = off.max((open - expected).abs() / TAU);
        (compared, least, most) = (compared + 1, least.min(open), most.max(open));
    }
    assert!(off < MOST, "{off} of the hemisphere");
    assert!(compared > 100 && most - least > 0.15 * TAU, "{compared} points, {least} to {most}");
}
