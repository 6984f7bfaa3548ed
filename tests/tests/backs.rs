//! Backs of one-sided surfaces: a camera outside a room sees into the room through the walls' backs, in the viewer
//! and on the CPU. Two faces back to back equal a double-sided face.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;
use crate::panel;
use rebounce_shared::baked::BakedScene;

use common::{mean_and_stops, picture};
use glam::{Vec3, vec3};
use panel::panel;
use rebounce::bake::bake;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::light::illumination::Illumination;
use rebounce::scene::Scene;
use rebounce::verify::expose::Exposure;
use rebounce::verify::path_trace::{Settings, path_trace};
use rebounce::verify::render::render;
use rebounce_shared::camera::Camera;
use rebounce_shared::rbn::meta::Material;
use rebounce_tests::small::settings;
use rebounce_viewer::settings::Mode;
use std::path::Path;

const SIZE: u32 = 96;

fn camera(position: Vec3, target: Vec3) -> Camera {
    Camera {
        position: position.as_dvec3().to_array(),
        target: target.as_dvec3().to_array(),
        up: [0.0, 1.0, 0.0],
        yfov_deg: 50.0,
    }
}

/// A grey room from -1 to 1 with walls that face in, a lamp inside and a camera outside.
fn doll_house() -> Scene {
    let mut scene = rebounce::io::load("builtin:furnace").unwrap();
    scene.cameras = vec![camera(vec3(1.2, 2.0, 3.5), Vec3::ZERO)];
    scene
}

/// Returns the scene without triangles that face away from the camera.
fn opened(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    let eye = scene.cameras[0].frame(scene.origin).eye;
    let faces = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|i| scene.positions[i as usize]);
        (b - a).cross(c - a).dot(eye - a) > 0.0
    };
    let kept: Vec<bool> = scene.triangles.iter().map(faces).collect();
    let mut is_kept = kept.iter();
    scene.triangles.retain(|_| *is_kept.next().unwrap());
    let mut is_kept = kept.iter();
    scene.triangle_material.retain(|_| *is_kept.next().unwrap());
    assert!(scene.triangles.len() < kept.len());
    scene
}

/// A room with two boards: pairs of faces back to back, or double-sided faces.
fn boards(pairs: bool) -> Scene {
    let mut scene = rebounce::io::load("builtin:furnace").unwrap();
    scene.cameras = vec![camera(vec3(0.3, 0.35, 0.95), vec3(0.0, -0.35, -0.6))];
    let material = scene.materials.len() as u32;
    let base_color = [0.8, 0.6, 0.3, 1.0];
    scene.materials.push(Material { base_color, double_sided: !pairs, ..Material::default() });
    for (place, across, up) in [
        (vec3(-0.1, -0.4, 0.0), vec3(0.0, 0.0, 0.5), vec3(0.6, 0.0, 0.0)),
        (vec3(0.1, -0.2, -0.613), vec3(0.7, 0.0, 0.0), vec3(0.0, 0.6, 0.0)),
    ] {
        panel(&mut scene, place, [across, up], material, false);
        if pairs {
            panel(&mut scene, place, [up, across], material, true);
        }
    }
    scene
}

fn baked(scene: &Scene) -> BakedScene {
    bake(scene, &settings(2_000), &()).unwrap().0
}

fn exposure(samples: u32) -> Exposure {
    Exposure { size: [SIZE; 2], samples, seed: 5 }
}

fn rendered(file: &BakedScene, only: Only) -> Vec<Vec3> {
    let surfaces = TriangleSurfaces::from_baked(file).unwrap();
    let (camera, lights) = (&file.meta.cameras[0], &file.meta.lights);
    render(file, &surfaces, camera, lights, exposure(16), only, || ()).pixels
}

fn traced(scene: &Scene, only: Only) -> Vec<Vec3> {
    let surfaces = TriangleSurfaces::from_scene(scene);
    let settings = Settings { only, ..Settings::default() };
    let (camera, lights) = (&scene.cameras[0], &scene.lights);
    let illumination = Illumination::of(&surfaces, lights, scene.origin, 1.0);
    path_trace(&surfaces, scene.origin, camera, &illumination, exposure(16), settings, || ()).pixels
}

/// Counts pixels of `picture` that differ from the median of their 3 × 3 neighbourhood by more than `share` of the
/// median plus the mean (above a step of 8 bits), excluding pixels with half of such a difference in `truth`.
fn speckles(picture: &[Vec3], truth: &[Vec3], share: f32) -> usize {
    let mean = truth.iter().sum::<Vec3>().element_sum() / truth.len() as f32;
    let stands_out = |pixels: &[Vec3], x: u32, y: u32, share: f32| {
        let at = |x: u32, y: u32| pixels[(y * SIZE + x) as usize].element_sum();
        let mut around: Vec<f32> = (0..9).map(|k| at(x + k % 3 - 1, y + k / 3 - 1)).collect();
        around.sort_by(f32::total_cmp);
        (at(x, y) - around[4]).abs() > share * (around[4] + mean)
    };
    let inner = 1..SIZE - 1;
    let pixels = inner.clone().flat_map(|y| inner.clone().map(move |x| (x, y)));
    pixels.filter(|&(x, y)| stands_out(picture, x, y, share) && !stands_out(truth, x, y, 0.5 * share)).count()
}

