//! Bounding quads of functions: the GPU's quads equal the CPU's, except for quads without a pixel centre.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_shared::camera::Camera;
use rebounce_shared::glam::Vec2;
use rebounce_viewer::display::quad::Quad;
use rebounce_viewer::readback::Readback;
use rebounce_viewer::shaders;
use rebounce_viewer::view::{Frame, Sample};
use std::collections::BTreeMap;
use wgpu::BufferUsages;
use wgpu::util::DeviceExt;

const SIZE: [u32; 2] = [64, 48];

/// Whether a quad, shrunk by `less`, holds a pixel centre in every `step`th column and row, left of `end`.
fn holds(quad: &Quad, less: f32, step: usize, end: usize) -> bool {
    let [width, height] = SIZE.map(|side| side as usize);
    let middles =
        |count: usize| (0..count).step_by(step).map(move |i| (i as f32 + 0.5) / count as f32 * 2.0 - 1.0);
    let within = |x: f32, c: usize| quad.low[c] + less < x && x < quad.high[c] - less;
    middles(width).take(end.div_ceil(step)).any(|x| within(x, 0)) && middles(height).any(|y| within(-y, 1))
}

#[test]
fn quads_are_those_of_the_cpu() {
    let Some(gpu) = common::gpu() else { return };
    let scene = common::room(&[6, 12]);
    let camera = |position: [f64; 3], target: [f64; 3]| {
        let camera = Camera { position, target, up: [0.0, 1.0, 0.0], yfov_deg: 70.0 };
        Frame::new(&camera.frame([0.0; 3]), 0.01, SIZE, Sample::default())
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
    // A distant surface in all pixels; pixels left of the middle have their own slots.
    let [width, height] = SIZE;
    let depth = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Depth32Float,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let depth = depth.create_view(&Default::default());
    let slots: Vec<u32> = (0..width * height).map(|pixel| (pixel % width < width / 2) as u32).collect();
    let slots = buffer(bytemuck::cast_slice(&slots), BufferUsages::STORAGE);
    for (i, frame) in views.iter().enumerate() {
        let quads =
            buffer(bytemuck::cast_slice(&vec![[0u32; 4]; 2 * scene.points.len()]), BufferUsages::STORAGE);
        let draws = buffer(bytemuck::cast_slice(&[0u32; 24]), BufferUsages::STORAGE);
        let frame_buffer = buffer(bytemuck::bytes_of(frame), BufferUsages::UNIFORM);
        let bound = [&frame_buffer, &of, &points, &quads, &draws];
        let mut resources = bound.map(|buffer| buffer.as_entire_binding()).to_vec();
        resources.extend([wgpu::BindingResource::TextureView(&depth), slots.as_entire_binding()]);
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let layout = &pipeline.get_bind_group_layout(0);
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout,
            entries: &entries,
        });
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1e-6),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        }));
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
        let (draws, quads) = (read(&draws), read(&quads));
        let list = |word: usize, first: usize| -> BTreeMap<u32, [u32; 4]> {
            let found = &quads.as_chunks::<4>().0[first + level.start..][..draws[word] as usize / 6];
            assert_eq!(found.len() * 6, draws[word] as usize);
            found.iter().map(|quad| (quad[3], *quad)).collect()
        };
        let lists = [list(12, 0), list(16, scene.points.len())];
        let (mut seen, mut at_eye) = (0, 0);
        for j in level.clone() {
            let quad = Quad::of(frame, &scene.points[j]);
            for (of, list) in lists.iter().enumerate() {
                let name = format!("view {i}, function {j}, {}", ["pixels", "blocks"][of]);
                let Some(found) = list.get(&(j as u32)) else {
                    let missed = quad.as_ref().is_some_and(|quad| match of {
                        0 => holds(quad, 1e-4, 1, SIZE[0] as usize / 2),
                        _ => holds(quad, 1e-4, 2, SIZE[0] as usize),
                    });
                    assert!(!missed, "{name}: {quad:?} is missing");
                    continue;
                };
                let quad = quad.as_ref().unwrap_or_else(|| panic!("{name} is not in view"));
                // Large quads are always drawn.
                let size = 0.25 * (quad.high - quad.low) * Vec2::new(SIZE[0] as f32, SIZE[1] as f32);
                let large = 4.0 * size.x * size.y > 9.0;
                assert!(large || holds(quad, -1e-4, 1 + of, SIZE[0] as usize), "{name}: {quad:?} is none");
                let corner =
                    |bits: u32| [bits as u16 as i16, (bits >> 16) as u16 as i16].map(|x| x as f32 / 32767.0);
                let [low, high] = [found[0], found[1]].map(corner);
                for c in 0..2 {
                    // Rounded outwards, by a step at most.
                    let rounded = -2e-5..1.0 / 32767.0 + 2e-5;
                    let by = [quad.low[c] - low[c], high[c] - quad.high[c]];
                    assert!(by.iter().all(|by| rounded.contains(by)), "{name}: {low:?}, {high:?}; {quad:?}");
                }
                let depth = f32::from_bits(found[2]);
                assert!((depth - quad.depth).abs() <= 1e-4 * quad.depth, "{name}: {depth}, {quad:?}");
                seen += of;
                at_eye += of * (quad.depth == 1.0) as usize;
            }
        }
        println!("view {i}: {seen} of {} in view, {at_eye} at the eye", level.len());
        assert!((50..level.len()).contains(&seen), "view {i}: {seen} of {} are in view", level.len());
        assert_eq!(at_eye > 0, i < 2, "view {i}: {at_eye} supports reach the eye");
    }
    gpu.check().unwrap();
}
