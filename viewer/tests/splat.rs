//! The quads that bound what functions reach: the GPU's are the CPU's.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

use rebounce_shared::camera::Camera;
use rebounce_viewer::display::quad::Quad;
use rebounce_viewer::readback::Readback;
use rebounce_viewer::shaders;
use rebounce_viewer::view::{Frame, Sample};
use wgpu::BufferUsages;
use wgpu::util::DeviceExt;

#[test]
fn quads_are_those_of_the_cpu() {
    let Some(gpu) = common::gpu() else { return };
    let scene = common::room(&[6, 12]);
    let camera = |position: [f64; 3], target: [f64; 3]| {
        let camera = Camera { position, target, up: [0.0, 1.0, 0.0], yfov_deg: 70.0 };
        Frame::new(&camera.frame([0.0; 3]), 0.01, [64, 48], Sample::default())
    };
    let views = [
        camera([0.2, 0.1, 0.9], [-0.1, -0.2, -1.0]),
        // Close to a wall, and from outside, where no support reaches the eye.
        camera([0.1, 0.2, 0.98], [1.0, 0.2, 0.9]),
        camera([0.4, 0.2, 3.0], [0.0, 0.0, 0.0]),
    ];
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(shaders::QUADS.concat().into()),
    });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("quads_of_level"),
        compilation_options: Default::default(),
        cache: None,
    });
    let level = scene.level(1);
    let buffer = |contents: &[u8], usage| {
        let usage = usage | BufferUsages::COPY_SRC;
        gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage })
    };
    let points = buffer(bytemuck::cast_slice(&scene.points), BufferUsages::STORAGE);
    let of = [level.start as u32, level.len() as u32, 1, 1, 0, 0, 0, 0];
    let of = buffer(bytemuck::cast_slice(&of), BufferUsages::UNIFORM);
    for (i, frame) in views.iter().enumerate() {
        let quads = buffer(bytemuck::cast_slice(&vec![[0u32; 4]; scene.points.len()]), BufferUsages::STORAGE);
        let draws = buffer(bytemuck::cast_slice(&[0u32; 16]), BufferUsages::STORAGE);
        let frame_buffer = buffer(bytemuck::bytes_of(frame), BufferUsages::UNIFORM);
        let bound = [&frame_buffer, &of, &points, &quads, &draws];
        let entries: Vec<_> = (0..)
            .zip(bound)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let layout = &pipeline.get_bind_group_layout(0);
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout,
            entries: &entries,
        });
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(level.len().div_ceil(64) as u32, 1, 1);
        }
        gpu.queue.submit([encoder.finish()]);
        let read = |buffer| -> Vec<u32> {
            bytemuck::pod_collect_to_vec(&pollster::block_on(Readback::buffer(&gpu, buffer).wait()).unwrap())
        };
        let seen = read(&draws)[9] as usize;
        let mut found: Vec<_> = read(&quads).as_chunks::<4>().0[level.start..][..seen].to_vec();
        found.sort_by_key(|quad| quad[3]);
        let expected: Vec<_> =
            level.clone().filter_map(|j| Some((j as u32, Quad::of(frame, &scene.points[j])?))).collect();
        let functions: Vec<_> = expected.iter().map(|(j, _)| *j).collect();
        assert_eq!(
            found.iter().map(|quad| quad[3]).collect::<Vec<_>>(),
            functions,
            "view {i}: which are in view"
        );
        assert!((1..level.len()).contains(&seen), "view {i}: {seen} of {} are in view", level.len());
        let mut whole = 0;
        for ([low, high, depth, j], (_, quad)) in found.iter().zip(&expected) {
            let corner =
                |bits: u32| [bits as u16 as i16, (bits >> 16) as u16 as i16].map(|x| x as f32 / 32767.0);
            let (low, high) = (corner(*low), corner(*high));
            for c in 0..2 {
                // Rounded outwards, by a step at most.
                let step = 1.0 / 32767.0 + 2e-5;
                let (less, more) = (quad.low[c] - low[c], high[c] - quad.high[c]);
                assert!(
                    (-2e-5..step).contains(&less) && (-2e-5..step).contains(&more),
                    "view {i}, {j}: {low:?}, {high:?}; {quad:?}"
                );
            }
            let depth = f32::from_bits(*depth);
            assert!((depth - quad.depth).abs() <= 1e-4 * quad.depth, "view {i}, {j}: {depth}, {quad:?}");
            whole += (quad.depth == 1.0) as u32;
        }
        println!("view {i}: {seen} of {} in view, {whole} at the eye", level.len());
        assert_eq!(whole > 0, i < 2, "view {i}: {whole} supports reach the eye");
    }
    gpu.check().unwrap();
}
