//! Renders a .rbn file without a window:
//!
//! `headless FILE.rbn [SHOT.json] OUT.png [--size WxH] [--mode MODE] [--overlay OVERLAY] [--shadows TEXELS]
//! [--every-pixel] [--solver NAME] [--compare INDIRECT.exr [--all] [--from FLOATS]]`
//!
//! `--every-pixel` looks the bounced light up in every pixel, where usually most are interpolated.
//!
//! `--compare` prints how far the GPU's bounced light is from a picture made by
//! `rebounce render FILE.rbn --shot SHOT.json --only indirect`, and writes their difference to OUT.png;
//! with `--all`, all light is compared with a picture made by `--only all`;
//! `--from` takes another viewer's `readIndirect` (RGBA 32-bit floats) instead of drawing.

use anyhow::{Context, Result, bail};
use common::{open, screen::screen, set_shot};
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::settings::{Mode, Overlay, SolverChoice};
use rebounce_viewer::stats::Counts;
use std::path::Path;
use std::time::Instant;

mod common;

fn main() -> Result<()> {
    let mut files = Vec::new();
    let mut solver = SolverChoice::Auto;
    let (mut mode, mut overlay, mut size) = (Mode::All, Overlay::None, None);
    let (mut compare, mut from, mut shadows, mut every_pixel, mut all) = (None, None, None, false, false);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().context("a value is missing");
        match argument.as_str() {
            "--mode" => mode = Mode::parse(&value()?)?,
            "--overlay" => overlay = Overlay::parse(&value()?)?,
            "--compare" => compare = Some(value()?),
            "--from" => from = Some(value()?),
            "--shadows" => shadows = Some(value()?.parse()?),
            "--solver" => solver = SolverChoice::parse(&value()?)?,
            "--every-pixel" => every_pixel = true,
            "--all" => all = true,
            "--size" => {
                let text = value()?;
                let (w, h) = text.split_once('x').context("--size WxH")?;
                size = Some([w.parse()?, h.parse()?]);
            }
            _ => files.push(argument),
        }
    }
    let file = files.first().context("which file?")?;
    let out = files.last().context("which file?")?;
    let gpu = Gpu::headless()?;
    let mut renderer = open(&gpu, Path::new(file))?;
    let shot = files.iter().find(|file| file.ends_with(".json"));
    let picture_size =
        shot.map(|shot| set_shot(&mut renderer, Path::new(shot))).transpose()?.unwrap_or([640, 360]);
    let [width, height] = size.unwrap_or(picture_size);
    renderer.set_mode(mode);
    renderer.set_every_pixel(every_pixel);
    renderer.set_solver(solver);
    if let Some(size) = shadows {
        renderer.set_largest_shadow_map(size);
    }
    if let Some(path) = compare {
        let bytes = match &from {
            Some(file) => std::fs::read(file)?,
            None if all => pollster::block_on(renderer.read_radiance(width, height)?.wait())?,
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
fn read_exr(path: &str, width: usize, height: usize) -> Result<Vec<[f32; 3]>> {
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| (size, vec![[0f32; 3]; size.width() * size.height()]),
        |(size, pixels), at, (r, g, b, _): (f32, f32, f32, f32)| {
            pixels[at.y() * size.width() + at.x()] = [r, g, b]
        },
    )?;
    let (size, pixels) = image.layer_data.channel_data.pixels;
    if (size.width(), size.height()) != (width, height) {
        bail!("{path} has {} x {} pixels", size.width(), size.height());
    }
    Ok(pixels)
}
