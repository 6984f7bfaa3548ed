//! A door leaf that moves: closed it is a wall, open a doorway, whichever way the file was baked.

use crate::leaks::light_from;
use glam::{DVec3, Vec3};
use rebounce::bake::{BakeSettings, BakeSolver, Preset, bake};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::light::illumination::Illumination;
use rebounce::random::mix;
use rebounce::verify::compare::compare;
use rebounce::verify::expose::Exposure;
use rebounce::verify::path_trace::{Settings, path_trace};
use rebounce::verify::render::Relit;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::basis::{Functions, Relations};
use rebounce_shared::clip_planes::clip_planes;
use rebounce_shared::footprint::samples;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::motion::{Motions, NodeMotion};
use rebounce_shared::radiosity::placed_surfaces::PlacedSurfaces;
use rebounce_shared::radiosity::{Accelerator, ClippedFunctions, Clipping};

/// Degrees between the leaf closed and open.
const OPEN: f64 = 80.0;

fn baked(name: &str, functions: usize) -> BakedScene {
    let scene = rebounce::io::load(name).unwrap();
    let mut settings = BakeSettings::new(Preset::Draft);
    settings.place.functions = functions;
    settings.solver = BakeSolver::Radiosity;
    bake(&scene, &settings.normalised(), &()).unwrap().0
}

/// The scene baked with the leaf closed and open, each with the turn that it takes to open the leaf.
fn both_ways(functions: usize) -> [(BakedScene, f64); 2] {
    [("builtin:two-rooms-leaf", OPEN), ("builtin:two-rooms-leaf-open", 0.0)]
        .map(|(name, to_open)| (baked(name, functions), to_open))
}

fn turned(file: &BakedScene, rotation_y_deg: f64) -> Motions {
    let turn = NodeMotion { rotation_y_deg, ..NodeMotion::default() };
    Motions::new(&file.groups, &[turn], file.meta.origin)
}

fn relit(file: &BakedScene, motions: &Motions) -> (TriangleSurfaces, Relit) {
    let surfaces = TriangleSurfaces::from_moved(file, motions).unwrap();
    let lighting = Lighting::new(&file.meta.lights, None, file.meta.origin, 0);
    let relit = Relit::moved(file, &surfaces, lighting, true, motions);
    (surfaces, relit)
}

/// Mean and greatest bounced irradiance of what is seen from the middle of the lit room, and of the dark one.
fn seen(file: &BakedScene, motions: &Motions) -> [(f32, f32); 2] {
    let (surfaces, relit) = relit(file, motions);
    let origin = DVec3::from(file.meta.origin);
    [-2.0, 2.0].map(|x| light_from(&surfaces, &relit, DVec3::new(x, 1.2, 2.0) - origin))
}

#[test]
fn a_closed_leaf_keeps_light_out_whichever_way_the_file_was_baked() {
    for functions in [3000, 12_000] {
        let lit = both_ways(functions).map(|(file, to_open)| {
            let [(lit, _), (dark, greatest)] = seen(&file, &turned(&file, to_open - OPEN));
            println!("{functions}: {} of {lit}, at most {}", dark / lit, greatest / lit);
            assert!(lit > 1.0 && dark <= 5e-3 * lit && greatest <= 0.05 * lit, "{dark}, {greatest} of {lit}");
            lit
        });
        assert!((lit[0] / lit[1] - 1.0).abs() < 0.03, "{lit:?}");
    }
}

