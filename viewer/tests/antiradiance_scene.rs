//! Antiradiance as the bounced light of a scene, beside the radiosity of the same scene, which casts rays.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;
use crate::radiosity::{indirect, linked_room, renderer, room_with_panel};

use rebounce_shared::antiradiance::{PointPatches, SceneTriangle};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::{DQuat, Vec3};
use rebounce_shared::light::Light;
use rebounce_shared::motion::NodeMotion;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::settings::SolverChoice;

/// Relative difference of the light of two solvers whose points are few.
const CLOSE: f64 = 0.2;

/// The light of a solver: linear radiance of the pixels, RGB.
fn light(renderer: &mut Renderer, solver: SolverChoice) -> Vec<f32> {
    renderer.set_solver(solver);
    let pixels: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&indirect(renderer));
    pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect()
}

/// Root mean square of the difference as a share of the second.
fn apart(a: &[f32], b: &[f32]) -> f64 {
    let sum = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
    let power = sum(&mut b.iter().map(|b| f64::from(*b)));
    assert!(power > 0.0 && a.len() == b.len(), "nothing to compare");
    (sum(&mut a.iter().zip(b).map(|(a, b)| f64::from(a - b))) / power).sqrt()
}

fn turned(degrees: f64) -> NodeMotion {
    let rotation = DQuat::from_rotation_y(degrees.to_radians()).to_array();
    NodeMotion { translation: [0.2, 0.3, -0.4], rotation, ..NodeMotion::default() }
}

#[test]
fn its_light_is_near_that_of_radiosity_and_follows_a_node() {
    let Some(gpu) = common::gpu() else { return };
    let mut ours = renderer(&gpu, &room_with_panel());
    for motion in [NodeMotion::default(), turned(40.0)] {
        ours.move_nodes(&[motion]).unwrap();
        let traced = light(&mut ours, SolverChoice::Radiosity);
        assert_eq!(ours.solver_in_use(), "radiosity");
        let found = light(&mut ours, SolverChoice::Antiradiance);
        assert_eq!((ours.solver_in_use(), ours.is_solving()), ("antiradiance", false));
        println!("{motion:?}: apart by {}", apart(&found, &traced));
        assert!(apart(&found, &traced) < CLOSE, "{}", apart(&found, &traced));
    }
    let counts = ours.antiradiance_counts().unwrap();
    assert!(
        counts.elements > 100 && counts.links > 1000 && counts.bins == 256 && counts.iterations > 20,
        "{counts:?}"
    );
    gpu.check().unwrap();
}

#[test]
fn light_after_motions_is_that_of_a_scene_loaded_there() {
    let Some(gpu) = common::gpu() else { return };
    let scene = room_with_panel();
    let mut followed = renderer(&gpu, &scene);
    let rest = light(&mut followed, SolverChoice::Antiradiance);
    for degrees in [10.0, 70.0, 40.0] {
        followed.move_nodes(&[turned(degrees)]).unwrap();
        assert!(followed.is_solving());
        light(&mut followed, SolverChoice::Antiradiance);
    }
    let mut anew = renderer(&gpu, &scene);
    anew.move_nodes(&[turned(40.0)]).unwrap();
    let expected = light(&mut anew, SolverChoice::Antiradiance);
    let [same, moved] =
        [light(&mut followed, SolverChoice::Antiradiance), rest].map(|it| apart(&it, &expected));
    println!("after motions {same}, from rest {moved}");
    assert!(same < 0.01 && moved > 0.03, "{same}, {moved}");
    // Dark without light.
    followed.set_lights(Vec::new()).unwrap();
    let dark = light(&mut followed, SolverChoice::Antiradiance);
    assert!(dark.iter().all(|value| *value == 0.0), "it is not dark");
    gpu.check().unwrap();
}

