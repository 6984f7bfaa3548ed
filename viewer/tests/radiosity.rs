//! Radiosity on the GPU against the CPU's, on the same input.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
use rebounce_shared::motion::{Motions, NodeMotion};
use rebounce_shared::octahedral::pack_snorm16;
use rebounce_shared::radiosity::solver::{Passes, Scene};
use rebounce_shared::radiosity::{Accelerator, ClippedFunctions, RadiositySettings, Reconstruction, solve};
use rebounce_shared::rbn::LinkMatrix;
use rebounce_shared::rbn::bulk::{Copies, Instance, Point, Vertex};
use rebounce_shared::rbn::groups::{Group, Groups, Node};
use rebounce_shared::rbn::meta::{Draw, Material};
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::gpu::scope::Scope;
use rebounce_viewer::radiosity::{Radiosity, RadiosityPipelines};
use rebounce_viewer::readback::Readback;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use rebounce_viewer::settings::SolverChoice;
use rebounce_viewer::upload::Upload;
use wgpu::BufferUsages;

/// A room, and a two-sided panel in it that may move: on every level it has points on both sides.
pub fn linked_room() -> BakedScene {
    let mut scene = common::room(&[4, 8, 16]);
    let first = scene.vertices.len() as u32;
    for (x, y) in [(-0.4, -0.4), (0.4, -0.4), (0.4, 0.4), (-0.4, 0.4)] {
        let vertex = Vertex { position: [x, y, 0.0], normal: pack_snorm16(Vec3::Z), uv: [0.0; 2] };
        scene.vertices.push(vertex);
    }
    let material = scene.meta.materials.len() as u32;
    scene.meta.materials.push(Material { double_sided: true, ..Material::default() });
    scene.meta.draws.push(Draw { material, first_index: scene.indices.len() as u32, index_count: 6 });
    scene.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    scene.copies = vec![Copies::default(); scene.meta.draws.len()];
    scene.copies[material as usize] = Copies { first: 0, count: 1 };
    scene.instances = vec![Instance::IDENTITY];
    let mut points = Vec::new();
    for level in &mut scene.meta.levels {
        let range = level.first as usize..(level.first + level.count) as usize;
        level.first = points.len() as u32;
        points.extend(scene.points[range].iter().map(|point| (*point, 0)));
        let side = (0.8 / level.disk_radius).ceil();
        for normal in [Vec3::Z, Vec3::NEG_Z] {
            for i in 0..(side * side) as u32 {
                let at = |k: u32| ((k as f32 + 0.5) / side - 0.5) * 0.8;
                let position = [at(i % side as u32), at(i / side as u32), 0.0];
                let radius = level.support_radius;
                points.push((Point { position, radius, normal: pack_snorm16(normal), ..scene.points[0] }, 1));
            }
        }
        level.count = points.len() as u32 - level.first;
    }
    // The panel's points have no cuts.
    scene.points =
        points.iter().map(|(p, g)| Point { cuts: if *g == 0 { p.cuts } else { 0 }, ..*p }).collect();
    scene.point_groups = points.iter().map(|(_, group)| *group).collect();
    let node = Node { name: "panel".into(), parent: None, origin: [0.0; 3] };
    scene.groups = Groups {
        nodes: vec![node],
        groups: vec![Group { name: "panel".into(), density: 1.0, node: Some(0) }],
        of_material: (0..=material).map(|i| u32::from(i == material)).collect(),
        ..Groups::default()
    };
    scene.reflectance = (0..scene.points.len()).map(|i| 100 + (i % 80) as u8).collect();
    scene.relate().unwrap();
    common::link(&mut scene);
    scene
}

/// As [`linked_room`], without links.
pub fn room_with_panel() -> BakedScene {
    let mut scene = linked_room();
    scene.meta.sender_levels = 3;
    scene.links = LinkMatrix::from_rows(&vec![Vec::new(); scene.points.len()]);
    scene.meta.later_levels = 0;
    scene.later = LinkMatrix::from_rows(&[]);
    scene.relate().unwrap();
    scene
}

/// Direct light of a lamp near a corner, without shadows.
fn direct(scene: &BakedScene, motions: &Motions) -> Vec<Vec3> {
    let light = |i: usize| {
        let point = scene.moved_point(i, motions);
        let way = Vec3::new(0.3, 0.7, -0.4) - point.position();
        let cosine = point.normal().dot(way.normalize()).max(0.0);
        Vec3::new(3.0, 2.0, 1.0) * cosine / way.length_squared().max(0.05)
    };
    (0..scene.points.len()).map(light).collect()
}