#[test]
fn a_room_is_seen_from_outside_through_its_walls() {
    let closed = doll_house();
    let open = opened(&closed);
    let [of_closed, of_open] = [&closed, &open].map(|scene| traced(scene, Only::Direct));
    assert_eq!(of_closed, of_open, "the path tracer's direct light");
    let room: Vec<usize> = (0..of_open.len()).filter(|i| of_open[*i] != Vec3::ZERO).collect();
    assert!(room.len() > of_open.len() / 6, "{} pixels of the room", room.len());
    let files = [&closed, &open].map(baked);
    let [of_closed, of_open] = [0, 1].map(|i| rendered(&files[i], Only::Direct));
    assert_eq!(of_closed, of_open, "the file's direct light");
    let indirect = rendered(&files[0], Only::Indirect);
    assert!(room.iter().all(|i| indirect[*i].min_element() > 0.0), "no pixel is black");
    // The walls enclose the bounced light: the sum over the room matches the path tracer.
    let truth = traced(&closed, Only::Indirect);
    let sum = |pixels: &[Vec3]| room.iter().map(|i| pixels[*i].x).sum::<f32>();
    assert!((sum(&indirect) / sum(&truth) - 1.0).abs() < 0.03, "{}, {}", sum(&indirect), sum(&truth));
    assert!(sum(&truth) > 2.0 * sum(&traced(&open, Only::Indirect)), "walls block light from both sides");
}

#[test]
fn so_the_viewer_shows_it() {
    let scene = doll_house();
    let files = [baked(&scene), baked(&opened(&scene))];
    let truth = rendered(&files[0], Only::All);
    let (_, stops) = mean_and_stops(&truth);
    let Some(mut renderer) = common::renderer(&files[0]) else { return };
    let shown = picture(&mut renderer, [SIZE; 2], stops);
    let error = common::difference(&shown, &truth).0;
    println!("viewer and CPU: {error}");
    assert!(error < 0.04, "{error}");
    let Some(mut open) = common::renderer(&files[1]) else { return };
    let mut direct = [&mut renderer, &mut open].map(|renderer| {
        renderer.set_mode(Mode::Direct);
        picture(renderer, [SIZE; 2], stops)
    });
    let error = common::difference(&direct[0], &direct[1]).0;
    println!("closed and opened, direct: {error}");
    assert!(error < 0.01, "{error}");
    let lit = |pixel: &Vec3| pixel.max_element() > 0.0;
    direct.iter_mut().for_each(|pixels| pixels.retain(lit));
    assert!(direct[0].len().abs_diff(direct[1].len()) <= direct[1].len() / 200);
    renderer.gpu().check().unwrap();
}

#[test]
fn two_faces_back_to_back_are_as_one_with_both_sides() {
    let files = [true, false].map(|pairs| baked(&boards(pairs)));
    let [pairs, plain] = [0, 1].map(|i| rendered(&files[i], Only::Direct));
    assert_eq!(pairs, plain, "direct light");
    let [pairs, plain] = [0, 1].map(|i| rendered(&files[i], Only::Indirect));
    let (error, count) = (common::difference(&pairs, &plain).0, speckles(&pairs, &plain, 0.1));
    let bias = pairs.iter().sum::<Vec3>().x / plain.iter().sum::<Vec3>().x - 1.0;
    println!("bounced light: {error}, bias {bias}, {count} speckles");
    assert!(error < 0.05 && bias.abs() < 0.01 && count == 0, "{error}, {bias}, {count}");
    let [pairs, plain] = [true, false].map(|pairs| traced(&boards(pairs), Only::All));
    let error = common::difference(&pairs, &plain).0;
    println!("path traced: {error}");
    let bias = pairs.iter().sum::<Vec3>().x / plain.iter().sum::<Vec3>().x - 1.0;
    assert!(bias.abs() < 0.01, "{bias}");
    let truth = rendered(&files[1], Only::All);
    let (_, stops) = mean_and_stops(&truth);
    let Some(mut renderer) = common::renderer(&files[0]) else { return };
    let shown = picture(&mut renderer, [SIZE; 2], stops);
    let Some(mut renderer) = common::renderer(&files[1]) else { return };
    let plain = picture(&mut renderer, [SIZE; 2], stops);
    let (error, count) = (common::difference(&shown, &plain).0, speckles(&shown, &plain, 0.1));
    println!("viewer: {error}, {count} speckles");
    assert!(error < 0.03 && count == 0, "{error}, {count}");
    renderer.gpu().check().unwrap();
}

#[test]
fn so_they_are_in_given_scenes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/cases/twosides");
    if !folder.exists() {
        return;
    }
    let load = |name: &str| rebounce::io::load(folder.join(name).to_str().unwrap()).unwrap();
    let files = ["two_opposite.glb", "two_plain.glb"].map(|name| baked(&load(name)));
    for only in [Only::Direct, Only::Indirect] {
        let [opposite, plain] = [0, 1].map(|i| rendered(&files[i], only));
        let (error, count) = (common::difference(&opposite, &plain).0, speckles(&opposite, &plain, 0.1));
        println!("{only:?}: {error}, {count} speckles");
        assert!(error < 0.05 && count == 0, "{only:?}: {error}, {count}");
    }
}