#[test]
#[ignore = "takes much processor time: docs/dev/testing.md"]
fn an_open_leaf_lets_in_the_light_of_the_path_tracer_whichever_way_the_file_was_baked() {
    let scene = rebounce::io::load("builtin:two-rooms-leaf-open").unwrap();
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let illumination = Illumination::of_scene(&surfaces, &scene.lights, scene.origin, &[], None);
    let size = [64, 36];
    let settings = Settings { only: Only::Indirect, ..Settings::default() };
    // Into the dark room.
    let camera = &scene.cameras[0];
    let traced = [1, 2].map(|seed| {
        let exposure = Exposure { size, samples: 400, seed };
        path_trace(&surfaces, scene.origin, camera, &illumination, exposure, settings, || ())
    });
    for (file, to_open) in both_ways(12_000) {
        let (surfaces, relit) = relit(&file, &turned(&file, to_open));
        let exposure = Exposure { size, samples: 16, seed: 3 };
        let picture = relit.picture(&file, &surfaces, camera, exposure, Only::Indirect, || ());
        let off = compare(&picture, &traced[0], Some(&traced[1])).unwrap();
        println!("{off:?}");
        assert!(off.error.value.unwrap() <= 0.08 && off.bias.abs() < 0.05, "{off:?}");
    }
}

#[test]
fn the_law_of_clip_planes_finds_in_a_file_what_the_bake_found_and_no_motion_changes_nothing() {
    for name in ["builtin:two-rooms-leaf", "builtin:two-rooms-leaf-open", "builtin:library"] {
        let file = baked(name, 4000);
        let accelerator = Accelerator::new(&file);
        let placed = accelerator.placed(&file, &Motions::default());
        let surfaces = PlacedSurfaces::new(&file, &accelerator, &placed);
        let (mut same, mut same_samples, mut with_planes) = (0, 0, 0);
        for (i, point) in file.points.iter().enumerate() {
            let (supported, seed) = (surfaces.supported(point), mix(i as u64) as u32);
            let planes = clip_planes(&surfaces, &supported, seed);
            let own = file.cuts_of(i);
            let close = |(a, b): (&[f32; 3], &[f32; 3])| {
                Vec3::from(*a).distance(Vec3::from(*b)) < 4e-3 * Vec3::from(*b).length()
            };
            let is_same = planes.len() == own.len()
                && planes.iter().zip(own).all(|(a, b)| close((&a.towards, &b.towards)));
            same += usize::from(is_same);
            with_planes += usize::from(!own.is_empty());
            let mask = samples(&surfaces, &supported, own, seed);
            same_samples += usize::from(u32::from(mask) == point.cuts >> 3 & 0xff);
        }
        let all = file.points.len();
        println!("{name}: planes {same}, samples {same_samples} of {all}, {with_planes} with planes");
        assert!(with_planes > all / 5, "{with_planes} of {all}");
        // Books stand in the planes of their shelves, where a ray may find either.
        let least = if name == "builtin:library" { 0.98 } else { 0.995 };
        assert!(same as f32 > least * all as f32, "{same} of {all}");
        assert!(same_samples as f32 > 0.99 * all as f32, "{same_samples} of {all}");
        let still = ClippedFunctions::new(&file, &accelerator, &placed, &Motions::default());
        assert!(still.renewed.is_empty() && still.relations.is_none());
        assert!(still.points == file.points && still.cuts == file.cuts);
    }
}

#[test]
fn functions_around_a_leaf_that_comes_back_are_the_files() {
    let file = baked("builtin:two-rooms-leaf", 4000);
    let accelerator = Accelerator::new(&file);
    // All the way round.
    let motions = turned(&file, 360.0 + 1e-4);
    let placed = accelerator.placed(&file, &motions);
    let back = ClippedFunctions::new(&file, &accelerator, &placed, &motions);
    assert!(!back.renewed.is_empty());
    let is_same = |i: &&u32| {
        let own = &back.cuts[back.points[**i as usize].cuts()];
        let before = file.cuts_of(**i as usize);
        own.len() == before.len()
            && own.iter().zip(before).all(|(a, b)| {
                let [a, b] = [a, b].map(|cut| Vec3::from(cut.towards));
                a.distance(b) < 4e-3 * b.length()
            })
    };
    let same = back.renewed.iter().filter(is_same).count();
    println!("{same} of {}", back.renewed.len());
    assert!(same as f32 > 0.98 * back.renewed.len() as f32, "{same} of {}", back.renewed.len());
}