fn on_cpu(scene: &BakedScene, motions: &Motions, settings: &RadiositySettings) -> Vec<Vec3> {
    let accelerator = Accelerator::new(scene);
    let placed = accelerator.placed(scene, motions);
    let moved = ClippedFunctions::new(scene, &accelerator, &placed, motions).of(scene);
    let scene = Scene { baked: &moved, accelerator: &accelerator, motions };
    let solution = solve(scene, settings, &direct(scene.baked, motions), &|receivers, gather| {
        receivers.iter().map(|receiver| gather(*receiver)).collect()
    });
    solution.irradiance
}

/// Solves on the GPU in slices of so many receivers.
fn on_gpu(
    gpu: &Gpu,
    scene: &BakedScene,
    motions: &Motions,
    settings: &RadiositySettings,
    [lanes, slice]: [u32; 2],
) -> Vec<Vec3> {
    let pipelines = RadiosityPipelines::with_lanes(gpu, lanes);
    let upload = Upload::new(gpu, scene).unwrap();
    let own = Scope::new(gpu);
    let storage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
    let rows: Vec<[f32; 4]> = direct(scene, motions).iter().map(|e| [e.x, e.y, e.z, 0.0]).collect();
    let stored = |bytes: &[u8]| {
        let size = bytes.len() as u64;
        let usage = storage | BufferUsages::COPY_DST;
        let buffer =
            own.buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
        gpu.queue.write_buffer(&buffer, 0, bytes);
        buffer
    };
    let points = stored(bytemuck::cast_slice(&scene.points));
    let [given, display] = [stored(bytemuck::cast_slice(&rows)), stored(bytemuck::cast_slice(&rows))];
    let buffers = [&points, &given, &display];
    let mut solver = Radiosity::new(gpu, &pipelines, &upload, scene, buffers, *settings).unwrap();
    solver.place(gpu, &upload, scene, motions);
    while !solver.progress().is_done {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        solver.encode(gpu, &mut encoder, &pipelines, slice);
        gpu.queue.submit([encoder.finish()]);
    }
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    solver.show(gpu, &mut encoder, &pipelines);
    gpu.queue.submit([encoder.finish()]);
    let bytes = pollster::block_on(Readback::buffer(gpu, &display).wait()).unwrap();
    let rows: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
    rows[..scene.points.len()].iter().map(|[r, g, b, _]| Vec3::new(*r, *g, *b)).collect()
}

/// Root mean square difference over the root mean square.
fn difference(ours: &[Vec3], theirs: &[Vec3]) -> f32 {
    let squares = |values: &mut dyn Iterator<Item = Vec3>| values.map(Vec3::length_squared).sum::<f32>();
    let off = squares(&mut ours.iter().zip(theirs).map(|(a, b)| *a - *b));
    (off / squares(&mut theirs.iter().copied())).sqrt()
}

fn moved(scene: &BakedScene) -> Motions {
    let motion = NodeMotion { translation: [0.2, 0.3, -0.4], rotation_y_deg: 40.0, ..NodeMotion::default() };
    Motions::new(&scene.groups, &[motion], scene.meta.origin)
}

#[test]
fn every_way_to_solve_agrees_with_the_cpu_where_the_panel_stands_and_where_it_was_moved() {
    let Some(gpu) = common::gpu() else { return };
    let scene = room_with_panel();
    for motions in [Motions::default(), moved(&scene)] {
        for reconstruction in [Reconstruction::Nearest, Reconstruction::Exact] {
            for passes in [Passes::Summed, Passes::EachBounce] {
                let (rays, bounces) = (64, 3);
                let settings =
                    RadiositySettings { rays, bounces, reconstruction, passes, ..Default::default() };
                let cpu = on_cpu(&scene, &motions, &settings);
                let gpu = on_gpu(&gpu, &scene, &motions, &settings, [64, u32::MAX]);
                let off = difference(&gpu, &cpu);
                println!("{reconstruction:?}, {passes:?}, {}: {off:e}", motions.is_empty());
                assert!(off < 0.01, "{off}");
            }
        }
    }
}

#[test]
fn a_solution_has_the_same_bits_however_it_is_cut_into_slices() {
    let Some(gpu) = common::gpu() else { return };
    let scene = room_with_panel();
    let motions = moved(&scene);
    let settings = RadiositySettings { rays: 64, bounces: 3, ..Default::default() };
    for lanes in [1, 16] {
        let whole = on_gpu(&gpu, &scene, &motions, &settings, [lanes, u32::MAX]);
        assert_eq!(whole, on_gpu(&gpu, &scene, &motions, &settings, [lanes, u32::MAX]));
        assert_eq!(whole, on_gpu(&gpu, &scene, &motions, &settings, [lanes, 97]));
    }
}

