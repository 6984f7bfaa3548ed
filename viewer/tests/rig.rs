//! Meshes that deform: what the GPU draws of a pose is what it draws of a file whose vertices the CPU has posed.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::{Vec2, Vec3};
use rebounce_shared::octahedral::{pack_rounded, unpack_snorm16};
use rebounce_shared::rig::pose::Pose;
use rebounce_shared::rig::skin::{put, ridden, skinned};
use rebounce_shared::rig::{
    MorphDelta, NodePose, Rig, RigAnimation, RigInterpolation, RigJoint, RigLayout, RigMesh, RigNode,
    RigPoint, RigTarget, RigTrack, RigVertex,
};
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::readback::Readback;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use rebounce_viewer::settings::{Mode, ToneMapping};

const SIZE: [u32; 2] = [48, 36];
/// Difference of a picture's numbers, relative RMS: positions are rounded otherwise, at edges a pixel may show another wall.
const CLOSE: f64 = 2e-3;

/// Walls that deform: a skin of two joints, and two morph targets.
const SKINNED: usize = 5;
const MORPHED: usize = 0;

/// A node at a place.
fn node(parent: Option<u32>, at: [f64; 3]) -> RigNode {
    RigNode {
        parent,
        rest: NodePose::Parts { translation: at, rotation: [0.0, 0.0, 0.0, 1.0], scale: [1.0; 3] },
    }
}

fn track(target: RigTarget, interpolation: RigInterpolation, times: &[f32], values: &[f32]) -> RigTrack {
    RigTrack { target, interpolation, times: times.to_vec(), values: values.to_vec() }
}

/// The room, with two of its walls in a rig. Animation 0 bends them, 1 shifts the skinned one.
pub fn deforming_room() -> BakedScene {
    let mut scene = common::room(&[4, 8, 16]);
    let vertices =
        |wall: usize| (4 * wall as u32..4 * wall as u32 + 4).map(|i| (i, scene.vertices[i as usize]));
    let mut rig = Rig::default();
    for (wall, weights) in
        [(SKINNED, [[0xffff, 0], [0xffff, 0], [0, 0xffff], [0x8000, 0x7fff]]), (MORPHED, [[0xffff, 0]; 4])]
    {
        for ((number, vertex), [a, b]) in vertices(wall).zip(weights) {
            rig.vertices.push(RigVertex {
                vertex: number,
                position: vertex.position,
                normal: vertex.normal,
                joints: [if wall == SKINNED { 1 << 16 } else { 0 }, 0],
                weights: [a | b << 16, 0],
            });
        }
    }
    for target in 0..2 {
        for corner in 0..4 {
            let amount = if corner == 2 * target { 0.5 } else { 0.1 };
            rig.deltas.push(MorphDelta { position: [amount, 0.0, 0.05], normal: [0.0, 0.3, 0.0] });
        }
    }
    let bind = |at: [f32; 3]| [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], at.map(|x| -x)];
    let half = std::f32::consts::FRAC_1_SQRT_2;
    rig.layout = RigLayout {
        nodes: vec![node(None, [0.1, 0.0, 0.0]), node(Some(0), [0.0, -0.5, 0.9]), node(None, [0.0; 3])],
        meshes: vec![
            RigMesh {
                first_vertex: 0,
                vertex_count: 4,
                joints: vec![
                    RigJoint { node: 0, inverse_bind: bind([0.1, 0.0, 0.0]) },
                    RigJoint { node: 1, inverse_bind: bind([0.1, -0.5, 0.9]) },
                ],
                ..RigMesh::default()
            },
            RigMesh {
                first_vertex: 4,
                vertex_count: 4,
                node: 2,
                weights: vec![0.0, 0.0],
                ..RigMesh::default()
            },
        ],
        animations: vec![
            RigAnimation {
                name: "bend".into(),
                duration: 2.0,
                tracks: vec![
                    track(
                        RigTarget::Rotation(1),
                        RigInterpolation::Linear,
                        &[0.0, 2.0],
                        &[0.0, 0.0, 0.0, 1.0, half, 0.0, 0.0, half],
                    ),
                    track(
                        RigTarget::Translation(0),
                        RigInterpolation::Step,
                        &[0.0, 0.5],
                        &[0.1, 0.0, 0.0, 0.1, 0.2, 0.0],
                    ),
                    track(
                        RigTarget::Weights(1),
                        RigInterpolation::Linear,
                        &[0.0, 1.0],
                        &[0.0, 0.0, 1.0, 0.5],
                    ),
                ],
            },
            RigAnimation {
                name: "shift".into(),
                duration: 1.0,
                tracks: vec![track(
                    RigTarget::Translation(0),
                    RigInterpolation::Linear,
                    &[0.0, 1.0],
                    &[0.1, 0.0, 0.0, 0.1, 0.0, -0.4],
                )],
            },
        ],
        bounds: [[-1.5; 3], [1.5; 3]],
    };
    // Points of the two walls ride on the triangle that they are in.
    for (number, point) in (0u32..).zip(&scene.points) {
        for (wall, first) in [(SKINNED, 0u32), (MORPHED, 4)] {
            let corner = |k: u32| Vec3::from(scene.vertices[4 * wall + k as usize].position);
            let of_wall =
                unpack_snorm16(point.normal).dot(unpack_snorm16(scene.vertices[4 * wall].normal)) > 0.99;
            if !of_wall {
                continue;
            }
            let offset = point.position() - corner(0);
            let [u, v] = [corner(1) - corner(0), corner(3) - corner(0)];
            let at = Vec2::new(offset.dot(u) / u.length_squared(), offset.dot(v) / v.length_squared());
            // Triangles 0 1 2 and 0 2 3.
            let (corners, barycentric) = match at.x > at.y {
                true => ([0, 1, 2], [at.x - at.y, at.y]),
                false => ([0, 2, 3], [at.x, at.y - at.x]),
            };
            rig.points.push(RigPoint { point: number, corners: corners.map(|k| first + k), barycentric });
        }
    }
    scene.rig = rig;
    scene
}