#[test]
fn relations_around_a_moved_leaf_are_those_of_all_functions_anew() {
    for (file, to_open) in both_ways(4000) {
        let accelerator = Accelerator::new(&file);
        let motions = turned(&file, if to_open == 0.0 { -OPEN } else { OPEN });
        let placed = accelerator.placed(&file, &motions);
        let functions = ClippedFunctions::new(&file, &accelerator, &placed, &motions);
        let ours = functions.relations.unwrap();
        let all = Functions {
            points: &functions.points,
            cuts: &functions.cuts,
            levels: &file.meta.levels,
            groups: &file.point_groups,
        };
        let anew = Relations::new(&all, file.meta.direct_levels as usize, file.parent_weights).unwrap();
        assert_ne!(ours.push_entries, file.relations.push_entries);
        assert!(ours.push_offsets == anew.push_offsets && ours.push_entries == anew.push_entries);
        assert!(ours.pull_offsets == anew.pull_offsets && ours.pull_entries == anew.pull_entries);
    }
}

#[test]
fn the_way_to_a_place_does_not_matter() {
    let file = baked("builtin:two-rooms-leaf-open", 4000);
    let accelerator = Accelerator::new(&file);
    let mut clipping = Clipping::new(&file);
    let mut least = usize::MAX;
    for turn in [-10.0, -45.0, -OPEN, -OPEN, -70.0, 0.0, 30.0, -OPEN] {
        let motions = turned(&file, turn);
        let placed = accelerator.placed(&file, &motions);
        let ours = clipping.follow(&file, &accelerator, &placed, &motions);
        let anew = ClippedFunctions::new(&file, &accelerator, &placed, &motions);
        assert!(ours.renewed == anew.renewed && ours.points == anew.points && ours.cuts == anew.cuts);
        assert!(ours.relations == anew.relations);
        if turn != 0.0 {
            least = least.min(ours.renewed.len());
        }
    }
    assert!(least > 50, "{least}");
}

#[test]
fn clip_planes_of_a_moved_group_are_in_the_directions_that_the_file_has() {
    // The leaf, open, has planes where it stands in a wall; seen from the leaf they turn with it.
    let file = baked("builtin:two-rooms-leaf-open", 4000);
    let accelerator = Accelerator::new(&file);
    // Through the wall between the rooms.
    let motion = NodeMotion { translation: [-0.3, 0.0, -0.4], rotation_y_deg: 10.0, ..NodeMotion::default() };
    let motions = Motions::new(&file.groups, &[motion], file.meta.origin);
    let placed = accelerator.placed(&file, &motions);
    let functions = ClippedFunctions::new(&file, &accelerator, &placed, &motions);
    let of_leaf = || functions.renewed.iter().map(|i| *i as usize).filter(|i| file.group_of(*i) == 1);
    let moved = |i: usize| file.moved_point(i, &motions);
    let wall = -file.meta.origin[0] as f32;
    let (mut beyond, mut ended) = (0, 0);
    for i in of_leaf() {
        let here = moved(i).position();
        // Places of the leaf's same side beyond the wall, within the support.
        for j in of_leaf().filter(|j| file.points[*j].normal().dot(file.points[i].normal()) > 0.9) {
            let (there, radius) = (moved(j).position(), file.points[i].radius);
            let sides = [here.x - wall, there.x - wall];
            if sides[0] * sides[1] < 0.0
                && sides.iter().all(|side| side.abs() > 0.03)
                && here.distance(there) < 0.9 * radius
                && here.y > 0.3
                && there.y > 0.3
            {
                beyond += 1;
                let offset = file.points[j].position() - file.points[i].position();
                let own = &functions.cuts[functions.points[i].cuts()];
                ended += usize::from(own.iter().any(|cut| cut.ends(offset)));
            }
        }
    }
    println!("{ended} of {beyond}");
    assert!(beyond > 20 && ended as f32 > 0.95 * beyond as f32, "{ended} of {beyond}");
}
