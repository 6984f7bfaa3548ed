//! Measures relighting and the display passes (find, gather) relative to memory bandwidth: `bandwidth FILE.rbn
//! [SHOT.json]`, 1280 x 720, with the first light moving.
//!
//! A pass must read its inputs and write its outputs at least once. A plain copy of the same number of bytes on the
//! same device is a lower bound for the time of the pass; the measured time is printed as a multiple of this bound.
//! (Software adapters work from caches, so the result means little there.)

use rebounce_shared::baked::BakedScene;
use rebounce_shared::light::{DIRECTION, POSITION};
use rebounce_shared::shot::Shot;
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use rebounce_viewer::stats::Counts;
use screen::screen;
use std::error::Error;
use std::time::Instant;

#[path = "../../tests/common/screen.rs"]
mod screen;

const WIDTH: u32 = 1280;
const HEIGHT: u32 = 720;
/// Number of frames; the shortest time of a pass counts.
const FRAMES: usize = 20;
/// Bytes of the source and of the target of the copy: larger than caches.
const COPIED: u64 = 128 << 20;
/// Copies in a row, to hide the launch cost.
const COPIES: u32 = 8;
/// Threads of a workgroup of copy.wgsl; a thread copies 16 bytes.
const THREADS: u64 = 256;

/// Bytes of an RGB value on the GPU, padded to four floats.
const COLOUR: u64 = 16;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let file = args.next().ok_or("which file?")?;
    let scene = BakedScene::from_bytes(&std::fs::read(file)?)?;
    let gpu = Gpu::headless()?;
    let mut renderer = Renderer::new(gpu.clone())?;
    let relit = relit_bytes(&scene);
    let points = scene.points.len() as u64;
    let loaded = pollster::block_on(GpuScene::upload(&gpu, renderer.pipelines().loaders(), scene))?;
    let looked_up = loaded.upload.points.size() + loaded.upload.lookup.size() + loaded.upload.cuts.size();
    renderer.install(loaded)?;
    if let Some(shot) = args.next() {
        let shot: Shot = serde_json::from_slice(&std::fs::read(shot)?)?;
        renderer.set_camera(shot.camera)?;
        renderer.set_lights(shot.lights)?;
    }
    renderer.set_still_pictures(1);
    let target = screen(&gpu, WIDTH, HEIGHT);
    let view = target.create_view(&Default::default());
    // Milliseconds of relighting, finding and gathering.
    let mut best = [f64::INFINITY; 3];
    for frame in 0..FRAMES {
        let mut lights = renderer.lights().to_vec();
        let first = lights.first_mut().ok_or("the scene has no light, and no shot gives one")?;
        if let Some([x, y, z]) = first.position() {
            *first = first.with(POSITION.at, &[x + 1e-3, y, z]);
        } else if let Some([x, y, z]) = first.direction() {
            *first = first.with(DIRECTION.at, &[x + 1e-3, y, z]);
        }
        let mut camera = renderer.camera().clone();
        camera.position[0] += 1e-4 * frame as f64;
        renderer.set_camera(camera)?;
        renderer.set_lights(lights)?;
        renderer.draw(&view, target.format(), WIDTH, HEIGHT)?;
        gpu.device.poll(wgpu::PollType::wait_indefinitely())?;
        let times = renderer.stats().milliseconds;
        for (best, time) in best.iter_mut().zip([times.relight, times.find, times.gather]) {
            *best = best.min(time.ok_or("this device cannot time passes")?);
        }
    }
    gpu.check()?;
    let (size, counts) = renderer.read_counts()?;
    let counts = Counts::new(size, &pollster::block_on(counts.wait())?);
    let pace = pace(&gpu)?;
    println!("{}: a copy reads and writes {:.1} GB/s", gpu.adapter, pace / 1e9);
    // Depth, normal and the slot of every pixel; every row's entries.
    let pixels = counts.pixels * (4 + 4 + 4);
    let entries = 4 * counts.evaluated;
    let bytes = [relit, pixels + looked_up + entries, entries + COLOUR * (points + counts.rows)];
    println!("pass, milliseconds, MB to read and write, milliseconds that these take, ratio");
    for ((pass, time), bytes) in ["relight", "find", "gather"].into_iter().zip(best).zip(bytes) {
        let least = bytes as f64 / pace * 1e3;
        println!("{pass:8} {time:9.3} {:8.2} {least:9.3} {:6.1}", bytes as f64 / 1e6, time / least);
    }
    Ok(())
}

/// Bytes read and written by a relighting frame; the steps are in relight.rs.
fn relit_bytes(scene: &BakedScene) -> u64 {
    let relations = &scene.relations;
    let words = |offsets: &[u32]| 4 * offsets.len() as u64;
    let of = |content: usize, bytes: usize| (content * bytes) as u64;
    let (points, senders) = (scene.points.len() as u64, scene.sender_count() as u64);
    let (direct, coarse) = (scene.direct_count() as u64, scene.later_count() as u64);
    let point = size_of_val(&scene.points[..]) as u64 / points.max(1);
    let links = |matrix_offsets: &[u32], links: usize| words(matrix_offsets) + of(links, 4);
    let push = words(&relations.push_offsets) + size_of_val(&relations.push_entries[..]) as u64;
    let pull = words(&relations.pull_offsets) + size_of_val(&relations.pull_entries[..]) as u64;
    // Direct light: points in, irradiance out. Pull: entries, irradiance in and out. Send: points and irradiance
    // in, out.
    let mut bytes = direct * (point + COLOUR) + pull + 2 * COLOUR * direct + senders * (point + 2 * COLOUR);
    // All links, the senders' values, parents; the display values in and out.
    bytes += links(&scene.links.offsets, scene.links.links.len()) + COLOUR * senders + push;
    bytes += points * (point + 2 * COLOUR);
    if coarse > 0 {
        // The coarse points' links once more, the bounces between coarse points, and the senders' values again.
        let first = scene.links.offsets[coarse as usize] as usize;
        bytes += links(&scene.links.offsets[..coarse as usize], first) + coarse * (point + 2 * COLOUR);
        bytes += links(&scene.later.offsets, 2 * scene.later.links.len()) + 3 * COLOUR * coarse;
        bytes += senders * (point + 3 * COLOUR);
    }
    bytes
}

/// Bytes per second read and written by a plain copy.
fn pace(gpu: &Gpu) -> Result<f64, Box<dyn Error>> {
    let module = gpu.device.create_shader_module(wgpu::include_wgsl!("copy.wgsl"));
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("copy"),
        layout: None,
        module: &module,
        entry_point: Some("copy"),
        compilation_options: Default::default(),
        cache: None,
    });
    let usage = wgpu::BufferUsages::STORAGE;
    let buffer = || {
        let descriptor =
            wgpu::BufferDescriptor { label: Some("copied"), size: COPIED, usage, mapped_at_creation: false };
        gpu.device.create_buffer(&descriptor)
    };
    let (from, to) = (buffer(), buffer());
    let bound = [&from, &to].map(|buffer| buffer.as_entire_binding());
    let entries = (0..).zip(bound).map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource });
    let entries: Vec<_> = entries.collect();
    let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("copy"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    });
    // Wall-clock time: the work is long enough.
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for _ in 0..COPIES {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups((COPIED / 16 / THREADS) as u32, 1, 1);
        }
        let start = Instant::now();
        gpu.queue.submit([encoder.finish()]);
        gpu.device.poll(wgpu::PollType::wait_indefinitely())?;
        best = best.min(start.elapsed().as_secs_f64());
    }
    gpu.check()?;
    Ok(2.0 * (COPIED * COPIES as u64) as f64 / best)
}
