//! Light from the sky and from emissive surfaces: closed forms, linearity, walls, and what does not change.

use glam::{DVec3, Vec3};
use rebounce::bake::{BakeReport, BakeSettings, Baker, Observer, Preset, Preview, bake};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Ray, Surfaces};
use rebounce::io::picture::Only;
use rebounce::light::illumination::Illumination;
use rebounce::random::Stream;
use rebounce::scene::{Scene, emissive_groups};
use rebounce::verify::path_trace;
use rebounce::verify::render::Relit;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::light::Light;
use rebounce_shared::relight::from_sources;
use std::f32::consts::PI;
use std::sync::Mutex;

/// Removes the triangles whose corners all fulfil a condition.
fn remove(scene: &mut Scene, condition: impl Fn(Vec3) -> bool) {
    let is_out = |t: &[u32; 3]| t.iter().all(|i| condition(scene.positions[*i as usize]));
    let is_kept: Vec<bool> = scene.triangles.iter().map(|t| !is_out(t)).collect();
    let mut kept = is_kept.iter();
    scene.triangles.retain(|_| *kept.next().unwrap());
    let mut kept = is_kept.iter();
    scene.triangle_material.retain(|_| *kept.next().unwrap());
}

/// The scene without its ceiling.
fn without_ceiling(name: &str) -> Scene {
    let mut scene = rebounce::io::load(name).unwrap();
    let top = scene.bounds().1.y - 1e-4;
    remove(&mut scene, |p| p.y > top);
    scene
}

/// The furnace, whose ceiling has a material of its own and shines.
fn shining_ceiling(radiance: [f32; 3]) -> Scene {
    let mut scene = rebounce::io::load("builtin:furnace").unwrap();
    let top = scene.bounds().1.y - 1e-4;
    let lamp = rebounce_shared::rbn::meta::Material {
        name: "panel".into(),
        emission: radiance,
        ..scene.materials[0].clone()
    };
    scene.materials.push(lamp);
    for (t, material) in scene.triangles.iter().zip(&mut scene.triangle_material) {
        if t.iter().all(|i| scene.positions[*i as usize].y > top) {
            *material = 1;
        }
    }
    scene.lights.clear();
    scene
}

fn settings() -> BakeSettings {
    let mut settings = BakeSettings::new(Preset::Draft);
    settings.place.functions = 4000;
    settings.operator.rays = vec![512, 256, 256, 128, 128];
    settings
}

fn baked(scene: &Scene) -> (BakedScene, BakeReport) {
    bake(scene, &settings(), &()).unwrap()
}

fn even_sky() -> Light {
    Light::Environment { file: None, rotation_deg: 0.0, intensity: 1.0, color: [1.0; 3] }
}

/// Irradiance of all points from a sky of radiance 1 and groups of strength 1.
fn straight(file: &BakedScene) -> Vec<Vec3> {
    let sky = [Vec3::ONE; rebounce_shared::environment::bins::BINS];
    let emission = vec![Vec3::ONE; file.sources.groups.len()];
    from_sources(file, &file.sources.strengths(Some(&sky), &emission))
}

#[test]
fn a_floor_in_a_box_without_ceiling_gets_the_form_factor_of_the_opening() {
    let scene = without_ceiling("builtin:furnace");
    let (file, report) = baked(&scene);
    assert!(report.has_sky && report.emissive_groups.is_empty() && report.source_links > 0);
    let irradiance = straight(&file);
    // Form factor of a square of edge 2 at distance 2, from below its middle (Howell, B-3, four quarters).
    let f = |a: f32, b: f32| {
        let (x, y) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
        (a / x * (b / x).atan() + b / y * (a / y).atan()) / (2.0 * PI)
    };
    let expected = PI * 4.0 * f(0.5, 0.5);
    let is_middle = |p: Vec3, n: Vec3| n.y > 0.99 && p.x.abs() < 0.15 && p.z.abs() < 0.15;
    let points = file.display().filter(|i| is_middle(file.points[*i].position(), file.points[*i].normal()));
    let found: Vec<f32> = points.map(|i| irradiance[i].x).collect();
    let mean = found.iter().sum::<f32>() / found.len() as f32;
    assert!(found.len() > 5 && (mean / expected - 1.0).abs() < 0.03, "{mean}, not {expected}");
    // White of a grey sky.
    assert!(irradiance.iter().all(|e| (e.x - e.y).abs() <= 1e-5 * e.x.abs().max(1.0)));
}

#[test]
fn a_closed_room_has_no_sky_and_no_section_and_the_operator_does_not_depend_on_it() {
    let closed = rebounce::io::load("builtin:furnace").unwrap();
    let (file, report) = baked(&closed);
    assert!(!report.has_sky && file.source_links.is_empty() && file.sources == Default::default());
    let open = without_ceiling("builtin:furnace");
    let mut without = settings();
    without.sources.sky = false;
    let (with, (without, _)) = (baked(&open).0, bake(&open, &without, &()).unwrap());
    assert!(with.sources.has_sky && without.source_links.is_empty());
    assert_eq!((&with.links, &with.later, &with.points), (&without.links, &without.later, &without.points));
}

/// Keeps the previews.
#[derive(Default)]
struct Viewer(Mutex<Vec<BakedScene>>);

impl Observer for Viewer {
    fn wants_previews(&self) -> bool {
        true
    }

    fn preview(&self, preview: Preview) {
        self.0.lock().unwrap().push(preview.file);
    }
}

