//! Renders a .rbn file without a window:
//!
//! `headless FILE.rbn [SHOT.json] OUT.png [--size WxH] [--mode MODE] [--overlay OVERLAY] [--shadows TEXELS]
//! [--every-pixel] [--compare INDIRECT.exr [--from FLOATS]]`
//!
//! `--every-pixel` looks the bounced light up in every pixel, where usually most are interpolated.
//!
//! `--compare` prints how far the GPU's bounced light is from a picture made by
//! `rebounce render FILE.rbn --shot SHOT.json --only indirect`, and writes their difference to OUT.png;
//! `--from` takes another viewer's `readIndirect` (RGBA 32-bit floats) instead of drawing.

use rebounce_shared::baked::BakedScene;
use rebounce_shared::lighting::with_emission;
use rebounce_shared::shot::Shot;
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use rebounce_viewer::settings::{Mode, Overlay};
use rebounce_viewer::stats::Counts;
use screen::screen;
use std::error::Error;
use std::time::Instant;

#[path = "../tests/common/screen.rs"]
mod screen;

fn main() -> Result<(), Box<dyn Error>> {
    let mut files = Vec::new();
    let (mut mode, mut overlay, mut size) = (Mode::All, Overlay::None, None);
    let (mut compare, mut from, mut shadows, mut every_pixel) = (None, None, None, false);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or("a value is missing");
        match argument.as_str() {
            "--mode" => mode = Mode::parse(&value()?)?,
            "--overlay" => overlay = Overlay::parse(&value()?)?,
            "--compare" => compare = Some(value()?),
            "--from" => from = Some(value()?),
            "--shadows" => shadows = Some(value()?.parse()?),
            "--every-pixel" => every_pixel = true,
            "--size" => {
                let text = value()?;
                let (w, h) = text.split_once('x').ok_or("--size WxH")?;
                size = Some([w.parse()?, h.parse()?]);
            }
            _ => files.push(argument),
        }
    }
    let file = files.first().ok_or("which file?")?;
    let out = files.last().ok_or("which file?")?;
    let gpu = Gpu::headless()?;
    let mut renderer = Renderer::new(gpu.clone())?;
    let scene = BakedScene::from_bytes(&std::fs::read(file)?)?;
    let loaded = pollster::block_on(GpuScene::upload(&gpu, renderer.pipelines().loaders(), scene))?;
    renderer.install(loaded)?;
    let mut picture_size = [640, 360];
    if let Some(shot) = files.iter().find(|f| f.ends_with(".json")) {
        let shot: Shot = serde_json::from_slice(&std::fs::read(shot)?)?;
        renderer.set_camera(shot.camera)?;
        let groups = renderer.scene().map_or(0, |scene| scene.sources.groups.len());
        renderer.set_lights(with_emission(&shot.lights, groups, shot.emission))?;
        renderer.set_mix(shot.mix)?;
        picture_size = shot.size;
    }
    let [width, height] = size.unwrap_or(picture_size);
    renderer.set_mode(mode);
    renderer.set_every_pixel(every_pixel);
    if let Some(size) = shadows {
        renderer.set_largest_shadow_map(size);
    }
    if let Some(path) = compare {
        let bytes = match &from {
            Some(file) => std::fs::read(file)?,
            None => pollster::block_on(renderer.read_indirect(width, height)?.wait())?,
        };
        let ours: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
        let truth = read_exr(&path, width as usize, height as usize)?;
        let (mut error, mut power, mut sums) = (0.0, 0.0, [0.0; 2]);
        let mut picture = Vec::new();
        let scale = 0.5 / (truth.iter().flatten().map(|x| *x as f64).sum::<f64>() / (3 * truth.len()) as f64);
        for (a, b) in ours.iter().zip(&truth) {
            for c in 0..3 {
                let (x, y) = (a[c] as f64, b[c] as f64);
                error += (x - y) * (x - y);
                power += y * y;
                sums = [sums[0] + x, sums[1] + y];
                picture.push((128.0 + 512.0 * (x - y) * scale).clamp(0.0, 255.0) as u8);
            }
        }
        println!(
            "relative RMS difference {:.4}, bias {:+.4}",
            (error / power).sqrt(),
            sums[0] / sums[1] - 1.0
        );
        image::save_buffer(out, &picture, width, height, image::ColorType::Rgb8)?;
        return Ok(());
    }
    renderer.set_overlay(overlay);
    let target = screen(&gpu, width, height);
    let view = target.create_view(&Default::default());
    let start = Instant::now();
    while renderer.needs_frame() {
        renderer.draw(&view, target.format(), width, height)?;
    }
    let bytes = pollster::block_on(rebounce_viewer::readback::Readback::texture(&gpu, &target, 4).wait())?;
    eprintln!("{:.0} ms", start.elapsed().as_secs_f64() * 1e3);
    if out.ends_with(".png") {
        image::save_buffer(out, &bytes, width, height, image::ColorType::Rgba8)?;
    }
    println!("{}", serde_json::to_string_pretty(&renderer.stats())?);
    let (size, counts) = renderer.read_counts()?;
    let counts = Counts::new(size, &pollster::block_on(counts.wait())?);
    let per_pixel = |count: u64| count as f64 / counts.pixels as f64;
    println!(
        "of the pixels {:.3} look functions up; a pixel looks at {:.2}, evaluates {:.2}",
        per_pixel(counts.rows),
        per_pixel(counts.looked_at),
        per_pixel(counts.evaluated)
    );
    Ok(())
}

/// The RGB pixels of an EXR file of this size.
fn read_exr(path: &str, width: usize, height: usize) -> Result<Vec<[f32; 3]>, Box<dyn Error>> {
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| (size, vec![[0f32; 3]; size.width() * size.height()]),
        |(size, pixels), at, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[at.y() * size.width() + at.x()] = [r, g, b]
        },
    )?;
    let (size, pixels) = image.layer_data.channel_data.pixels;
    if (size.width(), size.height()) != (width, height) {
        return Err(format!("{path} has {} x {} pixels", size.width(), size.height()).into());
    }
    Ok(pixels)
}