#[test]
fn beside_an_operator_there_is_its_light_at_rest_and_what_a_motion_changes() {
    let Some(gpu) = common::gpu() else { return };
    let mut ours = renderer(&gpu, &linked_room());
    let rest = light(&mut ours, SolverChoice::Operator);
    let same = light(&mut ours, SolverChoice::Antiradiance);
    assert!(same == rest && ours.solver_in_use() == "antiradiance" && !ours.is_solving());
    ours.move_nodes(&[turned(40.0)]).unwrap();
    assert!(ours.is_solving());
    let moved = light(&mut ours, SolverChoice::Antiradiance);
    let as_at_rest = light(&mut ours, SolverChoice::Operator);
    // The lamp's shadow alone is not all of the change.
    let [changed, more] = [apart(&moved, &rest), apart(&moved, &as_at_rest)];
    println!("moved {changed}, beside the operator's {more}");
    // The links of this room are not its own: its operator has more light than it should.
    assert!(changed > 0.03 && more > 1e-3, "{changed} {more}");
    ours.move_nodes(&[NodeMotion::default()]).unwrap();
    assert!(light(&mut ours, SolverChoice::Antiradiance) == rest, "it does not come back");
    gpu.check().unwrap();
}

#[test]
fn what_has_left_its_place_is_lit_by_antiradiance_alone() {
    let Some(gpu) = common::gpu() else { return };
    // Points and lamps of both are the same; the panel is white in the picture.
    let [mut beside, mut alone] = [linked_room(), room_with_panel()].map(|mut scene| {
        if let Some(panel) = scene.meta.materials.last_mut() {
            panel.base_color = [1.0; 4];
        }
        renderer(&gpu, &scene)
    });
    let mut share = |motion: NodeMotion| {
        let [with, without] = [&mut beside, &mut alone].map(|renderer| {
            renderer.move_nodes(&[motion]).unwrap();
            light(renderer, SolverChoice::Antiradiance)
        });
        let pixels = with.as_chunks::<3>().0.iter().zip(without.as_chunks::<3>().0);
        let is_same = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).all(|i| (a[i] - b[i]).abs() < 2e-3 * b[i]);
        pixels.filter(|(a, b)| is_same((a, b))).count() as f32 / (with.len() / 3) as f32
    };
    let [moved, rest] = [turned(40.0), NodeMotion::default()].map(&mut share);
    println!("the same in {moved} of the pixels, at rest in {rest}");
    assert!(moved > 0.03 && rest < 0.01, "{moved} {rest}");
    gpu.check().unwrap();
}

#[test]
fn patches_cover_the_surfaces_and_what_moves_has_its_own() {
    let scene = room_with_panel();
    let each = |call: &mut dyn FnMut(SceneTriangle)| triangles(&scene, call);
    let moves = |i: usize| scene.group_of(i) > 0;
    // Six walls of two by two metres, and both sides of a panel of 80 cm.
    for most in [[100, 20], [600, 40], [4000, 400]] {
        let at = |i: usize| [scene.points[i].position(), scene.points[i].normal()];
        let patches = PointPatches::new(&scene, &moves, most, (&each, &at));
        let made = patches.patches(&at);
        assert!(made.iter().enumerate().all(|(i, patch)| patch.roughness.is_some() == (i >= patches.still)));
        let area = |range: std::ops::Range<usize>| made[range].iter().map(|patch| patch.area()).sum::<f32>();
        let [still, moving] = [area(0..patches.still), area(patches.still..made.len())];
        println!("{} patches of {still} m², {} of {moving} m²", patches.still, made.len() - patches.still);
        assert!((still - 24.0).abs() < 0.5 && (moving - 1.28).abs() < 0.1, "{still} {moving}");
        assert!(patches.still <= most[0] && made.len() - patches.still <= most[1]);
        assert!(patches.points[..patches.still].iter().all(|i| !moves(*i as usize)));
        assert!(patches.points[patches.still..].iter().all(|i| moves(*i as usize)));
    }
}

fn triangles(scene: &BakedScene, call: &mut dyn FnMut(SceneTriangle)) {
    for draw in &scene.meta.draws {
        let first = draw.first_index as usize;
        for corners in scene.indices[first..first + draw.index_count as usize].as_chunks::<3>().0 {
            let corners = corners.map(|i| Vec3::from(scene.vertices[i as usize].position));
            let is_two_sided = scene.meta.materials[draw.material as usize].double_sided;
            // The panel is metal, and moves.
            call(SceneTriangle {
                corners,
                is_two_sided,
                roughness: is_two_sided.then_some(0.3),
                moves: is_two_sided,
            });
        }
    }
}