#[test]
fn previews_have_the_light_of_sources_and_the_file_does_not_depend_on_them() {
    let scene = without_ceiling("builtin:furnace");
    let mut settings = settings();
    settings.place.functions = 20_000;
    settings.operator.rays = vec![64];
    let viewer = Viewer::default();
    let watched = Baker::new(&settings).observer(&viewer).bake(&scene).unwrap().unwrap().0;
    let previews = viewer.0.into_inner().unwrap();
    assert!(previews.len() > 1 && previews[0].points.len() < watched.points.len());
    let mean = |file: &BakedScene| {
        let irradiance = straight(file);
        file.display().map(|i| irradiance[i].x).sum::<f32>() / file.display().len() as f32
    };
    for preview in &previews {
        assert!((mean(preview) / mean(&watched) - 1.0).abs() < 0.1, "{}", mean(preview));
    }
    assert!(bake(&scene, &settings, &()).unwrap().0 == watched);
}

#[test]
fn files_keep_their_sources_to_the_byte() {
    let (file, _) = baked(&without_ceiling("builtin:furnace"));
    let bytes = file.to_bytes().unwrap();
    let back = BakedScene::from_bytes(&bytes).unwrap();
    assert_eq!((&back.sources, &back.source_links), (&file.sources, &file.source_links));
    assert_eq!(back.to_bytes().unwrap(), bytes);
}

#[test]
fn a_room_with_a_shining_ceiling_is_as_bright_as_the_path_tracer_has_it() {
    let scene = shining_ceiling([3.0, 2.0, 1.0]);
    let (file, report) = baked(&scene);
    assert_eq!(report.emissive_groups, ["panel"]);
    assert!(!report.lamp_added && matches!(file.meta.lights[..], [Light::Emissive { .. }]));
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let relit = Relit::new(&file, &surfaces, &file.meta.lights, false);
    let groups = emissive_groups(&scene);
    let truth = Illumination::of_scene(&surfaces, &file.meta.lights, scene.origin, &groups, None);
    let (mut ours, mut traced) = ([Vec3::ZERO; 2], [Vec3::ZERO; 2]);
    let mut stream = Stream::new(5, 5);
    for _ in 0..20_000 {
        let mut direction = stream.sphere();
        direction.y = -direction.y.abs();
        let ray = Ray { origin: Vec3::ZERO, direction, max_distance: f32::INFINITY, spread: 0.0 };
        for (k, only) in [Only::Direct, Only::Indirect].into_iter().enumerate() {
            ours[k] += relit.radiance(&surfaces, &ray, only, &mut stream);
            let settings = path_trace::Settings { only, ..Default::default() };
            traced[k] += path_trace::radiance(&surfaces, &truth, ray, settings, &mut stream);
        }
    }
    for (ours, traced) in ours.into_iter().zip(traced) {
        let ratio = ours / traced;
        assert!((ratio - 1.0).abs().max_element() < 0.02, "{ratio}");
    }
    // Linear in strength and colour.
    let dimmed = [Light::Emissive { group: 0, intensity: 0.5, color: [1.0, 0.0, 0.5] }];
    let dim = Relit::new(&file, &surfaces, &dimmed, false);
    let at = Vec3::new(0.2, -1.0, 0.1);
    let (full, dim) = (relit.light_at(at, Vec3::Y, 0), dim.light_at(at, Vec3::Y, 0));
    let factor = Vec3::new(0.5, 0.0, 0.25);
    assert!((dim.from_sources - full.from_sources * factor).length() < 1e-4 * full.from_sources.length());
}

#[test]
fn light_of_the_sky_does_not_pass_through_walls() {
    // The left room is open at its far end.
    let mut mesh = rebounce::io::load("builtin:two-rooms").unwrap();
    let end = mesh.bounds().0.x + 1e-4;
    remove(&mut mesh, |p| p.x < end);
    mesh.lights = vec![even_sky()];
    let mut settings = settings();
    settings.viewpoints = vec![[-2.0, 1.2, 2.0], [2.0, 1.2, 2.0]];
    let (file, report) = bake(&mesh, &settings, &()).unwrap();
    assert!(report.has_sky);
    let surfaces = TriangleSurfaces::from_scene(&mesh);
    let relit = Relit::new(&file, &surfaces, &mesh.lights, true);
    let seen_from = |world: DVec3| {
        let origin = (world - DVec3::from(mesh.origin)).as_vec3();
        let mut stream = Stream::new(3, 3);
        let (mut greatest, mut sum, mut count) = (0f32, 0.0, 0);
        for _ in 0..10_000 {
            let ray = Ray { origin, direction: stream.sphere(), max_distance: f32::INFINITY, spread: 0.0 };
            let Some(hit) = surfaces.cast(&ray, 0) else { continue };
            let light = relit.light_at(hit.position, hit.normal, 0);
            let light = (light.bounced + light.from_sources).x;
            (greatest, sum, count) = (greatest.max(light), sum + light, count + 1);
        }
        (greatest, sum / count as f32)
    };
    let ((_, lit), (greatest, other)) =
        (seen_from(DVec3::new(-2.0, 1.2, 2.0)), seen_from(DVec3::new(2.0, 1.2, 2.0)));
    assert!(lit > 0.3, "{lit}");
    assert!(other <= 1e-3 * lit && greatest <= 1e-2 * lit, "{other} and at most {greatest} beside {lit}");
}