#[test]
fn a_moved_panel_shades_what_it_stands_before() {
    let scene = room_with_panel();
    let settings = RadiositySettings { rays: 256, bounces: 2, ..Default::default() };
    // Right before the wall at z = -1, parallel to it; some light comes in from the side.
    let motion = NodeMotion { translation: [0.0, 0.0, -0.97], ..NodeMotion::default() };
    let motions = Motions::new(&scene.groups, &[motion], scene.meta.origin);
    let [before, after] = [Motions::default(), motions].map(|motions| on_cpu(&scene, &motions, &settings));
    let is_behind = |i: &usize| {
        let at = scene.points[*i].position();
        scene.group_of(*i) == 0 && at.z < -0.99 && at.truncate().abs().max_element() < 0.3
    };
    let sum = |values: &[Vec3]| {
        (0..scene.points.len()).filter(is_behind).map(|i| values[i].element_sum()).sum::<f32>()
    };
    assert!(sum(&after) < 0.5 * sum(&before), "{} of {}", sum(&after), sum(&before));
}

/// The renderer of a scene, and a picture of its bounced light.
pub fn renderer(gpu: &Gpu, scene: &BakedScene) -> Renderer {
    let mut renderer = Renderer::new(gpu.clone()).unwrap();
    let pipelines = renderer.pipelines();
    let loaded = pollster::block_on(GpuScene::upload(gpu, pipelines.loaders(), scene.clone())).unwrap();
    renderer.install(loaded).unwrap();
    renderer
}

pub fn indirect(renderer: &mut Renderer) -> Vec<u8> {
    let read = renderer.read_indirect(48, 32).unwrap();
    pollster::block_on(read.wait()).unwrap()
}

#[test]
fn radiosity_takes_over_while_something_is_moved_and_the_operator_returns() {
    let Some(gpu) = common::gpu() else { return };
    let scene = linked_room();
    let mut ours = renderer(&gpu, &scene);
    assert_eq!(ours.solver_in_use(), "operator");
    let rest = indirect(&mut ours);
    // The operator's picture is that of the same links without groups that move.
    let mut still = scene.clone();
    still.reflectance = Vec::new();
    let mut fixed = renderer(&gpu, &still);
    assert!(indirect(&mut fixed) == rest && fixed.node_names().is_empty());
    let motion = NodeMotion { translation: [0.2, 0.3, -0.4], rotation_y_deg: 40.0, ..NodeMotion::default() };
    ours.move_nodes(&[motion]).unwrap();
    assert_eq!((ours.solver_in_use(), ours.is_solving()), ("radiosity", true));
    let moved = indirect(&mut ours);
    assert!(moved != rest && !ours.is_solving());
    // What the file has as points alone gives the same light.
    let mut unlinked = renderer(&gpu, &room_with_panel());
    unlinked.set_lights(ours.lights().to_vec()).unwrap();
    unlinked.move_nodes(&[motion]).unwrap();
    assert!(indirect(&mut unlinked) == moved);
    unlinked.set_solver(SolverChoice::Operator);
    assert_eq!(unlinked.solver_in_use(), "radiosity");
    // By force, the operator of where things were baked.
    ours.set_solver(SolverChoice::Operator);
    assert_eq!((ours.solver_in_use(), ours.is_solving()), ("operator", false));
    ours.set_solver(SolverChoice::Auto);
    ours.move_nodes(&[NodeMotion::default()]).unwrap();
    assert_eq!(ours.solver_in_use(), "operator");
    assert!(indirect(&mut ours) == rest);
    ours.set_solver(SolverChoice::Radiosity);
    assert_eq!((ours.solver_in_use(), ours.is_solving()), ("radiosity", true));
    assert!(indirect(&mut ours) != rest);
    gpu.check().unwrap();
}

#[test]
fn without_lights_there_is_no_bounced_light() {
    let Some(gpu) = common::gpu() else { return };
    let mut ours = renderer(&gpu, &room_with_panel());
    indirect(&mut ours);
    ours.set_lights(Vec::new()).unwrap();
    let dark: Vec<f32> = bytemuck::pod_collect_to_vec(&indirect(&mut ours));
    assert!(dark.chunks(4).all(|pixel| pixel[..3] == [0.0; 3]));
}