#[test]
fn a_metal_under_a_spot_throws_its_light_elsewhere_than_chalk() {
    let Some(gpu) = common::gpu() else { return };
    // All light comes from the panel, from its front.
    let spot = Light::Spot {
        position: [-0.6, 0.1, 0.6],
        direction: [0.7, -0.1, -0.7],
        outer_cone_deg: 18.0,
        inner_cone_deg: Some(10.0),
        intensity: 10.0,
        color: [1.0; 3],
        radius: 0.0,
    };
    let [matt, metal] = [0.0, 1.0].map(|metallic| {
        let mut scene = room_with_panel();
        let panel = scene.meta.materials.last_mut().unwrap();
        (panel.metallic, panel.roughness) = (metallic, 0.2);
        let mut ours = renderer(&gpu, &scene);
        ours.set_lights(vec![spot.clone()]).unwrap();
        light(&mut ours, SolverChoice::Antiradiance)
    });
    let mean = |light: &[f32]| light.iter().sum::<f32>() / light.len() as f32;
    println!("{} apart, {} and {}", apart(&metal, &matt), mean(&metal), mean(&matt));
    assert!(apart(&metal, &matt) > 0.1 && mean(&metal) > 0.2 * mean(&matt));
    gpu.check().unwrap();
}

/// A room with reflectances, and a mesh in it that deforms.
fn deforming_room() -> BakedScene {
    let mut scene = crate::rig::deforming_room();
    scene.reflectance = vec![150; scene.points.len()];
    scene
}

#[test]
fn a_pose_takes_the_light_along() {
    let Some(gpu) = common::gpu() else { return };
    let mut ours = renderer(&gpu, &deforming_room());
    if ours.scene().is_none_or(|scene| scene.moving.is_none()) {
        panic!("the room cannot be solved");
    }
    let rest = light(&mut ours, SolverChoice::Antiradiance);
    ours.pose(Some(0), 2.0).unwrap();
    assert!(ours.is_solving(), "a pose changes nothing");
    let posed = light(&mut ours, SolverChoice::Antiradiance);
    ours.pose(None, 0.0).unwrap();
    let again = light(&mut ours, SolverChoice::Antiradiance);
    let [changed, same] = [&posed, &again].map(|it| apart(it, &rest));
    println!("posed {changed}, at rest again {same}");
    assert!(changed > 0.03 && same < 0.01, "{changed} {same}");
    gpu.check().unwrap();
}

#[test]
fn auto_takes_it_while_something_deforms_and_draws_meanwhile() {
    let Some(gpu) = common::gpu() else { return };
    let mut ours = renderer(&gpu, &deforming_room());
    let rest = light(&mut ours, SolverChoice::Auto);
    assert_eq!(ours.solver_in_use(), "operator");
    ours.pose(Some(0), 2.0).unwrap();
    assert!(ours.is_solving() && ours.needs_frame());
    // Frames are drawn by what was there before, until the links are made.
    let screen = common::screen(&gpu, 48, 32);
    let view = screen.create_view(&Default::default());
    let mut frames = 0;
    while ours.solver_in_use() == "operator" {
        frames += 1;
        ours.draw(&view, screen.format(), screen.width(), screen.height()).unwrap();
        assert!(ours.is_solving() && frames < 1000, "{frames} frames");
    }
    assert_eq!(ours.solver_in_use(), "antiradiance");
    let posed = light(&mut ours, SolverChoice::Auto);
    let asked = light(&mut ours, SolverChoice::Antiradiance);
    let [auto, moved] = [&asked, &rest].map(|it| apart(&posed, it));
    println!("{frames} frames; auto {auto} from antiradiance, {moved} from rest");
    assert!(auto < 1e-3 && moved > 0.03, "{auto} {moved}");
    ours.set_solver(SolverChoice::Auto);
    ours.pose(None, 0.0).unwrap();
    assert_eq!(ours.solver_in_use(), "operator");
    let again = light(&mut ours, SolverChoice::Auto);
    assert!(apart(&again, &rest) < 1e-3, "{}", apart(&again, &rest));
    gpu.check().unwrap();
}