/// The same without a rig, as the CPU poses it: vertices, and points.
fn posed(scene: &BakedScene, animation: usize, time: f32) -> BakedScene {
    let pose = Pose::of(&scene.rig, &scene.rig.layout.animations[animation], time);
    let at = skinned(&scene.rig, &pose);
    let mut out = BakedScene { rig: Rig::default(), ..scene.clone() };
    put(&scene.rig, &at, &mut out.vertices);
    for rider in &scene.rig.points {
        let on = ridden(rider, &at);
        let point = &mut out.points[rider.point as usize];
        (point.position, point.normal) = (on.position.to_array(), pack_rounded(on.normal));
    }
    out
}

fn renderer(gpu: &Gpu, scene: &BakedScene) -> Renderer {
    let mut renderer = Renderer::new(gpu.clone()).unwrap();
    let loaded =
        pollster::block_on(GpuScene::upload(gpu, renderer.pipelines().loaders(), scene.clone())).unwrap();
    renderer.install(loaded).unwrap();
    renderer.set_tone_mapping(ToneMapping::Neutral);
    renderer.set_every_pixel(true);
    renderer.set_auto_exposure(false);
    renderer
}

fn floats(readback: Readback) -> Vec<f32> {
    bytemuck::pod_collect_to_vec(&pollster::block_on(readback.wait()).unwrap())
}

/// Bounced light, and all light.
fn pictures(renderer: &mut Renderer) -> [Vec<f32>; 2] {
    let indirect = floats(renderer.read_indirect(SIZE[0], SIZE[1]).unwrap());
    renderer.set_mode(Mode::All);
    let all = floats(renderer.read_radiance(SIZE[0], SIZE[1]).unwrap());
    [indirect, all]
}

fn apart(a: &[f32], b: &[f32]) -> f64 {
    let sum = |numbers: &mut dyn Iterator<Item = f64>| numbers.map(|x| x * x).sum::<f64>();
    let power = sum(&mut b.iter().map(|b| f64::from(*b)));
    assert!(power > 0.0 && a.len() == b.len(), "nothing to compare");
    (sum(&mut a.iter().zip(b).map(|(a, b)| f64::from(a - b))) / power).sqrt()
}

#[test]
fn a_pose_is_drawn_and_lit_as_a_file_with_posed_vertices() {
    let Some(gpu) = common::gpu() else { return };
    let scene = deforming_room();
    let mut ours = renderer(&gpu, &scene);
    let [_, rest] = pictures(&mut ours);
    for time in [0.3, 0.75, 2.0] {
        ours.pose(Some(0), f64::from(time)).unwrap();
        let [_, all] = pictures(&mut ours);
        // Direct light alone: bounced light of a bent wall is that of its points at rest.
        let direct = |renderer: &mut Renderer| {
            renderer.set_mode(Mode::Direct);
            pollster::block_on(renderer.read_pixels(SIZE[0], SIZE[1]).unwrap().wait()).unwrap()
        };
        let (mine, other) = (direct(&mut ours), direct(&mut renderer(&gpu, &posed(&scene, 0, time))));
        let numbers = |bytes: &[u8]| bytes.iter().map(|b| f32::from(*b)).collect::<Vec<f32>>();
        let off = apart(&numbers(&mine), &numbers(&other));
        println!("at {time}: {off}, from rest {}", apart(&all, &rest));
        assert!(off < 0.02, "direct light of the pose: {off}");
        assert!(apart(&all, &rest) > 0.05, "the pose is drawn");
        gpu.check().unwrap();
    }
}

#[test]
fn a_shifted_wall_has_the_light_of_a_file_with_that_wall_elsewhere() {
    let Some(gpu) = common::gpu() else { return };
    let scene = deforming_room();
    let mut ours = renderer(&gpu, &scene);
    ours.pose(Some(1), 0.5).unwrap();
    let mut other = posed(&scene, 1, 0.5);
    // Functions are found by place: the tables are those of the points where they are.
    other.relate().unwrap();
    common::link(&mut other);
    let [mine, theirs] = [pictures(&mut ours), pictures(&mut renderer(&gpu, &other))];
    for (name, mine, theirs) in [("indirect", &mine[0], &theirs[0]), ("all", &mine[1], &theirs[1])] {
        let off = apart(mine, theirs);
        println!("{name}: {off}");
        assert!(off < CLOSE, "{name}: {off}");
    }
}

#[test]
fn at_rest_again_everything_is_as_it_was() {
    let Some(gpu) = common::gpu() else { return };
    let scene = deforming_room();
    let mut ours = renderer(&gpu, &scene);
    let before = pictures(&mut ours);
    let plain = pictures(&mut renderer(&gpu, &BakedScene { rig: Rig::default(), ..scene.clone() }));
    assert!(before.iter().zip(&plain).all(|(a, b)| apart(a, b) < CLOSE), "a rig at rest changes nothing");
    ours.pose(Some(0), 1.5).unwrap();
    assert!(apart(&pictures(&mut ours)[1], &before[1]) > 0.05);
    ours.pose(None, 0.0).unwrap();
    let after = pictures(&mut ours);
    assert!(before.iter().zip(&after).all(|(a, b)| apart(a, b) < CLOSE), "at rest again");
    assert_eq!(ours.pose(Some(2), 0.0).unwrap_err().code(), "bad-argument");
    assert_eq!(ours.pose(Some(0), f64::NAN).unwrap_err().code(), "bad-argument");
}
