//! Copies of a mesh are stored once as a model, and the light equals the light of separate meshes.

use crate::common;
use rebounce_shared::baked::BakedScene;

use common::crowd::{COPIES, FINE, Said, glb, places};
use glam::Vec3;
use rebounce::bake::{BakeError, BakeSettings, Baker, Checkpoint, Identity, Observer, Preset, bake};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Ray, Surfaces};
use rebounce::random::Stream;
use rebounce::scene::Scene;
use rebounce_shared::rbn;
use rebounce_shared::relight::relight;
use std::sync::atomic::{AtomicUsize, Ordering};

fn crowd(said: Said) -> Scene {
    rebounce::io::from_bytes("crowd", &glb(said)).unwrap()
}

/// Share of rays with different hits on two kinds of surfaces, and number of rays with hits of a colour other than
/// the room's.
fn different(a: &TriangleSurfaces, b: &TriangleSurfaces, shift: Vec3, tolerance: f32) -> (f64, usize) {
    let mut stream = Stream::new(8, 1);
    let (mut differ, mut balls) = (0, 0);
    let (low, high) = a.bounds();
    for _ in 0..40_000 {
        let inside = Vec3::new(stream.unit(), stream.unit(), stream.unit());
        let origin = low + (high - low) * (0.02 + 0.96 * inside);
        let ray = Ray { origin, direction: stream.sphere(), max_distance: f32::INFINITY, spread: 0.0 };
        let [one, other] = [a.cast(&ray, 0), b.cast(&Ray { origin: origin + shift, ..ray }, 0)];
        let same = match (one, other) {
            (Some(one), Some(other)) => {
                balls += (one.albedo.x < 0.6) as usize;
                (one.distance - other.distance).abs() < tolerance
                    && one.position.distance(other.position - shift) < tolerance
                    && one.normal.dot(other.normal) > 0.999
                    && one.geometric_normal.dot(other.geometric_normal) > 0.999
                    && one.albedo == other.albedo
            }
            (None, None) => true,
            _ => false,
        };
        differ += !same as usize;
    }
    (differ as f64 / 40_000.0, balls)
}

/// Translation from the local space of a scene to the local space of another scene.
fn shift(from: &Scene, to: &Scene) -> Vec3 {
    (glam::DVec3::from(from.origin) - glam::DVec3::from(to.origin)).as_vec3()
}

#[test]
fn many_copies_are_one_model_and_stand_where_they_stood() {
    let alone = crowd(Said::Alone);
    assert!(alone.models.is_empty());
    let truth = TriangleSurfaces::from_scene(&alone);
    for said in [Said::Nodes, Said::Instances] {
        let scene = crowd(said);
        let copies: Vec<usize> = scene.models.iter().map(|m| m.local_from_model.len()).collect();
        assert_eq!(copies, COPIES, "{said:?}");
        // Every form has the triangles once; flat copies, and copies far smaller than the rest, stay separate
        // meshes.
        let sides = 12;
        let (pole, whole) = (2 * 40, FINE);
        assert_eq!(scene.triangles.len(), sides + 4 * (whole - pole), "{said:?}");
        assert_eq!(scene.triangles_placed() as usize, sides + places().len() * (whole - pole));
        assert_eq!(scene.degenerate_triangles, alone.degenerate_triangles);
        let shift = shift(&scene, &alone);
        for (surfaces, name) in [
            (TriangleSurfaces::from_scene(&scene), "as it is"),
            (TriangleSurfaces::simplified(&scene), "simplified"),
        ] {
            let (differ, balls) = different(&surfaces, &truth, shift, 2e-4);
            println!("{said:?}, {name}: {differ} differ, {balls} balls");
            assert!(balls > 4_000 && differ < 2e-3, "{said:?}, {name}: {differ}");
        }
    }
}

#[test]
fn what_is_drawn_once_in_a_file_of_copies_is_there() {
    // For any value of the unused `first` of an entry without copies.
    let mut baked = bake(&crowd(Said::Nodes), &settings(), &()).unwrap().0;
    let before = TriangleSurfaces::from_baked(&baked).unwrap();
    baked.copies.iter_mut().filter(|copies| copies.count == 0).for_each(|copies| copies.first = 3);
    baked = BakedScene::from_bytes(&baked.to_bytes().unwrap()).unwrap();
    let after = TriangleSurfaces::from_baked(&baked).unwrap();
    assert_eq!(after.piece_count(), before.piece_count());
    assert_eq!(different(&before, &after, Vec3::ZERO, 1e-6).0, 0.0);
}

/// Requests cancellation after the given number of checks.
struct StopAfter(AtomicUsize, usize);

impl Observer for StopAfter {
    fn is_stopped(&self) -> bool {
        self.0.fetch_add(1, Ordering::Relaxed) >= self.1
    }
}

#[test]
#[ignore = "takes much processor time: docs/dev/testing.md"]
fn a_bake_of_copies_that_was_stopped_goes_on_to_the_same_file() {
    let (scene, settings) = (crowd(Said::Instances), settings());
    let whole = bake(&scene, &settings, &()).unwrap().0;
    let folder = tempfile::tempdir().unwrap();
    let (path, identity) = (folder.path().join("a.partial"), Identity::new(&scene, &settings));
    let mut stopped = 0;
    for limit in [60, 150, usize::MAX] {
        let kept = Checkpoint::resume(&path, &identity).unwrap();
        let observer = StopAfter(AtomicUsize::new(0), limit);
        match Baker::new(&settings).observer(&observer).checkpoint(Some(&kept)).bake(&scene) {
            Ok(baked) => assert!(baked.unwrap().0 == whole),
            Err(BakeError::Stopped) => stopped += 1,
            Err(error) => panic!("{error}"),
        }
    }
    println!("stopped {stopped} times");
    assert!(stopped > 0);
}

/// Settings of a short bake.
fn settings() -> BakeSettings {
    let mut settings = BakeSettings::new(Preset::Draft);
    (settings.place.levels, settings.place.functions) = (4, 6000);
    settings.operator.rays = vec![256];
    settings.viewpoints = vec![[0.0, 3.5, 0.0]];
    settings.normalised()
}

/// Total bounced light under unit irradiance everywhere, a sum over the functions.
fn total(scene: &BakedScene) -> f32 {
    let light = relight(scene, vec![Vec3::ONE; scene.direct_count()]);
    let finest = scene.display();
    light[finest.clone()].iter().map(|l| l.element_sum()).sum::<f32>() / finest.len() as f32
}

#[test]
fn the_bounced_light_and_the_file_are_those_of_a_scene_without_models() {
    let (scene, alone) = (crowd(Said::Nodes), crowd(Said::Alone));
    let (baked, report) = bake(&scene, &settings(), &()).unwrap();
    let (truth, of_alone) = bake(&alone, &settings(), &()).unwrap();
    assert_eq!((report.instances, of_alone.instances), (110, 0));
    assert_eq!(report.placed_triangles, scene.triangles_placed());
    assert!(20 * report.triangles < of_alone.triangles && report.ray_triangles <= report.triangles);
    let (ours, theirs) = (total(&baked), total(&truth));
    println!("{ours} of {} functions, {theirs} of {}", report.functions, of_alone.functions);
    assert!((ours / theirs - 1.0).abs() < 0.02, "{ours}, {theirs}");
    // The file contains the model, and is smaller accordingly.
    let (bytes, more) = (baked.to_bytes().unwrap(), truth.to_bytes().unwrap());
    assert_eq!([baked.version(), truth.version()], [rbn::container::PUNCTUAL_LIGHTS; 2]);
    let read = BakedScene::from_bytes(&bytes).unwrap();
    assert_eq!(read, baked);
    assert_eq!(read.triangles_placed(), scene.triangles_placed());
    assert!(20 * baked.vertices.len() < truth.vertices.len() && bytes.len() < more.len());
    // The placement of copies is part of the identity of a bake.
    let identity = |scene: &Scene| Identity::new(scene, &settings());
    let mut moved = scene.clone();
    moved.models[1].local_from_model[7].translation.y += 1e-3;
    assert!(identity(&scene).difference(&identity(&scene.clone())).is_none());
    assert!(identity(&scene).difference(&identity(&moved)).is_some());
    // Rays find equal hits in file and scene, up to the rounding of positions in files.
    let from_file = TriangleSurfaces::from_baked(&read).unwrap();
    let (differ, _) = different(&from_file, &TriangleSurfaces::from_scene(&scene), Vec3::ZERO, 2e-3);
    assert!(differ < 0.01, "{differ}");
    // The result is independent of the number of threads.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert!(pool.install(|| bake(&scene, &settings(), &())).unwrap().0 == baked, "one thread");
}
